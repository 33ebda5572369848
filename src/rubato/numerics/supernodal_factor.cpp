#include <rubato/core/stopping.hpp>
#include <rubato/numerics/supernodal_factor.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::numerics {
namespace {

using ConstPanelMap = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;

/// The columns of panels while they are joined: `first` and one past the last, entries with zeros taken in, and of
/// these the zeros.
struct Columns {
  int first = 0, end = 0;
  double rows = 0.0, zeros = 0.0;
};

double panel_entries(double columns, double rows) { return columns * rows - 0.5 * columns * (columns - 1.0); }

/// Whether so many zeros among so many entries cost less than another panel.
bool is_worth(double columns, double zeros, double entries) {
  const double part = zeros / entries;
  return columns <= 4.0 || (columns <= 16.0 && part < 0.3) || (columns <= 48.0 && part < 0.05) || part < 0.02;
}

/// Panels of a tree in postorder: columns whose rows are those of the one before but for it, and joined ones.
std::vector<int> find_panels(const EliminationTree& tree, Index fixed) {
  const auto n = static_cast<int>(tree.parent.size());
  std::vector<Columns> panels;
  for (int j = 0; j < n; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const bool continues = j > 0 && j != fixed && tree.parent[at - 1] == j && tree.count[at - 1] == tree.count[at] + 1;
    if (continues)
      ++panels.back().end;
    else
      panels.push_back({j, j + 1, static_cast<double>(tree.count[at]), 0.0});
    // The panel before this one may hang from it: join while that is worth its zeros.
  }
  std::vector<Columns> joined;
  for (const Columns& panel : panels) {
    Columns now = panel;
    while (!joined.empty() && now.first != fixed) {
      const Columns& child = joined.back();
      const int root = tree.parent[static_cast<std::size_t>(child.end) - 1];
      if (root < now.first || root >= now.end) break;
      const double inner = child.end - child.first, columns = now.end - child.first, rows = inner + now.rows;
      const double entries = panel_entries(columns, rows);
      const double zeros = child.zeros + now.zeros + entries - panel_entries(inner, child.rows) -
                           panel_entries(now.end - now.first, now.rows);
      if (!is_worth(columns, zeros, entries)) break;
      now = {child.first, now.end, rows, zeros};
      joined.pop_back();
    }
    joined.push_back(now);
  }
  std::vector<int> first;
  for (const Columns& panel : joined) first.push_back(panel.first);
  first.push_back(n);
  return first;
}

/// L D L^T of the columns of a panel, in blocks, L and D over the matrix. Returns false at a pivot that cannot be.
bool eliminate_columns(Eigen::Map<Matrix> panel, Pivots pivots, double* inverse_diagonal) {
  constexpr Index most = 48;
  const Index width = panel.cols(), height = panel.rows();
  Matrix scaled;
  for (Index begin = 0; begin < width; begin += most) {
    const Index end = std::min(begin + most, width), below = height - end;
    for (Index j = begin; j < end; ++j) {
      const double pivot = panel(j, j);
      if (!is_pivot(pivot, pivots)) return false;
      inverse_diagonal[j] = 1.0 / pivot;
      for (Index k = j + 1; k < end; ++k) {
        const double factor = panel(k, j) * inverse_diagonal[j];
        for (Index i = k; i < end; ++i) panel(i, k) -= panel(i, j) * factor;
      }
      for (Index i = j + 1; i < end; ++i) panel(i, j) *= inverse_diagonal[j];
    }
    if (below == 0) break;
    auto lower = panel.block(end, begin, below, end - begin);
    panel.block(begin, begin, end - begin, end - begin)
        .triangularView<Eigen::UnitLower>()
        .transpose()
        .solveInPlace<Eigen::OnTheRight>(lower);
    scaled = lower.topRows(width - end);
    for (Index j = begin; j < end; ++j) lower.col(j - begin) *= inverse_diagonal[j];
    panel.block(end, end, below, width - end).noalias() -= lower * scaled.transpose();
  }
  return true;
}

}  // namespace

void SupernodalFactor::analyse(const SparseMatrix& matrix, const EliminationTree& tree, const EliminationOrder& order,
                               Index fixed) {
  n_ = static_cast<Index>(order.row.size());
  first_ = find_panels(tree, fixed);
  owner_.resize(order.row.size());
  row_start_.assign(1, 0);
  value_start_.assign(1, 0);
  row_.clear();
  std::vector<std::vector<int>> children(count());
  for (std::size_t s = 0; s < count(); ++s)
    std::fill(owner_.begin() + first_[s], owner_.begin() + first_[s + 1], static_cast<int>(s));
  std::vector<int> mark(order.row.size(), -1);
  for (std::size_t s = 0; s < count(); ++s) {
    const int first = first_[s], end = first_[s + 1];
    for (int j = first; j < end; ++j) row_.push_back(j);
    const std::size_t below = row_.size();
    const auto meet = [&](int row) {
      if (row < end || mark[static_cast<std::size_t>(row)] == static_cast<int>(s)) return;
      mark[static_cast<std::size_t>(row)] = static_cast<int>(s);
      row_.push_back(row);
    };
    for (int j = first; j < end; ++j)
      for (SparseMatrix::InnerIterator entry(matrix, order.row[static_cast<std::size_t>(j)]); entry; ++entry)
        meet(order.place[static_cast<std::size_t>(entry.row())]);
    for (const int child : children[s])
      for (Index p = row_start_[static_cast<std::size_t>(child)] + columns(static_cast<std::size_t>(child));
           p < row_start_[static_cast<std::size_t>(child) + 1]; ++p)
        meet(row_[static_cast<std::size_t>(p)]);
    std::sort(row_.begin() + static_cast<std::ptrdiff_t>(below), row_.end());
    if (row_.size() > below)
      children[static_cast<std::size_t>(owner_[static_cast<std::size_t>(row_[below])])].push_back(static_cast<int>(s));
    row_start_.push_back(static_cast<Index>(row_.size()));
    value_start_.push_back(value_start_.back() + static_cast<Index>(rows(s)) * columns(s));
  }
  value_.resize(static_cast<std::size_t>(value_start_.back()));
  inverse_diagonal_.resize(order.row.size());
  int most = 0;
  for (std::size_t s = 0; s < count(); ++s) most = std::max(most, rows(s) - columns(s));
  scratch_.resize(most);
}

