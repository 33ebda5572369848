#include <rubato/model/finite_elements/freedoms.hpp>
#include <rubato/model/finite_elements/rigid_motions.hpp>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

std::vector<std::size_t> nodes_of_rows(const FiniteElements& model) {
  std::vector<std::size_t> nodes(model.rows.size(), model.nodes.size());
  for (std::size_t node = 0; node < model.places.size(); ++node)
    for (const Index row : model.places[node])
      if (row != ground) nodes[static_cast<std::size_t>(row)] = node;
  return nodes;
}

}  // namespace

Matrix rigid_motions(const FiniteElements& model, const Axis& about) {
  Matrix motions = Matrix::Zero(static_cast<Index>(model.rows.size()), 6);
  for (std::size_t node = 0; node < model.places.size(); ++node) {
    Axis arm = Axis::Zero();
    if (!model.positions.empty())
      arm = Axis(model.positions[node][0], model.positions[node][1], model.positions[node][2]) - about;
    for (Index axis = 0; axis < 6; ++axis) {
      const Index row = model.places[node][static_cast<std::size_t>(axis)];
      if (row == ground) continue;
      motions(row, axis) = 1.0;
      if (axis >= 3 || model.positions.empty()) continue;
      // e_k x arm, in the direction of this row
      for (Index k = 0; k < 3; ++k) motions(row, 3 + k) = Axis::Unit(k).cross(arm)[axis];
    }
  }
  return motions;
}

std::vector<Index> rows_far_from_held(const FiniteElements& model) {
  std::vector<char> is_near(model.nodes.size(), 0);
  bool holds_any = false;
  for (std::size_t node = 0; node < is_near.size(); ++node)
    if (model.is_held[node] != 0 || is_partly_held(model, node)) is_near[node] = holds_any = true;
  std::vector<Index> rows;
  if (!model.mesh || model.mesh->elements.empty()) {
    // Which nodes are near is not known, and neither is what a table leaves out: it may hold nodes.
    if (holds_any || !model.mesh) return rows;
  } else {
    std::vector<std::size_t> place(model.mesh->nodes.size(), model.nodes.size());
    for (std::size_t node = 0; node < model.nodes.size(); ++node)
      place[*model.mesh->place_of(model.nodes[node])] = node;
    const std::vector<char> is_held = is_near;
    for (const MeshElement& element : model.mesh->elements) {
      const auto first = model.mesh->element_nodes.begin() + static_cast<std::ptrdiff_t>(element.first);
      const auto last = first + static_cast<std::ptrdiff_t>(element.count);
      if (std::none_of(first, last,
                       [&](std::size_t node) { return place[node] < is_held.size() && is_held[place[node]] != 0; }))
        continue;
      for (auto node = first; node != last; ++node)
        if (place[*node] < is_near.size()) is_near[place[*node]] = 1;
    }
  }
  const std::vector<std::size_t> nodes = nodes_of_rows(model);
  for (std::size_t row = 0; row < nodes.size(); ++row)
    if (nodes[row] < is_near.size() && is_near[nodes[row]] == 0) rows.push_back(static_cast<Index>(row));
  return rows;
}

RigidCost rigid_cost(const FiniteElements& model, const Matrix& motions, const std::vector<Index>& rows) {
  RigidCost cost;
  Eigen::Matrix<double, 1, 6> force, size;
  for (const Index row : rows) {
    force.setZero();
    size.setZero();
    for (SparseMatrix::InnerIterator entry(model.stiffness.values, row); entry; ++entry) {
      const Eigen::Matrix<double, 1, 6> share = entry.value() * motions.row(entry.row());
      force += share;
      size += share.cwiseAbs();
    }
    for (Index k = 0; k < 6; ++k) {
      if (!(size[k] > 0.0)) continue;
      const double ratio = std::abs(force[k]) / size[k];
      if (ratio > cost.worst) cost = {ratio, row, k};
    }
  }
  return cost;
}

std::optional<SpinSoftening> spin_softening(const FiniteElements& model, const Matrix& motions, const Matrix& inertia,
                                            const std::vector<Index>& rows, double noise) {
  constexpr double good_fit = 1e-3;  // measured 1e-7 on a blade of 14 digits
  const auto n = static_cast<Index>(rows.size());
  Matrix force(n, 3), mass(n, 3);
  double size = 0.0;
  for (Index i = 0; i < n; ++i) {
    const Index row = rows[static_cast<std::size_t>(i)];
    force.row(i).setZero();
    mass.row(i) = inertia.row(row).head(3);
    for (SparseMatrix::InnerIterator entry(model.stiffness.values, row); entry; ++entry) {
      force.row(i) += entry.value() * motions.row(entry.row()).head(3);
      size = std::max(size, std::abs(entry.value()));
    }
  }
  // Less than round-off of the entries is nothing.
  if (!(force.cwiseAbs().maxCoeff() > 10.0 * noise * size)) return std::nullopt;
  const Eigen::Matrix3d normal = mass.transpose() * mass;
  if (!(normal.determinant() > 0.0)) return std::nullopt;
  const Eigen::Matrix3d softening = -normal.ldlt().solve(mass.transpose() * force);
  if ((force + mass * softening).norm() > good_fit * force.norm()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(0.5 * (softening + softening.transpose()));
  const Eigen::Vector3d squares = directions.eigenvalues();
  const bool is_spin = squares[2] > 0.0 && std::abs(squares[0]) < good_fit * squares[2] &&
                       std::abs(squares[1] - squares[2]) < good_fit * squares[2];
  if (!is_spin) return std::nullopt;
  Axis axis = directions.eigenvectors().col(0);
  Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0.0) axis = -axis;
  for (Index i = 0; i < 3; ++i)
    if (std::abs(axis[i]) < 1e-6) axis[i] = 0.0;  // round-off
  return SpinSoftening{std::sqrt(0.5 * (squares[1] + squares[2])), axis};
}

}  // namespace rubato::model
