#include <rubato/numerics/elimination_tree.hpp>

#include <camd.h>

#include <new>
#include <utility>

namespace rubato::numerics {

double EliminationTree::entries() const {
  double sum = 0.0;
  for (const int entries : count) sum += entries;
  return sum;
}

double EliminationTree::operations() const {
  double sum = 0.0;
  for (const int entries : count) sum += static_cast<double>(entries) * entries;
  return sum;
}

EliminationOrder::EliminationOrder(std::vector<int> rows) : row(std::move(rows)), place(row.size()) {
  for (std::size_t i = 0; i < row.size(); ++i) place[static_cast<std::size_t>(row[i])] = static_cast<int>(i);
}

EliminationOrder minimum_degree(const SparseMatrix& pattern, std::span<const int> last) {
  const auto n = static_cast<std::size_t>(pattern.rows());
  std::vector<int> order(n), constraint(n, 0);
  for (const int row : last) constraint[static_cast<std::size_t>(row)] = 1;
  double control[CAMD_CONTROL], info[CAMD_INFO];
  camd_defaults(control);
  const int status = camd_order(static_cast<int>(n), pattern.outerIndexPtr(), pattern.innerIndexPtr(), order.data(),
                                control, info, last.empty() ? nullptr : constraint.data());
  if (status != CAMD_OK && status != CAMD_OK_BUT_JUMBLED) throw std::bad_alloc();
  return EliminationOrder(std::move(order));
}

EliminationTree elimination_tree(const SparseMatrix& matrix, const EliminationOrder& order) {
  const auto n = static_cast<std::size_t>(matrix.rows());
  EliminationTree tree{std::vector<int>(n, -1), std::vector<int>(n, 1)};
  std::vector<int> mark(n, -1);
  // Row k of L has an entry in every column on the ways up from the entries of row k of the matrix.
  for (int k = 0; k < static_cast<int>(n); ++k) {
    mark[static_cast<std::size_t>(k)] = k;
    for (SparseMatrix::InnerIterator entry(matrix, order.row[static_cast<std::size_t>(k)]); entry; ++entry)
      for (int i = order.place[static_cast<std::size_t>(entry.row())]; i < k && mark[static_cast<std::size_t>(i)] != k;
           i = tree.parent[static_cast<std::size_t>(i)]) {
        int& parent = tree.parent[static_cast<std::size_t>(i)];
        if (parent < 0) parent = k;
        ++tree.count[static_cast<std::size_t>(i)];
        mark[static_cast<std::size_t>(i)] = k;
      }
  }
  return tree;
}

std::vector<int> postorder(const EliminationTree& tree, Index fixed) {
  const std::size_t n = tree.parent.size(), free = static_cast<std::size_t>(fixed);
  std::vector<int> first_child(n, -1), sibling(n, -1), roots, places, waiting;
  for (std::size_t j = free; j-- > 0;) {  // backwards, so that siblings keep their order
    const int parent = tree.parent[j];
    if (parent == -1 || parent >= static_cast<int>(fixed)) {
      roots.push_back(static_cast<int>(j));
      continue;
    }
    sibling[j] = first_child[static_cast<std::size_t>(parent)];
    first_child[static_cast<std::size_t>(parent)] = static_cast<int>(j);
  }
  places.reserve(n);
  for (std::size_t r = roots.size(); r-- > 0;) {
    waiting.assign(1, roots[r]);
    while (!waiting.empty()) {
      const auto j = static_cast<std::size_t>(waiting.back());
      if (const int child = first_child[j]; child != -1) {
        first_child[j] = sibling[static_cast<std::size_t>(child)];
        waiting.push_back(child);
      } else {
        places.push_back(static_cast<int>(j));
        waiting.pop_back();
      }
    }
  }
  for (std::size_t j = free; j < n; ++j) places.push_back(static_cast<int>(j));
  return places;
}

}  // namespace rubato::numerics
