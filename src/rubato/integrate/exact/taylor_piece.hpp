#pragma once

#include <rubato/system/excitation.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <map>
#include <span>
#include <vector>

namespace rubato::integrate {

/// What a slider does in a piece: sticks, or slips with its force at plus or minus the limit.
enum class SliderState : signed char { slip_negative = -1, stick = 0, slip_positive = 1 };

/// The solution over a short time in which no slider changes its state: a Taylor polynomial of degree 24 about the
/// start, exact to round-off up to max_length(). The equations are linear with constant coefficients,
///
///   M a = f(t) - C v - (K + sum of kT b b^T over the sticking) q - B c,
///
/// so that each coefficient follows from the one before by two products, whatever roots the structure has: repeated,
/// overdamped or zero. Harmonic loads obey their own equation l' = -w m, m' = w l; tables are linear in time.
class TaylorPiece {
 public:
  static constexpr int degree = 24;
  /// Length times a bound of all |eigenvalues|: reach^25/25! = 2e-18 is beyond round-off for every mode. A longer piece
  /// of a higher degree would be cut short by the next transition.
  static constexpr double reach = 2.0;

  /// Throws nothing; the system must be checked before (see ExactFlow).
  explicit TaylorPiece(const system::LocallyNonlinear& system);

  /// Takes other loads and limits than the system's. Only harmonic loads.
  void set_excitation(const system::Excitation& excitation);
  /// mu N of a slider [N].
  double limit(Index slider) const { return limits_[slider]; }

  /// Makes the piece that starts at a state, to be used over at most max_length() and not beyond `end`: where that is
  /// near, fewer terms do.
  /// @param states  of the sliders [m]
  /// @param end     a time to which every table is linear from state.t on [s]
  void start(const system::State& state, const std::vector<SliderState>& states, double end);

  /// How far the polynomial is exact, but for `end` [s].
  double max_length() const { return length_; }
  /// A bound of the fastest rate of all that moves [1/s].
  double rate() const { return rate_; }
  /// How many terms are exact to round-off over length * rate.
  static Index terms_of(double turn);
  /// Of the polynomials: degree + 1, or fewer.
  Index terms() const { return terms_; }

  /// q and v at s after the start, and the slider forces there.
  void evaluate(double s, system::State& state) const;
  void evaluate(double s, Vector& q, Vector& v) const;

  /// Coefficients of the displacements and velocities, the first terms() columns [n x degree + 1].
  const Matrix& displacements() const { return q_; }
  const Matrix& velocities() const { return v_; }
  /// Coefficients of u = x_first - x_second of a slider.
  std::span<const double> relative_displacement(Index slider) const {
    return {u_.col(slider).data(), static_cast<std::size_t>(terms_)};
  }
  /// The largest term over max_length() of the displacements that u is the difference of: u is known to round-off of it
  /// [m].
  double displacement_scale(Index slider) const;
  /// The part of a slider's force that does not move with u: fc = kT u + offset while it sticks, fc = offset otherwise.
  double offset(Index slider) const { return offset_[slider]; }

  /// Work of the dampers and of the loads over [from, to] after the start, by Gauss-Legendre quadrature of 16 points:
  /// exact to the degree of what is integrated.
  void add_work(double from, double to, double& damper, double& load) const;

 private:
  struct Operators {
    Matrix stiffness;  // M^-1 (K + stuck)
    double rate;       // a bound of |eigenvalues|
    double length;     // reach / rate
  };
  struct Load {
    double angular_frequency = 0.0, phase = 0.0;
    const model::TableLaw* table = nullptr;  // instead of a harmonic law
  };
  void set_pattern();
  void set_loads(double t, double end);
  double load_value(Index load, double s) const;
  template <int N>
  void fill_coefficients();
  template <int N>
  void horner(double s, double* q, double* v) const;
  const Operators& operators_of(const std::vector<SliderState>& states);

  const system::LocallyNonlinear& system_;
  Index n_, m_, terms_ = degree + 1;
  std::vector<Load> loads_;
  Vector limits_;
  Matrix inverse_mass_, damping_, joins_;  // M^-1 C, M^-1 B
  Matrix dense_damping_, inverse_root_;    // C; L^-1 of M = L L^T
  Matrix pattern_;                         // P: of the coordinates, by columns of load
  std::map<std::vector<SliderState>, Operators> cache_;
  std::vector<SliderState> key_;
  const Operators* operators_ = nullptr;
  double length_ = 0.0, load_length_ = 0.0, rate_ = 0.0, start_ = 0.0;
  std::vector<SliderState> states_;
  // What a load makes of M^-1 P l, by columns of degree in each column: times the cosine of its angle in even degrees,
  // its sine in odd ones; of a table, times its value and slope. [n degree x loads]
  Matrix growth_;
  Vector load_start_;  // these, at the start
  Matrix q_, v_, u_;   // coefficients by columns of degree; u by columns of slider
  Vector offset_;
  mutable Vector work_q_, work_v_, work_product_;
  double largest_load_frequency_ = 0.0, damping_norm_ = 0.0;
};

}  // namespace rubato::integrate
