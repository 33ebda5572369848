#include <rubato/integrate/mechanism/friction_phases.hpp>
#include <rubato/integrate/mechanism/held_frictions.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

using model::friction_free;
using model::friction_pulls_down;
using model::friction_pulls_up;
using model::friction_slides_down;
using model::friction_slides_up;
using model::friction_sticks;

/// The second derivative of a friction's coordinate, in the direction in which it slides, from the difference of its
/// rates at both ends of a short motion.
double departure(system::MechanismEquations& equations, const system::State& state, std::size_t friction) {
  constexpr double short_time = 1e-6;
  system::State ahead = state;
  ahead.t += short_time;
  equations.mechanism().retract(state.q, short_time * state.v + (0.5 * short_time * short_time) * state.acceleration,
                                ahead.q);
  ahead.v += short_time * state.acceleration;
  equations.go_to(ahead, model::Side::right);
  const double after = equations.friction_rate(friction);
  equations.go_to(state, model::Side::right);
  return model::sliding_direction(state.rubbing[friction]) * (after - equations.friction_rate(friction)) / short_time;
}

/// Whether a rigid lock of the same joint holds what rubs: what either of them carries nothing tells.
bool is_locked(const model::Mechanism& model, const system::State& state, std::size_t friction) {
  for (std::size_t lock = 0; lock < model.locks.size(); ++lock)
    if (state.phase[lock] == model::lock_engaged && model.locks[lock].is_rigid() &&
        model.locks[lock].name == model.frictions[friction].name)
      return true;
  return false;
}

/// What may stick, by the candidates; the phases and accelerations of all become those of Coulomb's law.
bool decide(system::MechanismEquations& equations, system::State& state, std::vector<char>& candidates,
            const std::vector<char>& at_limit) {
  const auto& mechanism = equations.mechanism();
  const auto& frictions = mechanism.model().frictions;
  std::vector<char> is_open(frictions.size(), 0);  // may stick or slide as it turns out
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    const bool has_been_free = state.rubbing[i] == friction_free;
    if (is_locked(mechanism.model(), state, i)) {
      state.rubbing[i] = friction_free;
      candidates[i] = 0;
      continue;
    }
    candidates[i] = candidates[i] || has_been_free;
    if (candidates[i]) {
      state.rubbing[i] = friction_sticks;
      state.stuck_at[static_cast<Index>(i)] = frictions[i].s.value(state.q.data());
    }
    is_open[i] = state.rubbing[i] == friction_sticks;
  }
  if (!find_acceleration(equations, state, model::Side::right)) return false;
  const auto most_changes = 4 * frictions.size() + 4;
  for (std::size_t change = 0; change < most_changes; ++change) {
    equations.go_to(state, model::Side::right);
    std::size_t worst = frictions.size();
    double largest = -HUGE_VAL;
    for (std::size_t i = 0; i < frictions.size(); ++i) {
      if (state.rubbing[i] != friction_sticks) continue;
      const double held = std::abs(equations.friction_force(i, state.multiplier));
      const double excess = held - equations.friction_limit(i, state.multiplier);
      const double round_off = (at_limit[i] ? -1e-9 : 1e-9) * held;
      if (!(excess <= round_off) && !(excess <= largest)) {
        largest = excess;
        worst = i;
      }
    }
    if (worst < frictions.size()) {
      const double force = equations.friction_force(worst, state.multiplier);
      state.rubbing[worst] = force < 0.0 ? friction_slides_up : friction_slides_down;
      if (!find_acceleration(equations, state, model::Side::right)) return false;
      continue;
    }
    bool holds_another = false;
    const double size = state.acceleration.size() > 0 ? state.acceleration.cwiseAbs().maxCoeff() : 0.0;
    for (std::size_t i = 0; i < frictions.size(); ++i) {
      if (!is_open[i] || state.rubbing[i] == friction_sticks) continue;
      if (!(departure(equations, state, i) < -1e-6 * size)) continue;
      state.rubbing[i] = friction_sticks;
      is_open[i] = 0;  // once
      holds_another = true;
      if (!find_acceleration(equations, state, model::Side::right)) return false;
      break;
    }
    if (!holds_another) break;
  }
  return true;
}

}  // namespace

bool settle_friction(system::MechanismEquations& equations, system::State& state, std::vector<char> candidates,
                     std::vector<char> at_limit) {
  const std::size_t count = candidates.size();
  at_limit.resize(count, 0);
  for (std::size_t i = 0; i < count; ++i)
    candidates[i] = candidates[i] || state.rubbing[i] == friction_pulls_up || state.rubbing[i] == friction_pulls_down;
  for (std::size_t round = 0; round <= count; ++round) {
    if (!decide(equations, state, candidates, at_limit)) return false;
    const std::vector<char> is_held = held_frictions(equations, state);
    if (is_held.size() != count) return false;
    bool is_news = false;  // what slid until now stands, since another holds it
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_held[i]) continue;
      is_news = is_news || !candidates[i];
      candidates[i] = 1;
      state.rubbing[i] = state.rubbing[i] == friction_slides_up ? friction_pulls_up : friction_pulls_down;
    }
    if (!is_news) break;
  }
  bool holds_new = false;
  for (std::size_t i = 0; i < count; ++i)
    holds_new = holds_new || (candidates[i] && state.rubbing[i] == friction_sticks);
  if (!holds_new) return true;
  const ConsistentStart at_rest = make_consistent(equations, state, model::Side::right);  // rates left are round-off
  if (at_rest.is_consistent) state = at_rest.state;
  return at_rest.is_consistent;
}

bool settle_new_velocities(system::MechanismEquations& equations, system::State& state) {
  const auto& frictions = equations.mechanism().model().frictions;
  std::vector<char> candidates(frictions.size(), 0);
  equations.go_to(state, model::Side::right);
  const double fastest = state.v.size() > 0 ? state.v.cwiseAbs().maxCoeff() : 0.0;
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    const double rate = equations.friction_rate(i);
    candidates[i] = std::abs(rate) <= 1e-10 * fastest;
    state.rubbing[i] = rate > 0.0 ? friction_slides_up : friction_slides_down;
  }
  return settle_friction(equations, state, candidates);
}

}  // namespace rubato::integrate
