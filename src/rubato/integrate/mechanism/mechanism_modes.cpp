#include <rubato/integrate/mechanism/mechanism_modes.hpp>
#include <rubato/integrate/mechanism/motions_left.hpp>
#include <rubato/numerics/eigen_unsymmetric.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

constexpr double round_off = 1e-13;      // of the stiffness, over its size
constexpr Index most_unsymmetric = 400;  // seconds
constexpr double neutral = 100.0;        // of round-off: what the tolerance of an equilibrium leaves of omega^2 = 0

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
  const MotionsLeft left = motions_left(equations, state);
  const Matrix &tangent = left.stiffness, &mass = left.mass, &damping = left.damping;
  FreeMotions result;
  result.freedoms = left.freedoms();
  if (result.freedoms == 0) return result;
  result.skew = 0.5 * (tangent - tangent.transpose()).norm() / std::max(tangent.norm(), 1e-300);
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
    const SparseMatrix terms = symmetric(left.terms);
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
  for (auto& mode : result.found.modes) mode.shape = (left.basis * mode.shape).eval();
  return result;
}

}  // namespace rubato::integrate
