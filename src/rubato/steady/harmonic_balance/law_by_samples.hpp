#pragma once

#include <rubato/model/laws/law_slopes.hpp>
#include <rubato/steady/harmonic_balance/sample_angles.hpp>

#include <vector>

namespace rubato::steady {

/// The force of any law over a period in which its displacement is a truncated Fourier series: alternating frequency
/// and time (Cameron and Griffin 1989, J. Appl. Mech. 56, 149).
///
///   u(theta) = mean + sum over orders of Re(U_k exp(i k theta)),   F_k = 2/N sum over samples of f exp(-i k theta)
///
/// The law marches through the samples, and through the points between them where u turns round, so that each stretch
/// is one without a turn. It starts where nothing has moved, and goes round until its memory repeats: by itself first,
/// then by Newton's method on the memory, which also closes loops that hardly forget.
///
/// The derivatives of F are those of the sums, carried along the samples by the slopes of each step
/// (model::LawSlopes, or differences) and closed over the period, so that Newton's method on F converges as on a closed
/// form. What is not exact is the sums: more samples tell.
class LawBySamples {
 public:
  /// @param normal  what presses on it all along [N]; read by laws that take a normal force
  explicit LawBySamples(const model::Law& law, double normal = 0.0);

  /// Finds the forces of the orders of the angles; those of u may be fewer.
  void pass(SampleAngles& angles, double angular_frequency, double mean, const Orders& orders,
            const Complex* coefficients);
  /// Prepares the derivatives at the angles of the last pass, by all of their orders. They stay until the next call.
  void differentiate();

  /// Whether the memory repeats; else the law does something that does not.
  bool has_closed() const { return has_closed_; }
  double largest_force() const { return largest_force_; }  ///< [N]
  /// The largest sum of the forces half a period apart: zero where the law is odd and u has odd orders only [N].
  double asymmetry() const;
  double mean_force() const { return mean_force_; }  ///< F_0 [N]
  Complex force(int k) const { return force_[place(k)]; }
  double force_at(double angle) const;  ///< between samples in a straight line [N]
  double dissipated() const;            ///< over a period [J]

  /// dF_k by the real and the imaginary part of U_l [N/m].
  void derivative(int k, int l, Complex& by_real, Complex& by_imaginary) const {
    by_real = by_(place(k), 1 + 2 * place(l));
    by_imaginary = by_(place(k), 2 + 2 * place(l));
  }
  Complex derivative_by_mean(int k) const { return by_(place(k), 0); }
  /// dF_0 by the real and the imaginary part of U_l, and by the mean [N/m].
  void mean_derivative(int l, double& by_real, double& by_imaginary) const {
    by_real = mean_by_[1 + 2 * place(l)];
    by_imaginary = mean_by_[2 + 2 * place(l)];
  }
  double mean_derivative() const { return mean_by_[0]; }

 private:
  /// Where the law is asked: a sample, or a turn between two.
  struct Place {
    model::LawPoint point;
    Complex unit_vector;
    int sample = -1;  ///< -1: a turn
  };
  Index place(int k) const { return (k - 1) / orders_.stride; }
  void find_places(const Orders& orders, const Complex* coefficients);
  void find_forces();
  /// One period from a memory; writes forces, and the memory at its end.
  void march(const Vector& start, Vector& end);
  /// The slopes of the memory at the end of a period by that at its start [m x m].
  Matrix carry(const Vector& start);
  /// Carries the derivatives by all unknowns along a period. With `forces` those of the forces are written too.
  void carry(const Vector& start, Matrix& of_memory, bool forces);
  void close();
  void step_slopes(const model::LawPoint& from, const double* memory, const model::LawPoint& to);
  void set_motion(const Place& place, Vector& of_u, Vector& of_rate) const;
  void differentiate_without_memory();
  void find_derivatives_of_forces();

  const model::Law& law_;
  double normal_;
  const model::LawSlopes* own_slopes_;  ///< null: by differences
  Index memory_;
  double least_forgotten_;  ///< in a period, of what is not kept for ever
  double angular_frequency_ = 0.0;
  SampleAngles* angles_ = nullptr;
  Orders orders_;
  Vector u_, rate_, f_;          ///< at the samples
  Vector by_u_, by_rate_;        ///< of the force at them
  std::vector<Place> places_;    ///< of a period, the first sample at its start; the last is that again
  std::vector<Vector> started_;  ///< the memory at the start of each period that was marched
  Vector now_, next_, length_;   ///< memory; its largest numbers over the period
  bool has_closed_ = true;
  double largest_force_ = 0.0, mean_force_ = 0.0, u_scale_ = 0.0;
  ComplexVector force_;
  // Derivatives: by the mean, then by the real and the imaginary part of each order.
  Matrix slopes_;     ///< of a step, as model::LawSlopes has them, transposed [4 + m x 1 + m]
  Matrix of_forces_;  ///< of the force at each sample [samples x unknowns]
  ComplexMatrix by_;  ///< of F_k [orders x unknowns]
  Vector mean_by_;    ///< of F_0 [unknowns]
  Vector perturbed_, memory_there_;
};

}  // namespace rubato::steady
