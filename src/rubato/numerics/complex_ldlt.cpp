#include <rubato/core/complex.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/numerics/complex_ldlt.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace rubato::numerics {

namespace {

// Products and quotients by parts: the operators of std::complex look after infinities, at three times the price.
inline Complex product(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
inline Complex inverse(Complex a) {
  // Scaled by its larger part, so that the square neither overflows nor vanishes.
  const double scale = 1.0 / std::max(std::abs(a.real()), std::abs(a.imag()));
  const double re = a.real() * scale, im = a.imag() * scale, factor = scale / (re * re + im * im);
  return {re * factor, -im * factor};
}

}  // namespace

void ComplexLdlt::analyse(const SparseMatrix& pattern, std::span<const int> last) {
  n_ = pattern.rows();
  const auto n = static_cast<std::size_t>(n_);
  order_ = minimum_degree(pattern, last);
  EliminationTree tree = elimination_tree(pattern, order_);
  start_.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) start_[i + 1] = start_[i] + tree.count[i] - 1;
  parent_ = std::move(tree.parent);
  mark_.assign(n, -1);
  row_.resize(static_cast<std::size_t>(start_[n]));
  value_.resize(row_.size());
  inverse_pivot_.resize(n);
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
    stop_if_asked();  // between two rows nothing is left in work_
    // Row k of the matrix, and the columns that reach it in an order in which each comes before its ancestors.
    mark_[std::size_t(k)] = k;
    int top = int(n_);
    Complex diagonal = 0.0;
    for (SparseComplexMatrix::InnerIterator entry(matrix, order_.row[std::size_t(k)]); entry; ++entry) {
      int i = order_.place[std::size_t(entry.row())];
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
      for (int p = start_[j]; p < end; ++p)
        work_[std::size_t(row_[std::size_t(p)])] -= product(value_[std::size_t(p)], now);
      const Complex multiplier = product(now, inverse_pivot_[j]);
      diagonal -= product(multiplier, now);
      row_[std::size_t(end)] = k;
      value_[std::size_t(end)] = multiplier;
      ++filled_[j];
    }
    const double least = tiny * scale[order_.row[std::size_t(k)]];
    if (std::max(std::abs(diagonal.real()), std::abs(diagonal.imag())) < least) {
      diagonal = {0.0, least};
      ++replaced;
    }
    inverse_pivot_[std::size_t(k)] = inverse(diagonal);
  }
  return replaced;
}

void ComplexLdlt::solve(Eigen::Ref<Eigen::MatrixXcd> x) const {
  std::vector<Complex> y(static_cast<std::size_t>(n_));
  for (Index column = 0; column < x.cols(); ++column) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = x(order_.row[i], column);
    for (std::size_t j = 0; j < y.size(); ++j)
      for (int p = start_[j]; p < start_[j + 1]; ++p)
        y[std::size_t(row_[std::size_t(p)])] -= product(value_[std::size_t(p)], y[j]);
    for (std::size_t j = y.size(); j-- > 0;) {
      Complex sum = product(y[j], inverse_pivot_[j]);
      for (int p = start_[j]; p < start_[j + 1]; ++p)
        sum -= product(value_[std::size_t(p)], y[std::size_t(row_[std::size_t(p)])]);
      y[j] = sum;
    }
    for (std::size_t i = 0; i < y.size(); ++i) x(order_.row[i], column) = y[i];
  }
}

void ComplexLdlt::reach(const SparseMatrix& columns, Index column, std::vector<int>& rows) {
  rows.clear();
  std::fill(mark_.begin(), mark_.end(), -1);
  for (SparseMatrix::InnerIterator entry(columns, column); entry; ++entry)
    for (int i = order_.place[std::size_t(entry.row())]; i >= 0 && mark_[std::size_t(i)] < 0;
         i = parent_[std::size_t(i)]) {
      mark_[std::size_t(i)] = 0;
      rows.push_back(i);
    }
  if (rows.size() < mark_.size() / 8) {
    std::sort(rows.begin(), rows.end());
    return;
  }
  rows.clear();
  for (std::size_t i = 0; i < mark_.size(); ++i)
    if (mark_[i] == 0) rows.push_back(static_cast<int>(i));
}

void ComplexLdlt::condense(const SparseMatrix& columns, Eigen::MatrixXcd& out) {
  const Index k = columns.cols();
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(k));
  for (Index c = 0; c < k; ++c) reach(columns, c, rows[std::size_t(c)]);
  // The short ones first: each pair costs the rows of its shorter column.
  std::vector<Index> sequence(static_cast<std::size_t>(k));
  std::iota(sequence.begin(), sequence.end(), Index{0});
  std::stable_sort(sequence.begin(), sequence.end(),
                   [&](Index a, Index b) { return rows[std::size_t(a)].size() < rows[std::size_t(b)].size(); });
  out.resize(k, k);
  std::vector<std::vector<Complex>> scaled(static_cast<std::size_t>(k));  // D^-1 Y, by the rows of each column
  for (std::size_t b = 0; b < sequence.size(); ++b) {
    const Index column = sequence[b];
    const auto& own = rows[std::size_t(column)];
    for (SparseMatrix::InnerIterator entry(columns, column); entry; ++entry)
      work_[std::size_t(order_.place[std::size_t(entry.row())])] += entry.value();
    auto& y = scaled[std::size_t(column)];
    y.reserve(own.size());
    for (const int j : own) {
      const Complex now = work_[std::size_t(j)];
      for (int p = start_[std::size_t(j)]; p < start_[std::size_t(j) + 1]; ++p)
        work_[std::size_t(row_[std::size_t(p)])] -= product(value_[std::size_t(p)], now);
      y.push_back(product(now, inverse_pivot_[std::size_t(j)]));
    }
    for (std::size_t a = 0; a <= b; ++a) {
      const Index other = sequence[a];
      Complex sum = 0.0;
      for (std::size_t i = 0; i < rows[std::size_t(other)].size(); ++i)
        sum += product(scaled[std::size_t(other)][i], work_[std::size_t(rows[std::size_t(other)][i])]);
      out(other, column) = out(column, other) = sum;
    }
    for (const int j : own) work_[std::size_t(j)] = 0.0;
  }
}

}  // namespace rubato::numerics