void SupernodalFactor::gather(std::size_t s, const SparseMatrix& matrix, const EliminationOrder& order,
                              const std::vector<int>& local) {
  Panel own = panel(s);
  own.setZero();
  for (int j = first_[s]; j < first_[s + 1]; ++j)
    for (SparseMatrix::InnerIterator entry(matrix, order.row[static_cast<std::size_t>(j)]); entry; ++entry) {
      const int row = order.place[static_cast<std::size_t>(entry.row())];
      if (row >= j) own(local[static_cast<std::size_t>(row)], j - first_[s]) += entry.value();
    }
}

bool SupernodalFactor::factorise(const SparseMatrix& matrix, const EliminationOrder& order, Pivots pivots) {
  // Of each panel the next of its rows that has not yet been used; panels that wait to be used in each panel.
  std::vector<int> next(count(), 0), local(order.row.size(), 0), head(count(), -1), after(count(), -1);
  Matrix product, weighted;
  const auto wait = [&](std::size_t s) {
    if (next[s] >= rows(s)) return;
    const auto user = static_cast<std::size_t>(owner_[static_cast<std::size_t>(rows_of(s)[next[s]])]);
    after[s] = head[user];
    head[user] = static_cast<int>(s);
  };
  for (std::size_t s = 0; s < count(); ++s) {
    const int width = columns(s), height = rows(s), end = first_[s + 1];
    for (int i = 0; i < height; ++i) local[static_cast<std::size_t>(rows_of(s)[i])] = i;
    gather(s, matrix, order, local);
    Panel own = panel(s);
    for (int d = head[s], following; d != -1; d = following) {
      stop_if_asked();
      const auto child = static_cast<std::size_t>(d);
      following = after[child];
      const int* const rows_there = rows_of(child);
      const int from = next[child], there = rows(child);
      int to = from;
      while (to < there && rows_there[to] < end) ++to;
      const Panel source = panel(child);
      weighted.resize(to - from, source.cols());
      weighted = source.middleRows(from, to - from) * source.diagonal().asDiagonal();
      product.resize(there - from, to - from);
      product.noalias() = source.bottomRows(there - from) * weighted.transpose();
      for (int c = 0; c < to - from; ++c) {
        double* const target = own.data() + static_cast<Index>(height) * (rows_there[from + c] - first_[s]);
        for (int r = c; r < there - from; ++r)
          target[local[static_cast<std::size_t>(rows_there[from + r])]] -= product(r, c);
      }
      next[child] = to;
      wait(child);
    }
    if (!eliminate_columns(own, pivots, inverse_diagonal_.data() + first_[s])) return false;
    next[s] = width;
    wait(s);
  }
  return true;
}

void SupernodalFactor::eliminate(std::size_t s, double* y) const {
  const int width = columns(s), height = rows(s), below = height - width;
  const double* column = value_.data() + value_start_[s];
  double* const x = y + first_[s];
  for (int j = 0; j < width; ++j, column += height) {
    const double now = x[j];
    for (int i = j + 1; i < width; ++i) x[i] -= column[i] * now;
  }
  if (below == 0) return;
  const ConstPanelMap lower(value_.data() + value_start_[s] + width, below, width, Eigen::OuterStride<>(height));
  scratch_.head(below).noalias() = lower * Eigen::Map<const Vector>(x, width);
  const int* const row = rows_of(s) + width;
  for (int i = 0; i < below; ++i) y[row[i]] -= scratch_[i];
}

void SupernodalFactor::substitute(std::size_t s, double* y) const {
  const int width = columns(s), height = rows(s), below = height - width;
  double* const x = y + first_[s];
  const double* const inverse = inverse_diagonal_.data() + first_[s];
  for (int j = 0; j < width; ++j) x[j] *= inverse[j];
  if (below > 0) {
    const int* const row = rows_of(s) + width;
    for (int i = 0; i < below; ++i) scratch_[i] = y[row[i]];
    const ConstPanelMap lower(value_.data() + value_start_[s] + width, below, width, Eigen::OuterStride<>(height));
    Eigen::Map<Vector>(x, width).noalias() -= lower.transpose() * scratch_.head(below);
  }
  for (int j = width - 1; j >= 0; --j) {
    const double* const column = value_.data() + value_start_[s] + static_cast<Index>(j) * height;
    double now = x[j];
    for (int i = j + 1; i < width; ++i) now -= column[i] * x[i];
    x[j] = now;
  }
}

Index SupernodalFactor::bytes() const {
  return static_cast<Index>((value_.size() + inverse_diagonal_.size()) * sizeof(double) + row_.size() * sizeof(int));
}

}  // namespace rubato::numerics
