#pragma once

#include <rubato/steady/trigonometric_series.hpp>

namespace rubato::steady {

/// The force of a slider over a period in which its relative displacement is a truncated Fourier series,
///
///   u(theta) = mean + sum over orders of Re(U_k exp(i k theta)),   fc = clamp(fc_old + kT (u - u_old), -limit, limit)
///
/// as pieces between transitions, and the Fourier coefficients of the force with their derivatives by those of u, in
/// closed form: nothing is sampled. A slider that slips at all is at its upper limit where u is highest (its slip is
/// then the largest of the period), so that one pass from there is the periodic loop.
///
/// With z = exp(i theta), slips from angle s (after the reversal r, where it stuck) to the reversal e:
///
///   F_k = kT (U_k - S_k / (i pi k)),   S_k = sum over slips of the integral of u' exp(-i k theta) from s to e
///   dS_k = (du(s) - du(r)) exp(-i k s) + integral of du' exp(-i k theta) from s to e
///
/// since the slip begins where u(s) = u(r) +- 2 limit / kT or so, and u' vanishes at e.
class HysteresisLoop {
 public:
  /// Finds the loop, for forces and derivatives of the orders of u.
  /// @param limit   >= 0 [N]; without one the slider has no force
  /// @param offset  what a slider that never slips should have as fc - kT u [N]; it gets the nearest that it can bear
  void pass(double stiffness, double limit, double mean, const Orders& orders, const Complex* coefficients,
            double offset);
  /// Prepares forces and derivatives of orders up to this one.
  void extend(int highest_order);

  bool slips() const { return slips_; }
  double offset() const { return offset_; }  ///< of a slider that never slips, else 0 [N]
  double mean_force() const;                 ///< F_0 [N]
  Complex force(int k) const;                ///< F_k, k >= 1 [N]

  /// dF_k by the real and the imaginary part of U_l; l may be an order that u does not have. [N/m]
  void derivative(int k, int l, Complex& by_real, Complex& by_imaginary) const;
  /// dF_0 by the real and the imaginary part of U_l (l >= 1). [N/m]
  void mean_derivative(int l, double& by_real, double& by_imaginary) const;
  double mean_derivative() const {
    return slips_ || is_idle_ || offset_is_bound_ ? 0.0 : stiffness_;
  }  ///< dF_0 by the mean [N/m]

  double dissipated() const;                                                        ///< over a period [J]
  double slip_share() const;                                                        ///< [-]
  long transitions() const;                                                         ///< in a period
  double range() const { return 2.0 * turning_.half_range(); }                      ///< of u [m]
  double middle() const { return 0.5 * (turning_.highest() + turning_.lowest()); }  ///< of u without its mean [m]
  double force_at(double angle) const;                                              ///< fc [N]

 private:
  struct Piece {
    double reversal, start, end;  ///< angles: sticks from the first to the second, slips up to the third
    double u_reversal, u_start, u_end;
    double sign;                            ///< of the slip; 0 where none ends the sticking
    double force_reversal;                  ///< fc at the reversal
    Complex at_reversal, at_start, at_end;  ///< exp(i theta)
  };
  const Complex* powers(int row) const { return powers_.data() + static_cast<std::ptrdiff_t>(row) * (reach_ + 1); }
  /// Integral of exp(i p theta) over the slip of a piece.
  Complex slip_integral(std::size_t piece, int p) const {
    const Complex value =
        slip_integrals_[piece * static_cast<std::size_t>(2 * reach_ + 1) + static_cast<std::size_t>(p < 0 ? -p : p)];
    return p < 0 ? std::conj(value) : value;
  }

  TurningPoints turning_;
  std::vector<Piece> pieces_;
  std::vector<Complex> powers_;  ///< z^k at reversal, start and end of each piece
  std::vector<Complex> slip_integrals_;
  Orders orders_;
  const Complex* coefficients_ = nullptr;
  double stiffness_ = 0.0, limit_ = 0.0, mean_ = 0.0, offset_ = 0.0;
  int reach_ = 0;  ///< the highest order prepared
  bool is_idle_ = false, slips_ = false, offset_is_bound_ = false, offset_at_top_ = false;
};

}  // namespace rubato::steady
