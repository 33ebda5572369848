#pragma once

#include <rubato/steady/harmonic_balance/law_group.hpp>
#include <rubato/steady/harmonic_balance/sample_angles.hpp>

#include <vector>

namespace rubato::steady {

/// LawBySamples of a group of laws: d displacements, d forces, one memory. Between samples all displacements go in
/// straight lines, which is of second order; more samples tell. Slopes of a step are those of differences.
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
    const ComplexMatrix& by = by_[static_cast<std::size_t>(i)];
    by_real = by(place(k), column(j) + 1 + 2 * place(l));
    by_imaginary = by(place(k), column(j) + 2 + 2 * place(l));
  }
  Complex derivative_by_mean(Index i, Index j, int k) const {
    return by_[static_cast<std::size_t>(i)](place(k), column(j));
  }
  /// dF_0 of number i by the real and the imaginary part of U_l of number j, and by its mean [N/m].
  void mean_derivative(Index i, Index j, int l, double& by_real, double& by_imaginary) const {
    by_real = mean_by_(column(j) + 1 + 2 * place(l), i);
    by_imaginary = mean_by_(column(j) + 2 + 2 * place(l), i);
  }
  double mean_derivative(Index i, Index j) const { return mean_by_(column(j), i); }

 private:
  Index place(int k) const { return (k - 1) / orders_.stride; }
  Index unknowns() const { return 1 + 2 * orders_.count; }  // of a number
  Index column(Index j) const { return j * unknowns(); }
  GroupPoint point(Index sample) const {
    const Index i = sample % u_.cols();
    return {u_.col(i).data(), rate_.col(i).data()};
  }
  void march(const Vector& start, Vector& end);
  Matrix carry(const Vector& start);
  void carry(const Vector& start, Matrix& of_memory, bool forces);
  void step_slopes(const GroupPoint& from, const double* memory, const GroupPoint& to);
  void set_motion(Index sample, Vector& of_u, Vector& of_rate) const;
  void take_step(const Vector& u0, const Vector& rate0, const Vector& u1, const Vector& rate1, const Matrix& of_memory,
                 Index row, Vector& sum) const;

  const LawGroup& law_;
  Index d_, memory_;
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
  // A column a quantity: the forces, then the memory; by u and the rates at the end of a step, at its start, by the
  // memory there.
  Matrix tangent_;                 ///< of forces by displacements and rates at the end of a step [d x 2d]
  Matrix slopes_;                  ///< [4 d + m x d + m]
  std::vector<Matrix> of_forces_;  ///< of each force at each sample [samples x d unknowns]
  std::vector<ComplexMatrix> by_;  ///< of each F_k [orders x d unknowns]
  Matrix mean_by_;                 ///< of each F_0 [d unknowns x d]
  Vector u_there_, rate_there_, memory_there_, next_there_, force_there_;
  Matrix other_;  ///< a row of slopes_, to the other side
};

}  // namespace rubato::steady
