#pragma once

#include <rubato/steady/harmonic_balance/group_derivatives.hpp>
#include <rubato/steady/harmonic_balance/law_group.hpp>
#include <rubato/steady/harmonic_balance/sample_angles.hpp>

#include <vector>

namespace rubato::steady {

/// LawBySamples of a group of laws: d displacements, d forces, one memory. Between samples all displacements go in
/// straight lines, which is of second order; more samples tell. Slopes of a step are those that the laws know, or
/// differences.
class GroupBySamples {
 public:
  explicit GroupBySamples(const LawGroup& law);

  Index size() const { return d_; }

  /// Finds the forces of the orders of the angles; those of u may be fewer.
  /// @param mean  of each number [d]   @param coefficients  of each number [d]
  void pass(SampleAngles& angles, double angular_frequency, const Vector& mean, const Orders& orders,
            const std::vector<const Complex*>& coefficients);
  /// Prepares the derivatives at the angles of the last pass, by all of their orders. They stay until the next call.
  void differentiate();

  /// Whether the memory repeats; else the laws do something that does not.
  bool has_closed() const { return has_closed_; }
  double largest_force() const { return f_.cwiseAbs().maxCoeff(); }  ///< [N]
  /// The largest sum of the forces half a period apart, as of LawBySamples [N].
  double asymmetry() const;
  double mean_force(Index i) const { return mean_force_[i]; }  ///< F_0 of a number [N]
  Complex force(Index i, int k) const { return force_(place(k), i); }
  /// Adds what each law dissipates over a period [J].
  void add_dissipated(Vector& work) const;

  /// dF_k of number i by the real and the imaginary part of U_l of number j [N/m].
  void derivative(Index i, Index j, int k, int l, Complex& by_real, Complex& by_imaginary) const {
    const ComplexMatrix& by = derivatives_.forces(i);
    by_real = by(place(k), column(j) + 1 + 2 * place(l));
    by_imaginary = by(place(k), column(j) + 2 + 2 * place(l));
  }
  Complex derivative_by_mean(Index i, Index j, int k) const { return derivatives_.forces(i)(place(k), column(j)); }
  /// dF_0 of number i by the real and the imaginary part of U_l of number j, and by its mean [N/m].
  void mean_derivative(Index i, Index j, int l, double& by_real, double& by_imaginary) const {
    by_real = derivatives_.means()(column(j) + 1 + 2 * place(l), i);
    by_imaginary = derivatives_.means()(column(j) + 2 + 2 * place(l), i);
  }
  double mean_derivative(Index i, Index j) const { return derivatives_.means()(column(j), i); }

 private:
  Index place(int k) const { return (k - 1) / orders_.stride; }
  Index column(Index j) const { return j * (1 + 2 * orders_.count); }
  GroupPoint point(Index sample) const {
    const Index i = sample % u_.cols();
    return {u_.col(i).data(), rate_.col(i).data()};
  }
  void march(const Vector& start, Vector& end);
  Matrix carry(const Vector& start);
  void step_slopes_of_period(const Vector& start);
  void step_slopes(const GroupPoint& from, const double* memory, const GroupPoint& to);

  const LawGroup& law_;
  Index d_, memory_;
  GroupDerivatives derivatives_;
  double angular_frequency_ = 0.0;
  SampleAngles* angles_ = nullptr;
  Orders orders_;
  Matrix u_, rate_;              ///< at the samples [d x samples]
  Matrix f_;                     ///< [samples x d]
  Vector scale_;                 ///< of each displacement
  std::vector<Vector> started_;  ///< the memory at the start of each period that was marched
  Vector now_, next_, length_;   ///< memory; its largest numbers over the period
  Vector force_now_;
  bool has_closed_ = true;
  ComplexMatrix force_;  ///< [orders x d]
  Vector mean_force_;
  Matrix tangent_;  ///< of forces by displacements and rates at the end of a step [d x 2d]
  Matrix slopes_;   ///< of a step, as GroupDerivatives has them
  Matrix steps_;    ///< of all steps of a period
  Vector u_there_, rate_there_, memory_there_, next_there_, force_there_;
  Matrix other_;  ///< a row of slopes_, to the other side
};

}  // namespace rubato::steady
