#include <rubato/core/stopping.hpp>
#include <rubato/numerics/kkt_factor.hpp>

#include <Eigen/OrderingMethods>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <numeric>
#include <set>

namespace rubato::numerics {
namespace {

bool invert(double pivot, double& inverse) {
  inverse = 1.0 / pivot;
  return std::abs(pivot) > 1e-290 && std::abs(pivot) < 1e290;
}

/// An entry of L and that of U across the diagonal, in one register.
using Pair = double __attribute__((vector_size(2 * sizeof(double))));

inline Pair load(const double* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof pair);
  return pair;
}

inline void store(Pair pair, double* to) { std::memcpy(to, &pair, sizeof pair); }

}  // namespace

void KktFactor::order(Index first_row, std::span<const Entry> entries) {
  std::vector<Eigen::Triplet<double>> pattern;
  pattern.reserve(2 * entries.size() + static_cast<std::size_t>(size_));
  for (const auto& [i, j] : entries) {
    pattern.emplace_back(i, j, 1.0);
    pattern.emplace_back(j, i, 1.0);
  }
  for (Index i = 0; i < size_; ++i) pattern.emplace_back(i, i, 1.0);
  SparseMatrix matrix(size_, size_);
  matrix.setFromTriplets(pattern.begin(), pattern.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(matrix, permutation);
  std::vector<double> key(static_cast<std::size_t>(size_));
  for (Index i = 0; i < size_; ++i) key[static_cast<std::size_t>(permutation.indices()[i])] = static_cast<double>(i);
  for (const auto& [i, j] : entries) {
    if ((i < first_row) == (j < first_row)) continue;
    const auto row = static_cast<std::size_t>(std::max(i, j)), other = static_cast<std::size_t>(std::min(i, j));
    key[row] = std::max(key[row], key[other] + 0.5);
  }
  std::vector<int> unknown(static_cast<std::size_t>(size_));
  std::iota(unknown.begin(), unknown.end(), 0);
  std::stable_sort(unknown.begin(), unknown.end(),
                   [&](int a, int b) { return key[static_cast<std::size_t>(a)] < key[static_cast<std::size_t>(b)]; });
  position_.resize(static_cast<std::size_t>(size_));
  for (std::size_t place = 0; place < unknown.size(); ++place)
    position_[static_cast<std::size_t>(unknown[place])] = static_cast<int>(place);
}

void KktFactor::find_factors(std::span<const Entry> entries) {
  const auto n = static_cast<std::size_t>(size_);
  std::vector<std::vector<int>> column(n);
  for (const auto& [i, j] : entries) {
    const int a = position_[static_cast<std::size_t>(i)], b = position_[static_cast<std::size_t>(j)];
    if (a != b) column[static_cast<std::size_t>(std::min(a, b))].push_back(std::max(a, b));
  }
  const auto make_set = [](std::vector<int>& rows) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  };
  // What a column leaves behind goes to the column of its first row (elimination tree).
  for (auto& rows : column) {
    make_set(rows);
    if (rows.size() < 2) continue;
    auto& parent = column[static_cast<std::size_t>(rows.front())];
    parent.insert(parent.end(), rows.begin() + 1, rows.end());
  }
  start_.assign(1, 0);
  row_.clear();
  for (const auto& rows : column) {
    row_.insert(row_.end(), rows.begin(), rows.end());
    start_.push_back(static_cast<int>(row_.size()));
  }
  target_.clear();
  for (const auto& rows : column)
    for (std::size_t b = 0; b < rows.size(); ++b) {
      const auto to = static_cast<std::size_t>(rows[b]);
      auto at = row_.begin() + start_[to];
      for (std::size_t a = b + 1; a < rows.size(); ++a) {
        at = std::lower_bound(at, row_.begin() + start_[to + 1], rows[a]);
        target_.push_back(static_cast<int>(at - row_.begin()));
      }
    }
}

void KktFactor::analyse(Index size, Index first_row, std::span<const Entry> entries, bool is_symmetric) {
  size_ = size;
  first_row_ = first_row;
  is_symmetric_ = is_symmetric;
  order(first_row, entries);
  find_factors(entries);
  value_.assign(static_cast<std::size_t>(size_) + row_.size() * (is_symmetric ? 1 : 2) + 1, 0.0);
  x_.resize(static_cast<std::size_t>(size_));
}

