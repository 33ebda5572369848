#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/load_jumps.hpp>

#include <cmath>
#include <utility>

namespace rubato::integrate {

namespace {
constexpr double same_time = 1e-9;  // of a step
}

StepCount count_steps(double length, double step) {
  const double ratio = length / step;
  const double full = std::floor(ratio + 1e-9 * std::fmax(1.0, ratio * 1e-3));
  const double rest = length - full * step;
  return {static_cast<long>(full), rest > 1e-9 * step * std::fmax(1.0, ratio * 1e-3) ? rest : 0.0};
}

MarchReport march(Stepper& stepper, system::State& state, double step, double end, Observer* observer,
                  LoadJumps* jumps) {
  const double start = state.t;
  const StepCount count = count_steps(end - start, step);
  MarchReport report;
  system::State other = state;
  system::State* from = &state;
  system::State* to = &other;
  const double round_off = same_time * step;
  const long total = count.full + (count.rest > 0.0 ? 1 : 0);
  for (long i = 0; i < total; ++i) {
    double h = step, t1 = start + static_cast<double>(i + 1) * step;
    if (i + 1 == total)
      t1 = end;
    else if (jumps)
      t1 = jumps->end_of_step(t1, round_off);
    if (i == count.full) {
      h = count.rest;
      stepper.step_changes(*from, h / step);
    }
    report.step = stepper.attempt(*from, h, t1, *to);
    if (report.step.outcome != StepOutcome::accepted) {
      report.end = MarchEnd::failed;
      report.failed_at = from->t;
      report.failed_step = h;
      break;
    }
    ++report.steps;
    const bool goes_on = !observer || observer->accepted(*from, *to);
    std::swap(from, to);
    if (jumps) jumps->pass(*from, from->t - round_off);
    if (!goes_on) {
      report.end = MarchEnd::stopped;
      break;
    }
  }
  if (from != &state) std::swap(state, other);
  return report;
}

}  // namespace rubato::integrate
