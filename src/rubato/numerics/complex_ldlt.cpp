#include <rubato/numerics/complex_ldlt.hpp>

#include <Eigen/OrderingMethods>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::numerics {

using Complex = std::complex<double>;

void ComplexLdlt::analyse(const SparseMatrix& pattern) {
  n_ = pattern.rows();
  const auto n = static_cast<std::size_t>(n_);
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(pattern, permutation);
  order_.assign(permutation.indices().data(), permutation.indices().data() + n_);
  position_.resize(n);
  for (std::size_t place = 0; place < n; ++place) position_[static_cast<std::size_t>(order_[place])] = int(place);

  // Elimination tree and the length of each column: row k of L holds the paths from its entries up to k.
  parent_.assign(n, -1);
  mark_.assign(n, -1);
  std::vector<int> count(n, 0);
  for (int k = 0; k < int(n_); ++k) {
    mark_[std::size_t(k)] = k;
    for (SparseMatrix::InnerIterator entry(pattern, order_[std::size_t(k)]); entry; ++entry)
      for (int i = position_[std::size_t(entry.row())]; i < k && mark_[std::size_t(i)] != k;
           i = parent_[std::size_t(i)]) {
        if (parent_[std::size_t(i)] < 0) parent_[std::size_t(i)] = k;
        ++count[std::size_t(i)];
        mark_[std::size_t(i)] = k;
      }
  }
  start_.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) start_[i + 1] = start_[i] + count[i];
  row_.resize(static_cast<std::size_t>(start_[n]));
  value_.resize(row_.size());
  pivot_.resize(n);
  work_.assign(n, 0.0);
  path_.resize(n);
  filled_.resize(n);
}

Index ComplexLdlt::factorise(const SparseComplexMatrix& matrix, const Vector& scale) {
  const double tiny = std::numeric_limits<double>::epsilon();
  Index replaced = 0;
  std::fill(mark_.begin(), mark_.end(), -1);
  std::fill(filled_.begin(), filled_.end(), 0);
  for (int k = 0; k < int(n_); ++k) {
    // Row k of the matrix, and the columns that reach it in an order in which each comes before its ancestors.
    mark_[std::size_t(k)] = k;
    int top = int(n_);
    Complex diagonal = 0.0;
    for (SparseComplexMatrix::InnerIterator entry(matrix, order_[std::size_t(k)]); entry; ++entry) {
      int i = position_[std::size_t(entry.row())];
      if (i > k) continue;
      if (i == k) {
        diagonal += entry.value();
        continue;
      }
      work_[std::size_t(i)] += entry.value();
      int length = 0;
      for (; mark_[std::size_t(i)] != k; i = parent_[std::size_t(i)]) {
        path_[std::size_t(length++)] = i;
        mark_[std::size_t(i)] = k;
      }
      while (length > 0) path_[std::size_t(--top)] = path_[std::size_t(--length)];
    }
    for (; top < int(n_); ++top) {
      const auto j = static_cast<std::size_t>(path_[std::size_t(top)]);
      const Complex now = work_[j];
      work_[j] = 0.0;
      const int end = start_[j] + filled_[j];
      // Products by parts: the operator of std::complex looks after infinities, at three times the price.
      const double re = now.real(), im = now.imag();
      for (int p = start_[j]; p < end; ++p) {
        const Complex l = value_[std::size_t(p)];
        Complex& target = work_[std::size_t(row_[std::size_t(p)])];
        target = {target.real() - (l.real() * re - l.imag() * im), target.imag() - (l.real() * im + l.imag() * re)};
      }
      const Complex multiplier = now / pivot_[j];
      diagonal -= multiplier * now;
      row_[std::size_t(end)] = k;
      value_[std::size_t(end)] = multiplier;
      ++filled_[j];
    }
    const double least = tiny * scale[order_[std::size_t(k)]];
    if (std::abs(diagonal) < least) {
      diagonal = {0.0, least};
      ++replaced;
    }
    pivot_[std::size_t(k)] = diagonal;
  }
  return replaced;
}

void ComplexLdlt::solve(Eigen::Ref<Eigen::MatrixXcd> x) const {
  std::vector<Complex> y(static_cast<std::size_t>(n_));
  for (Index column = 0; column < x.cols(); ++column) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = x(order_[i], column);
    for (std::size_t j = 0; j < y.size(); ++j) {
      const double re = y[j].real(), im = y[j].imag();
      for (int p = start_[j]; p < start_[j + 1]; ++p) {
        const Complex l = value_[std::size_t(p)];
        Complex& target = y[std::size_t(row_[std::size_t(p)])];
        target = {target.real() - (l.real() * re - l.imag() * im), target.imag() - (l.real() * im + l.imag() * re)};
      }
    }
    for (std::size_t j = y.size(); j-- > 0;) {
      const Complex scaled = y[j] / pivot_[j];
      double re = scaled.real(), im = scaled.imag();
      for (int p = start_[j]; p < start_[j + 1]; ++p) {
        const Complex l = value_[std::size_t(p)], above = y[std::size_t(row_[std::size_t(p)])];
        re -= l.real() * above.real() - l.imag() * above.imag();
        im -= l.real() * above.imag() + l.imag() * above.real();
      }
      y[j] = {re, im};
    }
    for (std::size_t i = 0; i < y.size(); ++i) x(order_[i], column) = y[i];
  }
}

}  // namespace rubato::numerics
