#pragma once

#include <rubato/integrate/method.hpp>
#include <rubato/model/description.hpp>
#include <rubato/steady/linear/linear_response.hpp>
#include <rubato/steady/marching/time_marching.hpp>
#include <rubato/steady/steady_solver.hpp>

#include <functional>
#include <memory>
#include <string>

namespace rubato::steady {

/// Which solver of steady responses, and how it is asked to work.
struct SteadyRoute {
  using Kind = model::FrequencyResponseDescription::Route;

  Kind kind = Kind::periodic;
  double tolerance = 0.0;     ///< relative; 0: the route's own
  integrate::Method method;   ///< of time marching, as the two below
  long steps_per_period = 0;  ///< 0: chosen by the error
  long max_periods = 0;       ///< 0: the route's own
  int orders = 0;             ///< of harmonic balance; 0: chosen by the error
  LinearSweep linear = {};    ///< by which way large models find their linear responses
};

/// As the study file calls it.
std::string route_name(SteadyRoute::Kind kind);

/// The options of time marching.
TimeMarchingOptions marching_options(const SteadyRoute& route);

/// Makes solvers of steady responses for one structure after another.
struct SteadySolvers {
  using Make = std::function<std::unique_ptr<SteadySolver>(const system::LocallyNonlinear&, const SteadyRequest&)>;
  Make response;     ///< with friction
  Make free, stuck;  ///< the two linear limits
  Make coarse;       ///< with friction, to about a thousandth, at a small part of the cost
};

/// The solvers of a route. A system without sliders and other laws is linear: unless it is marched, its response is
/// that of the free limit.
SteadySolvers steady_solvers(const SteadyRoute& route);

}  // namespace rubato::steady
