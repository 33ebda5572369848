#include <rubato/integrate/steady/complex_ldlt.hpp>

#include <rubato/integrate/steady/trigonometric_series.hpp>

#include <Eigen/OrderingMethods>

#include <cmath>

namespace rubato::integrate {

void ComplexLdlt::analyse(const SparseComplexMatrix& matrix) {
  n_ = matrix.rows();
  const auto n = static_cast<std::size_t>(n_);
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(matrix, permutation);
  order_.assign(permutation.indices().data(), permutation.indices().data() + n_);
  position_.resize(n);
  for (std::size_t i = 0; i < n; ++i) position_[static_cast<std::size_t>(order_[i])] = static_cast<int>(i);

  // The upper triangle by columns of the permuted matrix.
  upper_start_.assign(n + 1, 0);
  const int* const outer = matrix.outerIndexPtr();
  const int* const inner = matrix.innerIndexPtr();
  for (std::size_t k = 0; k < n; ++k) {
    const int column = order_[k];
    for (int p = outer[column]; p < outer[column + 1]; ++p)
      if (const int i = position_[static_cast<std::size_t>(inner[p])]; i <= static_cast<int>(k)) {
        upper_row_.push_back(i);
        upper_source_.push_back(p);
      }
    upper_start_[k + 1] = static_cast<int>(upper_row_.size());
  }

  parent_.assign(n, -1);
  filled_.assign(n, 0);
  mark_.assign(n, -1);
  for (std::size_t k = 0; k < n; ++k) {
    mark_[k] = static_cast<int>(k);
    for (int p = upper_start_[k]; p < upper_start_[k + 1]; ++p)
      for (int i = upper_row_[static_cast<std::size_t>(p)]; mark_[static_cast<std::size_t>(i)] != static_cast<int>(k);
           i = parent_[static_cast<std::size_t>(i)]) {
        const auto at = static_cast<std::size_t>(i);
        if (parent_[at] < 0) parent_[at] = static_cast<int>(k);
        ++filled_[at];
        mark_[at] = static_cast<int>(k);
      }
  }
  start_.assign(n + 1, 0);
  for (std::size_t k = 0; k < n; ++k) start_[k + 1] = start_[k] + filled_[k];
  row_.resize(static_cast<std::size_t>(start_[n]));
  value_.resize(row_.size());
  diagonal_.resize(n);
  work_.assign(n, 0.0);
  path_.resize(n);
  pattern_.resize(n);
}

bool ComplexLdlt::factorise(const SparseComplexMatrix& matrix) {
  const Complex* const source = matrix.valuePtr();
  const int n = static_cast<int>(n_);
  std::fill(filled_.begin(), filled_.end(), 0);
  std::fill(mark_.begin(), mark_.end(), -1);
  std::fill(work_.begin(), work_.end(), Complex(0.0));
  Complex* const y = work_.data();
  for (int k = 0; k < n; ++k) {
    int top = n;
    mark_[static_cast<std::size_t>(k)] = k;
    for (int p = upper_start_[static_cast<std::size_t>(k)]; p < upper_start_[static_cast<std::size_t>(k) + 1]; ++p) {
      int i = upper_row_[static_cast<std::size_t>(p)];
      y[i] += source[upper_source_[static_cast<std::size_t>(p)]];
      int length = 0;
      for (; mark_[static_cast<std::size_t>(i)] != k; i = parent_[static_cast<std::size_t>(i)]) {
        path_[static_cast<std::size_t>(length++)] = i;
        mark_[static_cast<std::size_t>(i)] = k;
      }
      while (length > 0) pattern_[static_cast<std::size_t>(--top)] = path_[static_cast<std::size_t>(--length)];
    }
    Complex pivot = y[k];
    const double before = std::abs(pivot);
    y[k] = 0.0;
    for (; top < n; ++top) {
      const auto i = static_cast<std::size_t>(pattern_[static_cast<std::size_t>(top)]);
      const Complex yi = y[i];
      y[i] = 0.0;
      const int begin = start_[i], end = begin + filled_[i];
      for (int p = begin; p < end; ++p)
        y[row_[static_cast<std::size_t>(p)]] -= product(value_[static_cast<std::size_t>(p)], yi);
      const Complex entry = yi / diagonal_[i];
      pivot -= product(entry, yi);
      row_[static_cast<std::size_t>(end)] = k;
      value_[static_cast<std::size_t>(end)] = entry;
      ++filled_[i];
    }
    if (!(std::abs(pivot) > 1e-14 * before)) return false;
    diagonal_[static_cast<std::size_t>(k)] = pivot;
  }
  return true;
}

void ComplexLdlt::solve(const Eigen::MatrixXcd& load, Eigen::MatrixXcd& x) const {
  // By rows, so that each entry of L serves all columns at once.
  using Rows = Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Rows y(n_, load.cols());
  for (Index i = 0; i < n_; ++i) y.row(i) = load.row(order_[static_cast<std::size_t>(i)]);
  for (Index j = 0; j < n_; ++j)
    for (int p = start_[static_cast<std::size_t>(j)]; p < start_[static_cast<std::size_t>(j) + 1]; ++p)
      y.row(row_[static_cast<std::size_t>(p)]) -= value_[static_cast<std::size_t>(p)] * y.row(j);
  for (Index j = n_ - 1; j >= 0; --j) {
    y.row(j) /= diagonal_[static_cast<std::size_t>(j)];
    for (int p = start_[static_cast<std::size_t>(j)]; p < start_[static_cast<std::size_t>(j) + 1]; ++p)
      y.row(j) -= value_[static_cast<std::size_t>(p)] * y.row(row_[static_cast<std::size_t>(p)]);
  }
  x.resize(n_, load.cols());
  for (Index i = 0; i < n_; ++i) x.row(order_[static_cast<std::size_t>(i)]) = y.row(i);
}

}  // namespace rubato::integrate
