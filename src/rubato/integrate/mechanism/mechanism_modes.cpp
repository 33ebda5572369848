#include <rubato/integrate/mechanism/mechanism_modes.hpp>
#include <rubato/numerics/eigen_unsymmetric.hpp>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::integrate {
namespace {

constexpr double round_off = 1e-13;      // of the stiffness, over its size
constexpr Index most_unsymmetric = 400;  // seconds
constexpr double neutral = 100.0;        // of round-off: what the tolerance of an equilibrium leaves of omega^2 = 0
constexpr double reduction_error = 8.0;  // of products with N, in units of that of the entries of K

/// A basis of the motions that the constraints leave, orthonormal by the diagonal of M: lengths and angles are then of
/// one kind, whatever the units of the model [n x freedoms].
Matrix motions_left(const SparseMatrix& jacobian, const Vector& inertia) {
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

SparseMatrix symmetric(const Matrix& matrix) {
  return SparseMatrix((0.5 * (matrix + matrix.transpose())).sparseView(0.0, 0.0));
}

/// The lowest, and up to the last that grows.
void keep_lowest(Index count, std::vector<numerics::DampedMode>& modes) {
  auto kept = std::min(static_cast<std::size_t>(count), modes.size());
  for (std::size_t i = kept; i < modes.size(); ++i)
    if (modes[i].damping_ratio < -1e-9) kept = i + 1;
  modes.resize(kept);
}

}  // namespace

FreeMotions modes_about(system::MechanismEquations& equations, const system::State& state, Index count) {
  const auto& mechanism = equations.mechanism();
  equations.go_to(state, model::Side::right);
  const auto linear = equations.linearised(state.multiplier);
  const Vector inertia = mechanism.mass().diagonal();
  const Matrix basis = motions_left(linear.jacobian, inertia);
  FreeMotions result;
  result.freedoms = basis.cols();
  if (result.freedoms == 0) return result;
  const Matrix noise = noise_of_multipliers(equations, state.multiplier, linear, basis, inertia);
  Matrix tangent = reduced(linear.stiffness, basis);
  for (Index i = 0; i < tangent.size(); ++i)
    if (std::abs(tangent.data()[i]) <= noise.data()[i]) tangent.data()[i] = 0.0;
  result.skew = 0.5 * (tangent - tangent.transpose()).norm() / std::max(tangent.norm(), 1e-300);
  const Matrix mass = reduced(mechanism.mass(), basis), damping = reduced(linear.damping, basis);
  if (result.skew > round_off && result.freedoms <= most_unsymmetric) {
    result.found = numerics::lowest_unsymmetric_modes(tangent, damping, mass, result.freedoms);
    const auto& modes = result.found.modes;
    // A motion that nothing resists comes out with the root of round-off where there is damping.
    const double fastest = modes.empty() ? 0.0 : modes.back().angular_frequency;
    const double nothing = damping.isZero(0.0) ? 0.0 : std::sqrt(round_off) * fastest;
    for (const auto& mode : modes) {
      const double growth = mode.eigenvalue.real();
      if (!(growth > std::max(1e-9 * mode.angular_frequency, nothing)) || growth <= result.growth) continue;
      result.growth = growth;
      result.flutters = mode.eigenvalue.imag() > 0.0;
    }
    result.is_stable = result.growth == 0.0;
  } else {
    const SparseMatrix even_mass = symmetric(mass), stiffness = symmetric(tangent);
    // What the entries of N^T K N are sums of: more than they are, where what is stiff is held.
    const Matrix moduli = basis.cwiseAbs();
    const SparseMatrix terms = symmetric(reduction_error * reduced(linear.stiffness.cwiseAbs(), moduli));
    // Round-off of K, which all_modes takes for nothing, makes no motion unstable.
    const numerics::SymmetricModes undamped = numerics::all_modes(stiffness, even_mass, &terms);
    const double lowest = undamped.eigenvalues.size() > 0 ? undamped.eigenvalues[0] : 0.0;
    result.leaves_out_skew = result.skew > round_off;
    result.is_stable = undamped.eigenvalues.size() == 0 || lowest >= -neutral * undamped.round_off[0];
    if (!result.is_stable) result.growth = std::sqrt(-lowest);
    if (result.is_stable)
      result.found = numerics::lowest_damped_modes(stiffness, symmetric(damping), even_mass,
                                                   std::min(count, result.freedoms), &terms);
    else if (result.freedoms <= most_unsymmetric)  // the only route that knows modes which grow
      result.found =
          numerics::lowest_unsymmetric_modes(0.5 * (tangent + tangent.transpose()), damping, mass, 2 * result.freedoms);
  }
  keep_lowest(count, result.found.modes);
  for (auto& mode : result.found.modes) mode.shape = (basis * mode.shape).eval();
  return result;
}

}  // namespace rubato::integrate
