#pragma once

#include <rubato/core/types.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace rubato::integrate {

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
  double factorise() {
    const Index n = size();
    if (n > most) {
      large_.compute(matrix_);
      return ratio(large_.matrixLU().diagonal().cwiseAbs());
    }
    pivot_.resize(static_cast<std::size_t>(n));
    for (Index k = 0; k < n; ++k) {
      double* const column = matrix_.data() + k * n;
      Index best = k;
      for (Index i = k + 1; i < n; ++i)
        if (std::abs(column[i]) > std::abs(column[best])) best = i;
      pivot_[static_cast<std::size_t>(k)] = best;
      if (best != k)
        for (Index j = 0; j < n; ++j) std::swap(matrix_(k, j), matrix_(best, j));
      const double inverse = 1.0 / column[k];
      for (Index i = k + 1; i < n; ++i) column[i] *= inverse;
      for (Index j = k + 1; j < n; ++j) {
        double* const other = matrix_.data() + j * n;
        const double factor = other[k];
        for (Index i = k + 1; i < n; ++i) other[i] -= factor * column[i];
      }
    }
    return ratio(matrix_.diagonal().cwiseAbs());
  }

  /// x <- A^-1 x
  void solve(Vector& x) const {
    const Index n = size();
    if (n > most) {
      x = large_.solve(x);
      return;
    }
    for (Index k = 0; k < n; ++k) std::swap(x[k], x[pivot_[static_cast<std::size_t>(k)]]);
    for (Index k = 0; k < n; ++k) {
      const double* const column = matrix_.data() + k * n;
      for (Index i = k + 1; i < n; ++i) x[i] -= x[k] * column[i];
    }
    for (Index k = n - 1; k >= 0; --k) {
      const double* const column = matrix_.data() + k * n;
      x[k] /= column[k];
      for (Index i = 0; i < k; ++i) x[i] -= x[k] * column[i];
    }
  }

 private:
  static constexpr Index most = 32;

  template <class Pivots>
  static double ratio(const Pivots& pivots) {
    double least = pivots[0], largest = pivots[0];
    for (Index i = 1; i < pivots.size(); ++i) {
      least = std::min<double>(least, pivots[i]);
      largest = std::max<double>(largest, pivots[i]);
    }
    return least > 0.0 && std::isfinite(largest) ? least / largest : 0.0;
  }

  Matrix matrix_;
  std::vector<Index> pivot_;
  Eigen::PartialPivLU<Matrix> large_;
};

}  // namespace rubato::integrate
