#pragma once

#include <rubato/system/excitation.hpp>

#include <vector>

namespace rubato::steady {

/// Which sliders of a structure are springs; the others are removed. All or none: its two linear limits.
using StuckSliders = std::vector<bool>;

/// The sum of kT b b^T of the stuck sliders [n x n] [N/m].
SparseMatrix springs_of(const system::LocallyNonlinear& system, const StuckSliders& stuck);

/// K plus kT of the stuck sliders.
SparseMatrix stiffness_with(const system::LocallyNonlinear& system, const StuckSliders& stuck);

/// Z(w) = K + held S - w^2 M + i w C, S springs such as those of stuck sliders, entry by entry on the joint symmetric
/// pattern of its terms, diagonal included.
class AssembledStiffness {
 public:
  using SparseComplexMatrix = Eigen::SparseMatrix<Complex>;

  /// @param springs  S [n x n] [N/m]
  AssembledStiffness(const system::LocallyNonlinear& system, const SparseMatrix& springs);

  Index size() const { return matrix_.rows(); }
  /// @param angular_frequency  w >= 0 [rad/s]
  /// @param held               part of the springs, 0 to 1 [-]
  void assemble(double angular_frequency, double held);
  /// |K + held ...| + w^2 |M| + w |C|, entry by entry, of what was assembled last.
  void assemble_sizes(SparseMatrix& sizes) const;

  const SparseMatrix& pattern() const { return stiffness_; }
  const SparseMatrix& damping() const { return damping_; }
  const SparseComplexMatrix& matrix() const { return matrix_; }
  SparseComplexMatrix& matrix() { return matrix_; }
  /// The diagonal of the sizes [n]: what a pivot is the sum of.
  const Vector& scale() const { return scale_; }

 private:
  SparseMatrix stiffness_, springs_, mass_, damping_;  ///< all of one pattern
  std::vector<Index> diagonal_;                        ///< where the diagonal is among the entries
  SparseComplexMatrix matrix_;
  Vector scale_;
  double frequency_ = 0.0, held_ = 0.0;
};

/// K - w^2 M + i w C of full matrices.
inline ComplexMatrix assembled_stiffness(const Matrix& stiffness, const Matrix& mass, const Matrix& damping, double w) {
  ComplexMatrix z(stiffness.rows(), stiffness.cols());
  z.real() = stiffness - (w * w) * mass;
  z.imag() = w * damping;
  return z;
}

}  // namespace rubato::steady
