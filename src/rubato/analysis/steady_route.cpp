#include <rubato/analysis/steady_route.hpp>
#include <rubato/core/error.hpp>
#include <rubato/integrate/steady/linear_response.hpp>
#include <rubato/integrate/steady/periodic_solver.hpp>

namespace rubato::analysis {
namespace {

using integrate::SteadyRequest;
using system::LocallyNonlinear;

std::unique_ptr<integrate::SteadySolver> linear(const LocallyNonlinear& system, const SteadyRequest& request,
                                                bool stuck) {
  return std::make_unique<integrate::LinearResponse>(
      system, integrate::StuckSliders(static_cast<std::size_t>(system.slider_count()), stuck), request);
}

}  // namespace

SteadySolvers steady_solvers(const SteadyRoute& route) {
  SteadySolvers solvers;
  solvers.free = [](const LocallyNonlinear& system, const SteadyRequest& request) {
    return linear(system, request, false);
  };
  solvers.stuck = [](const LocallyNonlinear& system, const SteadyRequest& request) {
    return linear(system, request, true);
  };
  solvers.response = [route](const LocallyNonlinear& system,
                             const SteadyRequest& request) -> std::unique_ptr<integrate::SteadySolver> {
    if (system.slider_count() == 0) return linear(system, request, false);
    if (route.kind == SteadyRoute::Kind::periodic) {
      integrate::PeriodicOptions options;
      if (route.tolerance > 0.0) options.tolerance = route.tolerance;
      return std::make_unique<integrate::PeriodicSolver>(system, request, options);
    }
    throw InvalidInput("this solver is not available in this version; take solver = \"periodic\"");
  };
  return solvers;
}

}  // namespace rubato::analysis
