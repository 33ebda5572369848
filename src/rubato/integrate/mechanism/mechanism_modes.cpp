#include <rubato/integrate/mechanism/mechanism_modes.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

/// An orthonormal basis of the motions that the constraints leave [n x freedoms].
Matrix motions_left(const SparseMatrix& jacobian) {
  const Index n = jacobian.cols();
  if (jacobian.rows() == 0) return Matrix::Identity(n, n);
  Matrix rows = jacobian;
  for (Index i = 0; i < rows.rows(); ++i)  // a length beside an angle must not look like nothing
    if (const double size = rows.row(i).norm(); size > 0.0) rows.row(i) /= size;
  Eigen::ColPivHouseholderQR<Matrix> decomposition(rows.transpose());
  decomposition.setThreshold(1e-9);
  const Matrix all = decomposition.householderQ() * Matrix::Identity(n, n);
  return all.rightCols(n - decomposition.rank());
}

Matrix reduced(const SparseMatrix& matrix, const Matrix& basis) { return basis.transpose() * (matrix * basis); }

SparseMatrix symmetric(const Matrix& matrix) {
  return SparseMatrix((0.5 * (matrix + matrix.transpose())).sparseView(0.0, 0.0));
}

}  // namespace

MechanismModes modes_about(system::MechanismEquations& equations, const system::State& state, Index count) {
  const auto& mechanism = equations.mechanism();
  equations.go_to(state, model::Side::right);
  const auto linear = equations.linearised(state.multiplier);
  const Matrix basis = motions_left(linear.jacobian);
  MechanismModes result;
  result.freedoms = basis.cols();
  if (result.freedoms == 0) return result;
  const Matrix tangent = reduced(linear.stiffness, basis);
  result.skew = 0.5 * (tangent - tangent.transpose()).norm() / std::max(tangent.norm(), 1e-300);
  const SparseMatrix mass = symmetric(reduced(mechanism.mass(), basis)), stiffness = symmetric(tangent);
  // Generalised, so that the signs are those of omega^2; round-off of K makes no motion unstable.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> signs(Matrix(stiffness), Matrix(mass), Eigen::EigenvaluesOnly);
  const Vector squares = signs.eigenvalues();
  result.is_stable = squares[0] >= -1e-10 * squares.cwiseAbs().maxCoeff();
  if (!result.is_stable) {
    result.growth = std::sqrt(-squares[0]);
    return result;
  }
  result.found = numerics::lowest_damped_modes(stiffness, symmetric(reduced(linear.damping, basis)), mass,
                                               std::min(count, result.freedoms));
  for (auto& mode : result.found.modes) mode.shape = (basis * mode.shape).eval();
  return result;
}

}  // namespace rubato::integrate
