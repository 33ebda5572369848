#pragma once

#include "damper_problem.hpp"

#include <boost/math/tools/roots.hpp>
#include <boost/numeric/odeint.hpp>

#include <algorithm>
#include <array>
#include <cmath>

// Steady responses as somebody would get them from a general integrator: march until the state one period apart no
// longer changes, then take half peak to peak of the last period. Each point starts where the one before ended.
namespace rubato::benchmarks {

/// m = k = kT = f0 = 1 and a slider to the ground, with the interface of DamperProblem.
class SingleMassProblem {
 public:
  static constexpr int coordinates = 1, sliders = 1;
  explicit SingleMassProblem(const system::LocallyNonlinear& system)
      : omega_(std::get<model::HarmonicLaw>(system.loads().terms()[0].law).angular_frequency),
        damping_(system.damping().coeff(0, 0)),
        limit_(system.sliders()[0].limit) {}
  void operator()(const double* y, double* rate, double t) const {
    rate[0] = y[1];
    rate[1] = std::cos(omega_ * t) - y[0] - damping_ * y[1] - force(y);
  }
  double distance(int, const double* y) const {
    if (side_ != 0) return side_ * y[1];
    return limit_ * limit_ - force(y) * force(y);
  }
  void change(int, const double* y) {
    if (side_ == 0) {
      side_ = force(y) > 0.0 ? 1 : -1;
      return;
    }
    offset_ = side_ * limit_ - y[0];
    side_ = 0;
  }
  double period() const { return 2.0 * std::acos(-1.0) / omega_; }
  void drive(double angular_frequency) { omega_ = angular_frequency; }

 private:
  double force(const double* y) const { return side_ != 0 ? side_ * limit_ : offset_ + y[0]; }
  double omega_, damping_, limit_;
  int side_ = 0;
  double offset_ = 0.0;
};

struct MarchEnd {
  double tolerance = 1e-5;  ///< of the integrator
  double change = 5e-5;     ///< of the state (q, v / omega) over a period, relative, that counts as none
  int most_periods = 1000;
};

/// Half peak to peak of a period, from the turning points that the integrator passes; and whether the march may end.
template <int n>
class PeriodWatch {
 public:
  using State = std::array<double, 2 * n>;
  PeriodWatch(const State& start, double period, const MarchEnd& end, int observed)
      : last_(start), rate_(period / (2.0 * std::acos(-1.0))), end_(end), observed_(observed) {}

  int observed() const { return observed_; }
  void turn(double value) {
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  /// At the end of a period. True: the march is over.
  bool closes(const State& now) {
    double moved = 0.0, size = 0.0;
    for (int i = 0; i < 2 * n; ++i) {
      const double unit = i < n ? 1.0 : rate_;
      moved += std::pow(unit * (now[i] - last_[i]), 2);
      size += std::pow(unit * now[i], 2);
    }
    last_ = now;
    // A turning point at the very end may fall into the next period by round-off.
    turn(now[observed_]);
    amplitude_ = 0.5 * (high_ - low_);
    low_ = high_ = now[observed_];
    return std::sqrt(moved) <= end_.change * std::sqrt(size) || ++periods_ >= end_.most_periods;
  }
  double amplitude() const { return amplitude_; }

 private:
  State last_;
  double rate_;
  MarchEnd end_;
  int observed_, periods_ = 0;
  double low_ = 1e300, high_ = -1e300, amplitude_ = 0.0;
};

/// Dormand-Prince 5 with dense output, transitions located by TOMS 748. `y`: at phase zero, before and after.
template <class Problem>
double steady_odeint(Problem& problem, std::array<double, 2 * Problem::coordinates>& y, int observed,
                     const MarchEnd& end) {
  namespace odeint = boost::numeric::odeint;
  constexpr int n = Problem::coordinates;
  using State = std::array<double, 2 * n>;
  auto stepper = odeint::make_dense_output(end.tolerance, end.tolerance, odeint::runge_kutta_dopri5<State>());
  const auto rate = [&problem](const State& x, State& dx, double t) { problem(x.data(), dx.data(), t); };
  PeriodWatch<n> watch(y, problem.period(), end, observed);
  const double period = problem.period();
  double next = period;
  State at{};
  stepper.initialize(y, 0.0, 0.02 * period);
  for (;;) {
    const auto [from, to] = stepper.do_step(rate);
    int slider = -1;
    double known = to;
    const auto root = [&](auto&& function, double begin, double finish, double a, double b) {
      std::uintmax_t most = 40;
      return boost::math::tools::toms748_solve(function, begin, finish, a, b,
                                               boost::math::tools::eps_tolerance<double>(40), most)
          .second;
    };
    for (int i = 0; i < Problem::sliders; ++i) {
      const double at_end = problem.distance(i, stepper.current_state().data());
      if (!(at_end < 0.0)) continue;
      const auto distance = [&](double t) {
        stepper.calc_state(t, at);
        return problem.distance(i, at.data());
      };
      const double begin = from + 1e-9 * (to - from), at_begin = distance(begin);
      const double time = at_begin > 0.0 ? root(distance, begin, to, at_begin, at_end) : begin;
      if (slider < 0 || time < known) {
        slider = i;
        known = time;
      }
    }
    const auto speed = [&](double t) {
      stepper.calc_state(t, at);
      return at[n + observed];
    };
    const double before = speed(from), after = speed(known);
    if ((before > 0.0) != (after > 0.0)) {
      if (before != 0.0 && after != 0.0) speed(root(speed, from, known, before, after));
      watch.turn(at[observed]);
    }
    if (next <= known) {
      stepper.calc_state(next, y);
      if (watch.closes(y)) return watch.amplitude();
      next += period;
    }
    if (slider < 0) continue;
    const double step = stepper.current_time_step();
    stepper.calc_state(known, at);
    problem.change(slider, at.data());
    const State start = at;
    stepper.initialize(start, known, step);
  }
}

/// CVODE, Adams with fixed-point iteration and its own root finding.
double steady_cvode(SingleMassProblem& problem, std::array<double, 2>& y, int observed, const MarchEnd& end);
double steady_cvode(DamperProblem& problem, std::array<double, 10>& y, int observed, const MarchEnd& end);

}  // namespace rubato::benchmarks
