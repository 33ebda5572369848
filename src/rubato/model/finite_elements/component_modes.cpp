#include <rubato/model/finite_elements/component_modes.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::model {
namespace {

constexpr double same = 1e-9;        // of a shape that the others span already, squared share [-]
constexpr double round_off = 1e-20;  // of a shape, squared [-]

SparseMatrix part(const SparseMatrix& matrix, const std::vector<Index>& rows, const std::vector<Index>& columns) {
  std::vector<Index> place(static_cast<std::size_t>(matrix.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) place[static_cast<std::size_t>(rows[i])] = static_cast<Index>(i);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (SparseMatrix::InnerIterator entry(matrix, columns[j]); entry; ++entry)
      if (const Index row = place[static_cast<std::size_t>(entry.row())]; row >= 0)
        entries.emplace_back(static_cast<int>(row), static_cast<int>(j), entry.value());
  SparseMatrix made(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  made.setFromTriplets(entries.begin(), entries.end());
  return made;
}

Matrix solved(const numerics::OrderedFactor& factor, const Matrix& right) {
  Matrix solution(right.rows(), right.cols());
  Vector b, x;
  for (Index j = 0; j < right.cols(); ++j) {
    b = right.col(j);
    factor.solve(b, x);
    solution.col(j) = x;
  }
  return solution;
}

Matrix symmetric(const Matrix& matrix) { return 0.5 * (matrix + matrix.transpose()); }

}  // namespace

ComponentModes::ComponentModes(const SparseMatrix& stiffness, const SparseMatrix& mass, std::vector<Index> kept,
                               Matrix loads)
    : stiffness_(stiffness), mass_(mass), kept_(std::move(kept)) {
  std::vector<char> is_kept(static_cast<std::size_t>(stiffness.rows()), 0);
  for (const Index i : kept_) is_kept[static_cast<std::size_t>(i)] = 1;
  for (Index i = 0; i < stiffness.rows(); ++i)
    if (is_kept[static_cast<std::size_t>(i)] == 0) rest_.push_back(i);
  k_ii_ = part(stiffness, rest_, rest_);
  k_ib_ = part(stiffness, rest_, kept_);
  m_ii_ = part(mass, rest_, rest_);
  m_ib_ = part(mass, rest_, kept_);
  factor_.analyse(k_ii_);
  if (!factor_.factorise(k_ii_)) return;
  // A motion that costs nothing leaves a pivot of round-off.
  constexpr double least_pivot = 1e-12;
  const Vector pivots = factor_.pivots().cwiseQuotient(k_ii_.diagonal());
  if (!(pivots.minCoeff() > least_pivot)) return;
  is_held_ = true;
  static_shapes_ = -solved(factor_, Matrix(k_ib_));
  Matrix on_rest(rest(), loads.cols());
  for (Index i = 0; i < rest(); ++i) on_rest.row(i) = loads.row(rest_[static_cast<std::size_t>(i)]);
  load_shapes_ = solved(factor_, on_rest);
}

bool ComponentModes::find(ReductionMethod method, Index count) {
  method_ = method;
  const Index held = std::min(method == ReductionMethod::rubin ? 1 : count + 1, rest());
  const numerics::SymmetricModes modes = numerics::lowest_modes(k_ii_, m_ii_, held);
  if (!modes.has_converged || modes.shapes.cols() < held) return false;
  squares_ = modes.eigenvalues;
  found_ = modes.shapes;
  if (method != ReductionMethod::rubin) return true;
  // Coordinates on no element, which join only by springs, have no stiffness and no share in the rest.
  std::vector<Index> elastic;
  for (Index i = 0; i < stiffness_.rows(); ++i)
    if (stiffness_.coeff(i, i) != 0.0) elastic.push_back(i);
  const auto wanted = std::min<Index>(count, static_cast<Index>(elastic.size()));
  const numerics::SymmetricModes free =
      numerics::lowest_modes(part(stiffness_, elastic, elastic), part(mass_, elastic, elastic), wanted);
  if (!free.has_converged || free.shapes.cols() < wanted) return false;
  Matrix all = Matrix::Zero(stiffness_.rows(), wanted);
  for (std::size_t i = 0; i < elastic.size(); ++i) all.row(elastic[i]) = free.shapes.row(static_cast<Index>(i));
  Matrix at_interface(static_cast<Index>(kept_.size()), wanted);
  for (std::size_t i = 0; i < kept_.size(); ++i) at_interface.row(static_cast<Index>(i)) = all.row(kept_[i]);
  found_.resize(rest(), wanted);
  for (Index i = 0; i < rest(); ++i) found_.row(i) = all.row(rest_[static_cast<std::size_t>(i)]);
  found_ -= static_shapes_ * at_interface;
  return true;
}

void ComponentModes::take(Index count) {
  const bool is_rubin = method_ == ReductionMethod::rubin;
  const Index taken = std::min(count, found_.cols());
  shapes_ = found_.leftCols(taken);
  next_ = is_rubin ? squares_[0] : taken < squares_.size() ? squares_[taken] : 0.0;
  statics_ = 0;
  const Index modes = shapes_.cols();
  if (load_shapes_.cols() > 0) add_loads();
  if (is_rubin || shapes_.cols() > modes) make_orthonormal();
  statics_ = std::max<Index>(0, shapes_.cols() - modes);
}

void ComponentModes::add_loads() {
  const Index before = shapes_.cols();
  shapes_.conservativeResize(Eigen::NoChange, before + load_shapes_.cols());
  for (Index j = 0; j < load_shapes_.cols(); ++j) {
    const Vector shape = load_shapes_.col(j);
    shapes_.col(before + j) = shape / std::sqrt(std::max(shape.dot(m_ii_ * shape), std::numeric_limits<double>::min()));
  }
}

/// Shapes one after the other, without what those before them span; then their modes.
void ComponentModes::make_orthonormal() {
  Matrix kept(shapes_.rows(), shapes_.cols());
  Index count = 0;
  for (Index j = 0; j < shapes_.cols(); ++j) {
    Vector shape = shapes_.col(j);
    // Shapes had the mass 1: rigid motions, which the statics of the interface have, leave round-off of it. What is
    // left is judged by its stiffness: free modes lie near those statics, and have little mass beside them.
    const double norm = shape.dot(k_ii_ * shape);
    if (!(norm > 0.0) || !(shape.dot(m_ii_ * shape) > round_off)) continue;
    shape /= std::sqrt(norm);
    for (int pass = 0; pass < 2; ++pass)
      shape -= (kept.leftCols(count) * (kept.leftCols(count).transpose() * (k_ii_ * shape))).eval();
    const double left = shape.dot(k_ii_ * shape);
    if (!(left > same)) continue;
    kept.col(count++) = shape / std::sqrt(left);
  }
  kept.conservativeResize(Eigen::NoChange, count);
  shapes_ = kept;
  if (count == 0) return;
  const Matrix k = symmetric(kept.transpose() * (k_ii_ * kept)), m = symmetric(kept.transpose() * (m_ii_ * kept));
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> small(m, k);  // K is near the unit matrix: well conditioned
  for (Index j = 0; j < count; ++j)
    shapes_.col(j) = kept * small.eigenvectors().col(count - 1 - j) / std::sqrt(small.eigenvalues()[count - 1 - j]);
}

Matrix ComponentModes::reduced(const SparseMatrix& matrix) const {
  const auto b = static_cast<Index>(kept_.size());
  const Index n = shapes_.cols();
  const SparseMatrix a_bb = part(matrix, kept_, kept_), a_ib = part(matrix, rest_, kept_),
                     a_ii = part(matrix, rest_, rest_);
  Matrix basis(rest(), b + n);
  basis << static_shapes_, shapes_;
  Matrix all = basis.transpose() * (a_ii * basis);
  const Matrix cross = basis.transpose() * a_ib;
  all.leftCols(b) += cross;
  all.topRows(b) += cross.transpose();
  all.topLeftCorner(b, b) += Matrix(a_bb);
  if (&matrix == &stiffness_) {  // by K_ii Psi = -K_ib, exactly
    all.topRightCorner(b, n).setZero();
    all.bottomLeftCorner(n, b).setZero();
  }
  return symmetric(all);
}

std::vector<FrequencyEstimate> ComponentModes::estimates(const Matrix& stiffness, const Matrix& mass,
                                                         Index count) const {
  const auto b = static_cast<Index>(kept_.size());
  const SparseMatrix k = stiffness.sparseView(), m = mass.sparseView();
  const numerics::SymmetricModes modes = numerics::lowest_modes(k, m, std::min(count, mass.rows()));
  std::vector<FrequencyEstimate> all;
  Vector correction;
  for (Index j = 0; j < modes.shapes.cols(); ++j) {
    const double value = modes.eigenvalues[j];
    FrequencyEstimate estimate;
    estimate.frequency = std::sqrt(std::max(value, 0.0)) / (2.0 * std::numbers::pi);
    if (value > 0.0) {
      const Vector at = modes.shapes.col(j).head(b), eta = modes.shapes.col(j).tail(shapes_.cols());
      const Vector within = static_shapes_ * at + shapes_ * eta, modal = shapes_ * eta;
      const Vector residual = k_ii_ * modal - value * (m_ii_ * within + m_ib_ * at);
      factor_.solve(residual, correction);
      const double energy = std::max(0.0, residual.dot(correction));
      double limit = next_;
      if (method_ == ReductionMethod::rubin) {
        const double inertia = correction.dot(m_ii_ * correction);
        limit = inertia > 0.0 ? energy / inertia : 0.0;
      }
      const double beyond = limit > 0.0 ? 1.0 - value / limit : 1.0;
      // What is left of a residual of round-off has no direction that could tell its own frequency.
      constexpr double little = 1e-9;
      estimate.error = energy / (2.0 * value);
      if (estimate.error > little)
        estimate.error = beyond > 0.0 ? estimate.error / beyond : std::numeric_limits<double>::infinity();
    }
    all.push_back(estimate);
  }
  if (!modes.has_converged)
    for (FrequencyEstimate& estimate : all) estimate.error = std::numeric_limits<double>::infinity();
  return all;
}

}  // namespace rubato::model
