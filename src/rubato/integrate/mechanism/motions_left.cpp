#include <rubato/integrate/mechanism/motions_left.hpp>

#include <Eigen/QR>

#include <cmath>
#include <limits>

namespace rubato::integrate {
namespace {

constexpr double reduction_error = 8.0;  // of products with N, in units of that of the entries of K

/// A basis of the motions that the constraints leave, orthonormal by the diagonal of M: lengths and angles are then of
/// one kind, whatever the units of the model [n x freedoms].
Matrix basis_of_motions(const SparseMatrix& jacobian, const Vector& inertia) {
  const Index n = jacobian.cols();
  const Vector unit = inertia.cwiseSqrt().cwiseInverse();
  if (jacobian.rows() == 0) return unit.asDiagonal();
  Matrix rows = jacobian * unit.asDiagonal();
  for (Index i = 0; i < rows.rows(); ++i)  // a length beside an angle must not look like nothing
    if (const double size = rows.row(i).norm(); size > 0.0) rows.row(i) /= size;
  Eigen::ColPivHouseholderQR<Matrix> decomposition(rows.transpose());
  decomposition.setThreshold(1e-9);
  const Matrix all = decomposition.householderQ() * Matrix::Identity(n, n);
  return unit.asDiagonal() * all.rightCols(n - decomposition.rank());
}

Matrix reduced(const SparseMatrix& matrix, const Matrix& basis) { return basis.transpose() * (matrix * basis); }

/// What round-off of the multipliers leaves of N^T K N, entry by entry: each is off by a share of the largest, compared
/// by the accelerations that they make. A part that nothing presses has no stiffness but this.
/// @param linear  at the state, with its multipliers
Matrix noise_of_multipliers(system::MechanismEquations& equations, const Vector& multiplier,
                            const system::MechanismEquations::Linearised& linear, const Matrix& basis,
                            const Vector& inertia) {
  constexpr double share = 16.0 * std::numeric_limits<double>::epsilon();
  const SparseMatrix rows = linear.jacobian * inertia.cwiseSqrt().cwiseInverse().asDiagonal();
  Vector seen = Vector::Zero(rows.rows());
  for (Index i = 0; i < rows.outerSize(); ++i)
    for (SparseMatrix::InnerIterator entry(rows, i); entry; ++entry) seen[entry.row()] += entry.value() * entry.value();
  seen = seen.cwiseSqrt();
  const double largest = seen.size() > 0 ? seen.cwiseProduct(multiplier).cwiseAbs().maxCoeff() : 0.0;
  if (!(largest > 0.0)) return Matrix::Zero(basis.cols(), basis.cols());
  Vector off = Vector::Zero(multiplier.size());
  for (Index r = 0; r < off.size(); ++r)
    if (seen[r] > 0.0) off[r] = largest / seen[r];
  const SparseMatrix change = equations.linearised(multiplier + off).stiffness - linear.stiffness;
  return share * reduced(change.cwiseAbs(), basis.cwiseAbs());
}

}  // namespace

MotionsLeft motions_left(system::MechanismEquations& equations, const system::State& state) {
  const auto& mechanism = equations.mechanism();
  equations.go_to(state, model::Side::right);
  const auto linear = equations.linearised(state.multiplier);
  const Vector inertia = mechanism.mass().diagonal();
  MotionsLeft left;
  left.basis = basis_of_motions(linear.jacobian, inertia);
  if (left.freedoms() == 0) return left;
  left.noise = noise_of_multipliers(equations, state.multiplier, linear, left.basis, inertia);
  left.stiffness = reduced(linear.stiffness, left.basis);
  for (Index i = 0; i < left.stiffness.size(); ++i)
    if (std::abs(left.stiffness.data()[i]) <= left.noise.data()[i]) left.stiffness.data()[i] = 0.0;
  left.mass = reduced(mechanism.mass(), left.basis);
  left.damping = reduced(linear.damping, left.basis);
  // More than the entries are, where what is stiff is held.
  left.terms = reduction_error * reduced(linear.stiffness.cwiseAbs(), left.basis.cwiseAbs());
  return left;
}

}  // namespace rubato::integrate
