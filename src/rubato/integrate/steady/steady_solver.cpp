#include <rubato/integrate/steady/steady_solver.hpp>

#include <cassert>

namespace rubato::integrate {

void SteadySolver::solve_lanes(std::span<const Excitation> excitations, SteadyStart start,
                               std::span<SteadyResponse> responses) {
  assert(excitations.size() == 1 && responses.size() == 1);
  solve(excitations[0], start, responses[0]);
}

}  // namespace rubato::integrate
