#pragma once

#include <rubato/core/types.hpp>

#include <Eigen/LU>

#include <vector>

namespace rubato::steady {

/// L U of a square matrix with partial pivoting, for the many small systems of Newton's method: below some twenty rows
/// three times faster than Eigen's blocked one, which serves the larger ones. Allocates when the size grows only.
class SmallLu {
 public:
  Index size() const { return matrix_.rows(); }
  /// The matrix to fill before `factorise`, which overwrites it. [n x n]
  Matrix& matrix(Index n) {
    if (matrix_.rows() != n) matrix_.resize(n, n);
    return matrix_;
  }

  /// Returns the smallest pivot over the largest (0 for a singular or non-finite matrix).
  double factorise();

  /// x <- A^-1 x
  void solve(Vector& x) const;

 private:
  static constexpr Index most = 32;

  Matrix matrix_;
  std::vector<Index> pivot_;
  Eigen::PartialPivLU<Matrix> large_;
};

/// x <- the shortest x with A x nearest to the given one; for a singular A.
void solve_by_least_change(const Matrix& matrix, Vector& x);

}  // namespace rubato::steady
