#include <rubato/steady/steady_solver.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace rubato::steady {

void SteadySolver::solve_lanes(std::span<const system::Excitation> excitations, SteadyStart start,
                               std::span<SteadyResponse> responses) {
  assert(excitations.size() == 1 && responses.size() == 1);
  solve(excitations[0], start, responses[0]);
}

void SteadyDiscretisation::include(const SteadyDiscretisation& other) {
  order = std::max(order, other.order);
  samples = std::max(samples, other.samples);
  firmness = std::min(firmness, other.firmness);  // what all points can be balanced with
}

bool are_slider_forces_resolved(const system::LocallyNonlinear& system, const system::Excitation& excitation,
                                const Vector& displacements) {
  constexpr double least_resolution = 1e-8;  // of a limit
  const double w = excitation.angular_frequency;
  for (Index j = 0; j < system.slider_count(); ++j) {
    const auto& slider = system.sliders()[static_cast<std::size_t>(j)];
    double stiffness = 0.0;
    for (const Index end : {slider.first, slider.second})
      if (end != ground) stiffness += system.stiffness().coeff(end, end) + w * w * system.mass().coeff(end, end);
    const double round_off = std::numeric_limits<double>::epsilon() * stiffness * std::abs(displacements[j]);
    const double limit = excitation.limits[j];
    if (limit > 0.0 && !(round_off <= least_resolution * limit)) return false;
  }
  return true;
}

}  // namespace rubato::steady
