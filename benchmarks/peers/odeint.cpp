#include "damper_problem.hpp"

#include <boost/math/tools/roots.hpp>
#include <boost/numeric/odeint.hpp>

namespace rubato::benchmarks {
namespace {

/// The earliest transition in the last step of a dense-output stepper: the slider, and the time.
struct Transition {
  int slider = -1;
  double time = 0.0;
};

template <class Stepper>
Transition find_transition(const DamperProblem& problem, Stepper& stepper, double from, double to) {
  Transition first;
  OdeState y;
  const OdeState& end = stepper.current_state();
  for (int slider = 0; slider < 2; ++slider) {
    const double at_end = problem.distance(slider, end.data());
    if (!(at_end < 0.0)) continue;
    const auto distance = [&](double t) {
      stepper.calc_state(t, y);
      return problem.distance(slider, y.data());
    };
    // A slider that has just changed its state begins at the root of its last transition: past it, it must be positive.
    const double begin = from + 1e-9 * (to - from), at_begin = distance(begin);
    double time = begin;
    if (at_begin > 0.0) {
      std::uintmax_t most = 60;
      const auto bracket = boost::math::tools::toms748_solve(distance, begin, to, at_begin, at_end,
                                                             boost::math::tools::eps_tolerance<double>(50), most);
      time = bracket.second;
    }
    if (first.slider < 0 || time < first.time) first = {slider, time};
  }
  return first;
}

}  // namespace

Samples run_odeint(DamperProblem problem, int periods, double tolerance) {
  namespace odeint = boost::numeric::odeint;
  auto stepper = odeint::make_dense_output(tolerance, tolerance, odeint::runge_kutta_dopri5<OdeState>());
  const auto rate = [&problem](const OdeState& y, OdeState& dy, double t) { problem(y.data(), dy.data(), t); };
  const int count = periods * samples_a_period;
  const double interval = problem.period() / samples_a_period;
  Samples samples;
  samples.reserve(static_cast<std::size_t>(count));
  OdeState y{};
  stepper.initialize(y, 0.0, 0.01);
  while (static_cast<int>(samples.size()) < count) {
    const auto [from, to] = stepper.do_step(rate);
    const Transition transition = find_transition(problem, stepper, from, to);
    const double known = transition.slider < 0 ? to : transition.time;
    while (static_cast<int>(samples.size()) < count && interval * static_cast<double>(samples.size() + 1) <= known) {
      stepper.calc_state(interval * static_cast<double>(samples.size() + 1), y);
      samples.push_back({y[0], y[1], y[2], y[3], y[4]});
    }
    if (transition.slider < 0) continue;
    const double step = stepper.current_time_step();
    stepper.calc_state(transition.time, y);
    problem.change(transition.slider, y.data());
    stepper.initialize(y, transition.time, step);
  }
  return samples;
}

}  // namespace rubato::benchmarks
