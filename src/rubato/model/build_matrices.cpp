#include <rubato/model/build_parts.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace rubato::model {
namespace {

SparseMatrix to_sparse(const MatrixDescription& matrix, int size) {
  if (matrix.size != size)
    throw InvalidInput(matrix.where, fmt::format("the matrix \"{}\" is {} x {}, but the mass matrix is {} x {}",
                                                 matrix.file, matrix.size, matrix.size, size, size));
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(matrix.entries.size());
  for (const auto& entry : matrix.entries) entries.emplace_back(entry.row, entry.column, entry.value);
  SparseMatrix sparse(size, size);
  sparse.setFromTriplets(entries.begin(), entries.end());
  return SparseMatrix(0.5 * (sparse + SparseMatrix(sparse.transpose())));
}

}  // namespace

void require_masses(const MatricesDescription& matrices) {
  std::vector<std::pair<int, double>> diagonal;
  for (const auto& entry : matrices.mass.entries)
    if (entry.row == entry.column) diagonal.emplace_back(entry.row, entry.value);
  std::sort(diagonal.begin(), diagonal.end());
  std::size_t i = 0;
  for (int row = 0; row < matrices.mass.size; ++row) {
    double mass = 0.0;
    for (; i < diagonal.size() && diagonal[i].first == row; ++i) mass += diagonal[i].second;
    if (mass > 0.0) continue;
    const auto place = static_cast<std::size_t>(row);
    const std::string name = place < matrices.names.size() ? matrices.names[place] : std::to_string(row + 1);
    throw InvalidInput(matrices.mass.where,
                       fmt::format("the mass matrix \"{}\" gives coordinate \"{}\" the mass {}; it must be positive",
                                   matrices.mass.file, name, mass));
  }
}

FullMatrices build_matrices(const MatricesDescription& matrices) {
  const int size = matrices.mass.size;
  FullMatrices full;
  full.mass = to_sparse(matrices.mass, size);
  full.stiffness = to_sparse(matrices.stiffness, size);
  full.damping = matrices.damping ? to_sparse(*matrices.damping, size) : SparseMatrix(size, size);
  return full;
}

}  // namespace rubato::model
