#include <rubato/integrate/kinds/start_on_locks.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rubato::integrate {
namespace {

constexpr double nothing = 1e-9;  // of the terms of a sum that may cancel

/// How a coordinate moves toward its lock, with what round-off may leave of that.
struct Approach {
  double rate = 0.0, unknown_rate = 0.0;           // [rad/s] or [m/s]
  double second_rate = 0.0, unknown_second = 0.0;  // [rad/s2] or [m/s2]

  bool stands() const { return std::abs(rate) <= unknown_rate; }
  bool meets() const { return rate > unknown_rate; }
  bool pushes = false;  // elastic, and pressed already

  bool presses() const { return stands() && second_rate > unknown_second; }
};

Approach approach_of(system::MechanismEquations& equations, const system::State& state, const model::Lock& lock) {
  const system::Mechanism& mechanism = equations.mechanism();
  const auto n = static_cast<std::size_t>(mechanism.size());
  std::vector<double> velocity(n + 1, 0.0), acceleration(n + 1, 0.0), slope(model::FreeCoordinate::most_places);
  std::copy(state.v.begin(), state.v.end(), velocity.begin() + 1);
  std::copy(state.acceleration.begin(), state.acceleration.end(), acceleration.begin() + 1);
  model::Motion motion;
  motion.q = state.q.data();
  motion.v = velocity.data() + 1;
  Vector force(mechanism.size()), gap(mechanism.constraint_count());
  equations.go_to(state, model::Side::right);
  equations.residual(force, gap);
  Approach result;
  result.rate = lock.sign * lock.s.rate(motion);
  if (!lock.is_rigid()) {
    constexpr double round_off = 1e-11;
    result.pushes = lock.depth(motion) > round_off * (1.0 + std::abs(lock.at)) && lock.push(motion) > 0.0;
  }
  result.second_rate = lock.sign * lock.s.second_rate(motion, acceleration.data() + 1);
  lock.s.slope(motion.q, slope.data());
  const std::vector<Index> places = lock.s.places();
  const Vector inertia = mechanism.mass().diagonal();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Index place = places[i];
    if (place < 0) continue;
    result.unknown_rate += nothing * std::abs(slope[i] * state.v[place]);
    result.unknown_second +=
        nothing * std::abs(slope[i]) * (std::abs(state.acceleration[place]) + std::abs(force[place]) / inertia[place]);
  }
  return result;
}

}  // namespace

bool release_pulling_stop(const system::Mechanism& mechanism, system::State& state) {
  const auto& locks = mechanism.model().locks;
  const double most = state.multiplier.size() > 0 ? state.multiplier.cwiseAbs().maxCoeff() : 0.0;
  double strongest = -nothing * most;
  std::size_t found = locks.size();
  for (std::size_t i = 0; i < locks.size(); ++i) {
    if (state.phase[i] != model::lock_engaged || locks[i].is_latch || !locks[i].is_rigid()) continue;
    if (!locks[i].is_met_at_start) continue;
    const double press = locks[i].sign * state.multiplier[mechanism.first_row(locks[i].joint)];
    if (!(press < strongest)) continue;
    strongest = press;
    found = i;
  }
  if (found == locks.size()) return false;
  state.phase[found] = model::lock_open;
  state.multiplier[mechanism.first_row(locks[found].joint)] = 0.0;
  return true;
}

ConsistentStart make_consistent_on_locks(system::MechanismEquations& equations, const system::State& given,
                                         bool stands) {
  const auto& locks = equations.mechanism().model().locks;
  std::vector<std::size_t> met;
  system::State phases = given;
  for (std::size_t i = 0; i < locks.size(); ++i) {
    if (given.phase[i] != model::lock_engaged || locks[i].is_latch) continue;
    met.push_back(i);
    phases.phase[i] = model::lock_open;
  }
  ConsistentStart result = make_consistent(equations, phases);
  if (met.empty() || !result.is_consistent) return result;
  const auto balance = [&](system::State& state) {
    return stands ? find_acceleration_at_rest(equations, state, model::Side::right)
                  : find_acceleration(equations, state, model::Side::right);
  };
  if (stands) result.is_consistent = balance(result.state);
  if (!result.is_consistent) return result;
  const auto engage_where = [&](system::State& state, auto&& holds) {
    bool has_changed = false;
    for (const std::size_t i : met) {
      if (state.phase[i] != model::lock_open || !holds(approach_of(equations, result.state, locks[i]))) continue;
      state.phase[i] = model::lock_engaged;
      has_changed = true;
    }
    return has_changed;
  };
  // A stop that takes velocities may lead others against theirs.
  while (engage_where(phases, [](const Approach& approach) { return approach.meets() || approach.pushes; })) {
    result = make_consistent(equations, phases);
    if (!result.is_consistent) return result;
  }
  const std::size_t most_changes = 20 * met.size();
  for (std::size_t change = 0; change < most_changes; ++change) {
    system::State& state = result.state;
    const bool has_changed = release_pulling_stop(equations.mechanism(), state) ||
                             engage_where(state, [](const Approach& approach) { return approach.presses(); });
    if (!has_changed) break;
    result.is_consistent = balance(state);
    if (!result.is_consistent) break;
  }
  return result;
}

}  // namespace rubato::integrate
