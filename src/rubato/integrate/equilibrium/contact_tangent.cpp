#include <rubato/integrate/equilibrium/contact_tangent.hpp>

#include <algorithm>

namespace rubato::integrate {

ContactTangent::ContactTangent(const system::LocallyNonlinear& system, const std::vector<Index>& place, Index free)
    : matrix_(free, free) {
  const auto at = [&](Index coordinate) {
    return coordinate == ground ? ground : place[static_cast<std::size_t>(coordinate)];
  };
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](Index row, Index column, double value) {
    if (row != ground && column != ground) entries.emplace_back(row, column, value);
  };
  for (Index column = 0; column < system.size(); ++column)
    for (SparseMatrix::InnerIterator entry(system.stiffness(), column); entry; ++entry)
      add(at(entry.row()), at(column), entry.value());
  for (Index i = 0; i < free; ++i) add(i, i, 0.0);
  for (const auto& ends : system.contacts()) {
    add(at(ends.first), at(ends.second), 0.0);
    add(at(ends.second), at(ends.first), 0.0);
  }
  matrix_.setFromTriplets(entries.begin(), entries.end());
  alone_.assign(matrix_.valuePtr(), matrix_.valuePtr() + matrix_.nonZeros());
  slots_.reserve(system.contacts().size());
  for (const auto& ends : system.contacts()) {
    const Index first = at(ends.first), second = at(ends.second);
    slots_.push_back({slot(first, first), slot(second, second), slot(first, second), slot(second, first)});
  }
}

const SparseMatrix& ContactTangent::with(const Vector& slope) {
  double* values = matrix_.valuePtr();
  std::copy(alone_.begin(), alone_.end(), values);
  for (std::size_t i = 0; i < slots_.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k)
      if (slots_[i][k] >= 0)
        values[slots_[i][k]] += k < 2 ? slope[static_cast<Index>(i)] : -slope[static_cast<Index>(i)];
  return matrix_;
}

Index ContactTangent::slot(Index row, Index column) const {
  if (row == ground || column == ground) return -1;
  const int* rows = matrix_.innerIndexPtr();
  const int *begin = rows + matrix_.outerIndexPtr()[column], *end = rows + matrix_.outerIndexPtr()[column + 1];
  return std::lower_bound(begin, end, static_cast<int>(row)) - rows;
}

}  // namespace rubato::integrate
