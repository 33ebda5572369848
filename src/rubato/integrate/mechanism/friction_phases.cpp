#include <rubato/integrate/mechanism/friction_phases.hpp>
#include <rubato/integrate/mechanism/held_frictions.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>

#include <Eigen/LU>

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

/// The slip velocity of two frictions that share a limit, or the rate of one alone, in the direction in which it
/// slides.
double forward_rate(const system::MechanismEquations& equations, const system::State& state, std::size_t friction) {
  const int partner = equations.mechanism().model().frictions[friction].partner;
  if (partner < 0) return model::sliding_direction(state.rubbing[friction]) * equations.friction_rate(friction);
  const Eigen::Vector2d floor(state.stuck_at[static_cast<Index>(friction)], state.stuck_at[partner]);
  return floor.normalized().dot(equations.slip_velocity(friction));
}

/// Its derivative, from the difference at both ends of a short motion.
double departure(system::MechanismEquations& equations, const system::State& state, std::size_t friction) {
  constexpr double short_time = 1e-6;
  system::State ahead = state;
  ahead.t += short_time;
  equations.mechanism().retract(state.q, short_time * state.v + (0.5 * short_time * short_time) * state.acceleration,
                                ahead.q);
  ahead.v += short_time * state.acceleration;
  equations.go_to(ahead, model::Side::right);
  const double after = forward_rate(equations, state, friction);
  equations.go_to(state, model::Side::right);
  return (after - forward_rate(equations, state, friction)) / short_time;
}

/// Whether a rigid lock of the same joint holds what rubs: what either of them carries nothing tells.
bool is_locked(const model::Mechanism& model, const system::State& state, std::size_t friction) {
  for (std::size_t lock = 0; lock < model.locks.size(); ++lock)
    if (state.phase[lock] == model::lock_engaged && model.locks[lock].is_rigid() &&
        model.locks[lock].name == model.frictions[friction].name)
      return true;
  return false;
}

/// A phase for a friction, and for the one that shares its limit.
void set_phase(const model::Mechanism& model, system::State& state, std::size_t friction, int phase) {
  state.rubbing[friction] = phase;
  if (model.frictions[friction].partner >= 0)
    state.rubbing[static_cast<std::size_t>(model.frictions[friction].partner)] = phase;
}

void set_floor(const model::Mechanism& model, system::State& state, std::size_t friction,
               const Eigen::Vector2d& floor) {
  state.stuck_at[static_cast<Index>(friction)] = floor[0];
  state.stuck_at[model.frictions[friction].partner] = floor[1];
}

/// Lets two frictions that share a limit go from rest, in the direction d in which they then slip: with the
/// acceleration b that there would be without them and W, which friction in a direction d takes from it, (W + kappa 1)
/// d = b, |d| = 1. At the limit itself nothing is left to accelerate, and d is the direction in which they are pulled.
bool let_go(system::MechanismEquations& equations, system::State& state, std::size_t friction) {
  constexpr double excess = 1e-6;  // below, what accelerates may be round-off
  const model::Mechanism& model = equations.mechanism().model();
  const auto other = static_cast<std::size_t>(model.frictions[friction].partner);
  const Eigen::Vector2d held(equations.friction_force(friction, state.multiplier) / model.frictions[friction].arm,
                             equations.friction_force(other, state.multiplier) / model.frictions[other].arm);
  const double limit = equations.friction_limit(friction, state.multiplier);
  const double size = equations.friction_size(friction, state.multiplier);
  Eigen::Vector2d way = -held.normalized();
  set_phase(model, state, friction, friction_slides_up);
  const auto slip_along = [&](const Eigen::Vector2d& direction, Eigen::Vector2d& found) {
    set_floor(model, state, friction, model::slip_floor_at_rest * direction);
    if (!find_acceleration(equations, state, model::Side::right)) return false;
    found = equations.slip_acceleration(friction, state.acceleration);
    return true;
  };
  Eigen::Vector2d found, first, second, back;
  if (size > (1.0 + excess) * limit) {
    if (!slip_along({1.0, 0.0}, first) || !slip_along({0.0, 1.0}, second) || !slip_along({-1.0, 0.0}, back))
      return false;
    const Eigen::Vector2d free = 0.5 * (first + back);
    Eigen::Matrix2d taken;
    taken << free - first, free - second;
    const auto at = [&](double kappa) -> Eigen::Vector2d {
      return (taken + kappa * Eigen::Matrix2d::Identity()).inverse() * free;
    };
    double low = 0.0, high = free.norm();
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (at(middle).norm() > 1.0 ? low : high) = middle;
    }
    if (at(high).allFinite()) way = at(high).normalized();
  }
  return slip_along(way, found);
}