int KktFactor::slot(Index i, Index j) const {
  const int a = position_[static_cast<std::size_t>(i)], b = position_[static_cast<std::size_t>(j)];
  if (a == b) return a;
  if (a < b && is_symmetric_) return spare_slot();
  const auto column = static_cast<std::size_t>(std::min(a, b));
  const auto end = row_.begin() + start_[column + 1];
  const auto found = std::lower_bound(row_.begin() + start_[column], end, std::max(a, b));
  assert(found != end && *found == std::max(a, b));
  const int place = static_cast<int>(found - row_.begin()), first = static_cast<int>(size_);
  return is_symmetric_ ? first + place : first + 2 * place + (a > b ? 0 : 1);
}

void KktFactor::set_zero() { std::fill(value_.begin(), value_.end(), 0.0); }

bool KktFactor::factorise() {
  stop_if_asked();
  return is_symmetric_ ? factorise_symmetric() : factorise_both();
}

bool KktFactor::factorise_symmetric() {
  const int n = static_cast<int>(size_);
  double* const diagonal = value_.data();
  double* const lower = diagonal + n;
  const int* const start = start_.data();
  const int* const row = row_.data();
  const int* target = target_.data();
  for (int j = 0; j < n; ++j) {
    double inverse;
    if (!invert(diagonal[j], inverse)) return false;
    diagonal[j] = inverse;
    const int end = start[j + 1];
    for (int b = start[j]; b < end; ++b) {
      const double scaled = lower[b] * inverse;
      diagonal[row[b]] -= scaled * lower[b];
      for (int a = b + 1; a < end; ++a) lower[*target++] -= scaled * lower[a];
      lower[b] = scaled;
    }
  }
  return true;
}

bool KktFactor::factorise_both() {
  const int n = static_cast<int>(size_);
  double* const diagonal = value_.data();
  double* const both = diagonal + n;
  const int* const start = start_.data();
  const int* const row = row_.data();
  const int* target = target_.data();
  for (int j = 0; j < n; ++j) {
    double inverse;
    if (!invert(diagonal[j], inverse)) return false;
    diagonal[j] = inverse;
    const int end = start[j + 1];
    for (int b = start[j]; b < end; ++b) {
      const double scaled = both[2 * b] * inverse, across = both[2 * b + 1];
      diagonal[row[b]] -= scaled * across;
      const Pair factor = {across * inverse, scaled};
      for (int a = b + 1; a < end; ++a) {
        double* const to = both + 2 * *target++;
        store(load(to) - factor * load(both + 2 * a), to);
      }
      both[2 * b] = scaled;
    }
  }
  return true;
}

Index KktFactor::negative_pivots() const {
  return static_cast<Index>(
      std::count_if(value_.begin(), value_.begin() + size_, [](double pivot) { return pivot < 0.0; }));
}

template <int stride>
void KktFactor::substitute(double* y) const {
  const int n = static_cast<int>(size_);
  const double* const inverse = value_.data();
  const double* const lower = inverse + n;
  const double* const upper = lower + stride - 1;
  const int* const start = start_.data();
  const int* const row = row_.data();
  for (int j = 0; j < n; ++j) {
    const double now = y[j];
    for (int p = start[j]; p < start[j + 1]; ++p) y[row[p]] -= lower[stride * p] * now;
  }
  // Symmetric: U = D L^T; otherwise rows of U carry the pivots. The nearest row, known last, comes last.
  for (int j = n - 1; j >= 0; --j) {
    double now = stride == 1 ? y[j] * inverse[j] : y[j];
    for (int p = start[j + 1] - 1; p >= start[j]; --p) now -= upper[stride * p] * y[row[p]];
    y[j] = stride == 1 ? now : now * inverse[j];
  }
}

void KktFactor::solve(double* x, double* rest) const {
  const int n = static_cast<int>(size_), first_row = static_cast<int>(first_row_);
  double* const y = x_.data();
  const int* const position = position_.data();
  for (int i = 0; i < first_row; ++i) y[position[i]] = x[i];
  for (int i = first_row; i < n; ++i) y[position[i]] = rest[i - first_row];
  if (is_symmetric_)
    substitute<1>(y);
  else
    substitute<2>(y);
  for (int i = 0; i < first_row; ++i) x[i] = y[position[i]];
  for (int i = first_row; i < n; ++i) rest[i - first_row] = y[position[i]];
}

}  // namespace rubato::numerics
