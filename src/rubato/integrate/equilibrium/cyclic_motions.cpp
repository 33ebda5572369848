#include <rubato/core/stopping_aside.hpp>
#include <rubato/integrate/equilibrium/cyclic_motions.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <cmath>
#include <complex>
#include <utility>

namespace rubato::integrate {
namespace {

using Complex = std::complex<double>;

constexpr double equal = 1e-7;        // relative distance of eigenvalues that count as one
constexpr double independent = 1e-6;  // share of a shape's mass that those before it do not span

/// y of a mode of doubled size (u; v): u + i v.
void halve(numerics::DampedMode& mode) {
  const Index m = mode.shape.size() / 2;
  const Eigen::VectorXcd y = mode.shape.head(m) + Complex(0.0, 1.0) * mode.shape.tail(m);
  mode.shape = y;
}

Complex product(const Eigen::VectorXcd& a, const SparseMatrix& mass, const Eigen::VectorXcd& b) {
  const Eigen::VectorXcd image = mass * b;
  return a.dot(image);
}

/// Unit mass; the entry of the largest modulus is real and positive.
void normalise(const SparseMatrix& mass, Eigen::VectorXcd& x) {
  Index largest = 0;
  x.cwiseAbs().maxCoeff(&largest);
  x *= std::conj(x[largest]) / std::abs(x[largest]) / std::sqrt(product(x, mass, x).real());
  x[largest] = std::abs(x[largest]);
}

}  // namespace

numerics::DampedModes modes_of_diameter(const model::CyclicSector& sector, Index diameter,
                                        const SparseMatrix& stiffness, const SparseMatrix& damping,
                                        const SparseMatrix& mass, Index count) {
  const SparseMatrix k = sector.reduced(stiffness, diameter), c = sector.reduced(damping, diameter),
                     m = sector.reduced(mass, diameter);
  const bool is_real = sector.is_real(diameter);
  numerics::DampedModes found =
      stoppable_aside([=] { return numerics::lowest_damped_modes(k, c, m, is_real ? count : 2 * count); });
  if (is_real) {
    for (auto& mode : found.modes) {
      mode.shape = sector.expanded(mode.shape, diameter);
      normalise(mass, mode.shape);
    }
    return found;
  }
  std::vector<numerics::DampedMode> kept;
  for (numerics::DampedMode& mode : found.modes) {
    halve(mode);
    mode.shape = sector.expanded(mode.shape, diameter);
    const double before = product(mode.shape, mass, mode.shape).real();
    if (!(before > independent)) continue;  // the partner, of the conjugate matrices
    for (const auto& other : kept)
      if (std::abs(other.eigenvalue - mode.eigenvalue) <= equal * std::abs(mode.eigenvalue))
        mode.shape -= product(other.shape, mass, mode.shape) * other.shape;
    if (!(product(mode.shape, mass, mode.shape).real() > independent * before)) continue;
    normalise(mass, mode.shape);
    mode.is_complex = true;
    kept.push_back(std::move(mode));
  }
  if (2 * kept.size() != found.modes.size()) found.has_converged = false;
  found.missing = found.missing > 0 ? (found.missing + 1) / 2 : found.missing;
  found.modes = std::move(kept);
  return found;
}

FreeMotions cyclic_motions(const SystemKind& sector_kind, const model::CyclicSector& sector,
                           const CyclicMotions& wanted) {
  const system::LocallyNonlinear& system = *sector_kind.structure();
  const bool is_free = wanted.limit == 0;
  FreeMotions motions;
  motions.freedoms = sector.size();
  motions.found =
      modes_of_diameter(sector, wanted.diameter, is_free ? system.free_stiffness() : system.stuck_stiffness(),
                        is_free ? system.free_damping() : system.stuck_damping(), system.mass(), wanted.count);
  return motions;
}

}  // namespace rubato::integrate