/// What may stick, by the candidates; the phases and accelerations of all become those of Coulomb's law.
bool decide(system::MechanismEquations& equations, system::State& state, std::vector<char>& candidates,
            const std::vector<char>& at_limit) {
  const auto& mechanism = equations.mechanism();
  const auto& frictions = mechanism.model().frictions;
  std::vector<char> is_open(frictions.size(), 0);  // may stick or slide as it turns out
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    if (equations.is_led(i)) continue;
    const bool has_been_free = state.rubbing[i] == friction_free;
    if (is_locked(mechanism.model(), state, i)) {
      state.rubbing[i] = friction_free;
      candidates[i] = 0;
      continue;
    }
    candidates[i] = candidates[i] || has_been_free;
    if (candidates[i]) {
      set_phase(mechanism.model(), state, i, friction_sticks);
      state.stuck_at[static_cast<Index>(i)] = frictions[i].s.value(state.q.data());
      if (const int other = frictions[i].partner; other >= 0)
        state.stuck_at[other] = frictions[static_cast<std::size_t>(other)].s.value(state.q.data());
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
      if (state.rubbing[i] != friction_sticks || equations.is_led(i)) continue;
      const double held = equations.friction_size(i, state.multiplier);
      const double excess = held - equations.friction_limit(i, state.multiplier);
      const double round_off = (at_limit[i] ? -1e-9 : 1e-9) * held;
      if (!(excess <= round_off) && !(excess <= largest)) {
        largest = excess;
        worst = i;
      }
    }
    if (worst < frictions.size() && frictions[worst].partner >= 0) {
      if (!let_go(equations, state, worst)) return false;
      continue;
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
      set_phase(mechanism.model(), state, i, friction_sticks);
      if (const int other = frictions[i].partner; other >= 0) {
        state.stuck_at[static_cast<Index>(i)] = frictions[i].s.value(state.q.data());
        state.stuck_at[other] = frictions[static_cast<std::size_t>(other)].s.value(state.q.data());
      }
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
  bool lets_go = false;  // of two that share a limit: what is left of velocities would be their direction
  for (std::size_t i = 0; i < count; ++i)
    lets_go = lets_go || (at_limit[i] && state.rubbing[i] == friction_sticks &&
                          equations.mechanism().model().frictions[i].partner >= 0);
  if (lets_go) {
    const ConsistentStart still = make_consistent(equations, state, model::Side::right);
    if (!still.is_consistent) return false;
    state = still.state;
  }
  for (std::size_t round = 0; round <= count; ++round) {
    if (!decide(equations, state, candidates, at_limit)) return false;
    const std::vector<char> is_held = held_frictions(equations, state);
    if (is_held.size() != count) return false;
    bool is_news = false;  // what slid until now stands, since another holds it
    for (std::size_t i = 0; i < count; ++i) {
      const int other = equations.mechanism().model().frictions[i].partner;
      if (equations.is_led(i) || !is_held[i] || (other >= 0 && !is_held[static_cast<std::size_t>(other)])) continue;
      is_news = is_news || !candidates[i];
      candidates[i] = 1;
      set_phase(equations.mechanism().model(), state, i,
                state.rubbing[i] == friction_slides_up ? friction_pulls_up : friction_pulls_down);
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
    if (equations.is_led(i)) continue;
    if (frictions[i].partner >= 0) {
      const Eigen::Vector2d slip = equations.slip_velocity(i);
      candidates[i] = slip.norm() <= 1e-10 * fastest;
      set_phase(equations.mechanism().model(), state, i, friction_slides_up);
      set_floor(equations.mechanism().model(), state, i, model::slip_floor_share * slip);
      continue;
    }
    const double rate = equations.friction_rate(i);
    candidates[i] = std::abs(rate) <= 1e-10 * fastest;
    state.rubbing[i] = rate > 0.0 ? friction_slides_up : friction_slides_down;
  }
  return settle_friction(equations, state, candidates);
}

}  // namespace rubato::integrate
