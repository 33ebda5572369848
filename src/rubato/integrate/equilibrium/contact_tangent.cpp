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
  for (Index i = 0; i < system.contact_count(); ++i) {
    const std::vector<model::Share> joined = system.column(i);
    for (const model::Share& row : joined)
      for (const model::Share& other : joined) add(at(row.coordinate), at(other.coordinate), 0.0);
  }
  matrix_.setFromTriplets(entries.begin(), entries.end());
  alone_.assign(matrix_.valuePtr(), matrix_.valuePtr() + matrix_.nonZeros());
  for (Index i = 0; i < system.contact_count(); ++i) {
    const std::vector<model::Share> joined = system.column(i);
    for (const model::Share& row : joined)
      for (const model::Share& other : joined)
        if (const Index to = slot(at(row.coordinate), at(other.coordinate)); to >= 0)
          terms_.push_back({to, i, row.weight * other.weight});
  }
}

const SparseMatrix& ContactTangent::with(const Vector& slope) {
  double* values = matrix_.valuePtr();
  std::copy(alone_.begin(), alone_.end(), values);
  for (const Term& term : terms_) values[term.slot] += term.weight * slope[term.contact];
  return matrix_;
}

Index ContactTangent::slot(Index row, Index column) const {
  if (row == ground || column == ground) return -1;
  const int* rows = matrix_.innerIndexPtr();
  const int *begin = rows + matrix_.outerIndexPtr()[column], *end = rows + matrix_.outerIndexPtr()[column + 1];
  return std::lower_bound(begin, end, static_cast<int>(row)) - rows;
}

}  // namespace rubato::integrate
