#include <rubato/steady/harmonic_balance/small_lu.hpp>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <utility>

// The decompositions of Newton's method, in a file of their own: they take long to compile.
namespace rubato::steady {
namespace {

template <class Pivots>
double ratio(const Pivots& pivots) {
  double least = pivots[0], largest = pivots[0];
  for (Index i = 1; i < pivots.size(); ++i) {
    least = std::min<double>(least, pivots[i]);
    largest = std::max<double>(largest, pivots[i]);
  }
  return least > 0.0 && std::isfinite(largest) ? least / largest : 0.0;
}

}  // namespace

double SmallLu::factorise() {
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

void SmallLu::solve(Vector& x) const {
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

void solve_by_least_change(const Matrix& matrix, Vector& x) {
  x = matrix.completeOrthogonalDecomposition().solve(x).eval();
}

}  // namespace rubato::steady
