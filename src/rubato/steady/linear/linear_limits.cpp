#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/steady/linear/linear_limits.hpp>

#include <Eigen/LU>
#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>

namespace rubato::steady {
namespace {

using SparseComplex = Eigen::SparseMatrix<std::complex<double>>;

constexpr Index largest_dense = 64;
constexpr Index largest_all_modes = 400, most_modes = 200;  // of natural frequencies

ComplexVector solve(const SparseMatrix& stiffness, const system::LocallyNonlinear& system, double angular_frequency,
                    const ComplexVector& load) {
  const std::complex<double> i_omega(0.0, angular_frequency), square(-angular_frequency * angular_frequency, 0.0);
  if (system.size() <= largest_dense) {
    const ComplexMatrix dynamic = Matrix(stiffness).cast<std::complex<double>>() +
                                  i_omega * Matrix(system.free_damping()) + square * Matrix(system.mass());
    return dynamic.partialPivLu().solve(load);
  }
  SparseComplex dynamic = stiffness.cast<std::complex<double>>();
  dynamic += i_omega * system.free_damping().cast<std::complex<double>>();
  dynamic += square * system.mass().cast<std::complex<double>>();
  const Eigen::SparseLU<SparseComplex> factor(dynamic);
  if (factor.info() != Eigen::Success) return ComplexVector::Constant(load.size(), std::nan(""));
  return factor.solve(load);
}

struct LinearResponse {
  Vector q, v;    // at phase zero
  Vector forces;  // largest |kT u| of each slider, from above
};

LinearResponse linear_response(const SparseMatrix& stiffness, const system::LocallyNonlinear& system,
                               const system::Excitation& excitation) {
  const Index n = system.size(), m = system.slider_count();
  LinearResponse response{Vector::Zero(n), Vector::Zero(n), Vector::Zero(m)};
  const auto add = [&](double angular_frequency, const ComplexVector& load) {
    if (load.cwiseAbs().maxCoeff() == 0.0) return;
    const ComplexVector q = solve(stiffness, system, angular_frequency, load);
    const Vector in_phase = q.real(), quadrature = q.imag();
    response.q += in_phase;
    response.v -= angular_frequency * quadrature;
    for (Index i = 0; i < m; ++i)
      response.forces[i] +=
          system.sliders()[static_cast<std::size_t>(i)].stiffness *
          std::hypot(system.relative_displacement(i, in_phase), system.relative_displacement(i, quadrature));
  };
  if (excitation.constant.size() > 0) add(0.0, excitation.constant.cast<std::complex<double>>());
  for (const system::LoadHarmonic& harmonic : excitation.harmonics)
    add(harmonic.order * excitation.angular_frequency, harmonic.amplitude);
  return response;
}

}  // namespace

system::LocallyNonlinear with_linear_laws(const system::LocallyNonlinear& system, bool stuck) {
  system::LocallyNonlinear::Parts alone;
  alone.mass = system.mass();
  alone.damping = system.damping();
  alone.stiffness = system.stiffness();
  alone.stops = system.stops();
  alone.laws = system.laws();
  alone.blocks = system.blocks();
  alone.start.q = system.start().q;
  alone.start.v = system.start().v;
  alone.coordinates = system.coordinates();
  const system::LocallyNonlinear laws(std::move(alone));

  system::LocallyNonlinear::Parts parts;
  parts.mass = system.mass();
  parts.damping = laws.free_damping();
  parts.stiffness = stuck ? laws.stuck_stiffness() : laws.free_stiffness();
  parts.sliders = system.sliders();
  parts.stops = system.stops();
  parts.loads = system.loads();
  parts.start.q = system.start().q;
  parts.start.v = system.start().v;
  parts.coordinates = system.coordinates();
  parts.reference = system.reference();
  return system::LocallyNonlinear(std::move(parts));
}

system::State nearer_linear_limit(const system::LocallyNonlinear& system, const system::Excitation& excitation) {
  const Index m = system.slider_count();
  system::State state = system.start();
  state.t = 0.0;
  state.q.setZero();
  state.v.setZero();
  state.slider_force.setZero();
  state.memory.setZero();
  if (system.has_normals()) system.set_stop_forces(state);
  system.set_law_forces(state, model::Side::right);
  const system::State at_rest = state;
  LinearResponse response = linear_response(system.stuck_stiffness(), system, excitation);
  if (!response.q.allFinite() || !(response.forces.array() <= 2.0 * excitation.limits.array()).all())
    response = linear_response(system.free_stiffness(), system, excitation);
  if (!response.q.allFinite() || !response.v.allFinite()) return state;
  state.q = response.q;
  state.v = response.v;
  for (Index i = 0; i < m; ++i)
    state.slider_force[i] =
        std::clamp(system.sliders()[static_cast<std::size_t>(i)].stiffness * system.relative_displacement(i, state.q),
                   -excitation.limits[i], excitation.limits[i]);
  if (system.has_normals()) system.set_stop_forces(state);
  system.move_laws(at_rest, state);
  return state;
}

Vector natural_frequencies(const system::LocallyNonlinear& system, double highest) {
  const auto squares = [&](const SparseMatrix& stiffness) -> Vector {
    if (system.size() <= largest_all_modes) return numerics::all_modes(stiffness, system.mass()).eigenvalues;
    const auto below = numerics::modes_below(stiffness, system.mass(), highest * highest);
    if (!below || *below == 0 || *below > most_modes) return {};
    return numerics::lowest_modes(stiffness, system.mass(), *below).eigenvalues;
  };
  const bool has_laws = system.has_laws();
  const Vector free = squares(has_laws ? with_linear_laws(system, false).stiffness() : system.stiffness());
  if (!has_laws && !system.has_friction()) return free.cwiseMax(0.0).cwiseSqrt();
  const Vector stuck = squares(has_laws ? with_linear_laws(system, true).stuck_stiffness() : system.stuck_stiffness());
  Vector both(free.size() + stuck.size());
  both << free, stuck;
  return both.cwiseMax(0.0).cwiseSqrt();
}

}  // namespace rubato::steady
