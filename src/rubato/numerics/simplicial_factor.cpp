#include <rubato/numerics/simplicial_factor.hpp>

namespace rubato::numerics {

void SimplicialFactor::analyse(const EliminationTree& tree) {
  n_ = static_cast<Index>(tree.parent.size());
  parent_ = tree.parent;
  start_.assign(1, 0);
  for (const int entries : tree.count) start_.push_back(start_.back() + entries - 1);
  row_.resize(static_cast<std::size_t>(start_.back()));
  value_.resize(row_.size());
  inverse_diagonal_.resize(static_cast<std::size_t>(n_));
}

bool SimplicialFactor::factorise(const SparseMatrix& matrix, const EliminationOrder& order, Pivots pivots) {
  const auto n = static_cast<std::size_t>(n_);
  std::vector<int> filled(n, 0), mark(n, -1), way(n);
  Vector sum = Vector::Zero(n_);
  for (std::size_t k = 0; k < n; ++k) {
    // The pattern of row k, children before parents, stacked from the end of `way`.
    std::size_t top = n;
    double pivot = 0.0;
    mark[k] = static_cast<int>(k);
    for (SparseMatrix::InnerIterator entry(matrix, order.row[k]); entry; ++entry) {
      auto i = static_cast<std::size_t>(order.place[static_cast<std::size_t>(entry.row())]);
      if (i > k) continue;
      if (i == k) {
        pivot += entry.value();
        continue;
      }
      sum[static_cast<Index>(i)] += entry.value();
      std::size_t steps = 0;
      for (; mark[i] != static_cast<int>(k); i = static_cast<std::size_t>(parent_[i])) {
        way[steps++] = static_cast<int>(i);
        mark[i] = static_cast<int>(k);
      }
      while (steps > 0) way[--top] = way[--steps];
    }
    for (; top < n; ++top) {
      const auto i = static_cast<std::size_t>(way[top]);
      const double now = sum[static_cast<Index>(i)];
      sum[static_cast<Index>(i)] = 0.0;
      const int begin = start_[i], end = begin + filled[i];
      for (int p = begin; p < end; ++p)
        sum[row_[static_cast<std::size_t>(p)]] -= value_[static_cast<std::size_t>(p)] * now;
      const double entry = now * inverse_diagonal_[i];
      pivot -= entry * now;
      row_[static_cast<std::size_t>(end)] = static_cast<int>(k);
      value_[static_cast<std::size_t>(end)] = entry;
      ++filled[i];
    }
    if (!is_pivot(pivot, pivots)) return false;
    inverse_diagonal_[k] = 1.0 / pivot;
  }
  return true;
}

Index SimplicialFactor::bytes() const {
  return static_cast<Index>(row_.size() * (sizeof(int) + sizeof(double)) + inverse_diagonal_.size() * sizeof(double));
}

}  // namespace rubato::numerics
