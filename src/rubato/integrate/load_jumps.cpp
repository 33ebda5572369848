#include <rubato/integrate/load_jumps.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {

std::vector<double> jumps_of(const system::Loads& loads, double from, double to) {
  constexpr double round_off = 1e-9;
  std::vector<double> times = loads.breakpoints(from, to);
  std::vector<char> has_jump(times.size(), 0);
  std::vector<double> change(times.size());
  for (const system::LoadTerm& term : loads.terms()) {
    if (std::holds_alternative<model::HarmonicLaw>(term.law)) continue;
    double size = 0.0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double left = model::value(term.law, times[i], model::Side::left);
      const double right = model::value(term.law, times[i], model::Side::right);
      change[i] = std::abs(right - left);
      if (std::isfinite(left) && std::isfinite(right)) size = std::max({size, std::abs(left), std::abs(right)});
    }
    for (std::size_t i = 0; i < times.size(); ++i)
      if (change[i] > round_off * size) has_jump[i] = 1;
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < times.size(); ++i)
    if (has_jump[i]) times[count++] = times[i];
  times.resize(count);
  return times;
}

LoadJumps::LoadJumps(const system::LocallyNonlinear& system, double from, double to)
    : times_(jumps_of(system.loads(), from, to)),
      system_(system),
      equilibrium_(system),
      left_(system.size()),
      right_(system.size()) {
  system.add_law_breakpoints(from, to, times_);
}

double LoadJumps::end_of_step(double t1, double round_off) const {
  double end = t1;
  for (std::size_t i = next_; i < times_.size() && times_[i] <= t1 + round_off; ++i)
    if (times_[i] >= t1 - round_off) end = times_[i];
  return end;
}

void LoadJumps::pass(system::State& state, double since) {
  for (; next() < since; ++next_)
    if (missed_++ == 0) first_missed_ = next();
  if (!(next() <= state.t)) return;
  const double now = state.t;
  state.t = next();  // switches of two formulas may be apart by round-off
  equilibrium_(state, left_, model::Side::left);
  state.t = now;
  system_.set_law_forces(state, model::Side::right);
  equilibrium_(state, right_, model::Side::right);
  state.auxiliary_acceleration += right_ - left_;
  while (next() <= now) ++next_;
}

}  // namespace rubato::integrate
