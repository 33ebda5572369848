#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/linear/linear_response.hpp>
#include <rubato/steady/periodic/periodic_solver.hpp>
#include <rubato/steady/steady_route.hpp>

namespace rubato::steady {
namespace {

using system::LocallyNonlinear;

bool is_linear(const LocallyNonlinear& system) { return system.contact_count() == 0; }

std::unique_ptr<SteadySolver> linear(const SteadyRoute& route, const LocallyNonlinear& system,
                                     const SteadyRequest& request, bool stuck) {
  return std::make_unique<LinearResponse>(limit(system, stuck, request, route.linear));
}

std::unique_ptr<SteadySolver> periodic(const SteadyRoute& route, const LocallyNonlinear& system,
                                       const SteadyRequest& request) {
  PeriodicOptions options;
  if (route.tolerance > 0.0) options.tolerance = route.tolerance;
  return std::make_unique<PeriodicSolver>(system, request, options);
}

std::unique_ptr<SteadySolver> harmonic_balance(const SteadyRoute& route, const LocallyNonlinear& system,
                                               const SteadyRequest& request) {
  HarmonicBalanceOptions options;
  options.sweep = route.linear;
  options.orders = route.orders;
  if (route.tolerance > 0.0) options.tolerance = route.tolerance;
  return std::make_unique<HarmonicBalanceSolver>(system, request, options);
}

std::unique_ptr<SteadySolver> time_marching(const SteadyRoute& route, const LocallyNonlinear& system,
                                            const SteadyRequest& request) {
  return std::make_unique<TimeMarchingSolver>(system, marching_options(route), request);
}

}  // namespace

TimeMarchingOptions marching_options(const SteadyRoute& route) {
  TimeMarchingOptions options;
  options.method = route.method;
  if (route.tolerance > 0.0) options.tolerance = route.tolerance;
  if (route.steps_per_period > 0) options.steps_per_period = static_cast<int>(route.steps_per_period);
  if (route.max_periods > 0) options.max_periods = static_cast<int>(route.max_periods);
  return options;
}

std::string route_name(SteadyRoute::Kind kind) {
  if (kind == SteadyRoute::Kind::harmonic_balance) return "harmonic_balance";
  return kind == SteadyRoute::Kind::time_marching ? "time_marching" : "periodic";
}

SteadySolvers steady_solvers(const SteadyRoute& route) {
  SteadySolvers solvers;
  solvers.free = [route](const LocallyNonlinear& system, const SteadyRequest& request) {
    return linear(route, system, request, false);
  };
  solvers.stuck = [route](const LocallyNonlinear& system, const SteadyRequest& request) {
    return linear(route, system, request, true);
  };
  solvers.coarse = [route](const LocallyNonlinear& system, const SteadyRequest& request) {
    SteadyRoute coarse;
    coarse.linear = route.linear;
    return is_linear(system) ? linear(route, system, request, false) : harmonic_balance(coarse, system, request);
  };
  solvers.response = [route](const LocallyNonlinear& system,
                             const SteadyRequest& request) -> std::unique_ptr<SteadySolver> {
    if (route.kind == SteadyRoute::Kind::time_marching) return time_marching(route, system, request);
    if (is_linear(system)) return linear(route, system, request, false);
    return route.kind == SteadyRoute::Kind::periodic ? periodic(route, system, request)
                                                     : harmonic_balance(route, system, request);
  };
  return solvers;
}

}  // namespace rubato::steady
