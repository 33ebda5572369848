#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/mechanism/friction_release.hpp>
#include <rubato/integrate/mechanism/held_frictions.hpp>

#include <Eigen/LU>

#include <cmath>

namespace rubato::integrate {
namespace {

// Of what a friction holds:
constexpr double round_off = 2e-10;
constexpr double clearly = 1e-7;  // below the limit

/// Lets two frictions that share a limit go from rest, in the direction d in which they then slip: with the
/// acceleration b that there would be without them and W, which friction in a direction d takes from it, (W + kappa 1)
/// d = b, |d| = 1. At the limit itself nothing is left to accelerate, and d is the direction in which they are pulled.
bool let_pair_go(system::MechanismEquations& equations, system::State& state, std::size_t friction) {
  constexpr double excess = 1e-6;  // below, what accelerates may be round-off
  const model::Mechanism& model = equations.mechanism().model();
  const auto other = static_cast<std::size_t>(model.frictions[friction].partner);
  const Eigen::Vector2d held(equations.friction_force(friction, state.multiplier) / model.frictions[friction].arm,
                             equations.friction_force(other, state.multiplier) / model.frictions[other].arm);
  const double limit = equations.friction_limit(friction, state.multiplier);
  const double size = equations.friction_size(friction, state.multiplier);
  Eigen::Vector2d way = -held.normalized();
  set_friction_phase(model, state, friction, model::friction_slides_up);
  const auto slip_along = [&](const Eigen::Vector2d& direction, Eigen::Vector2d& found) {
    set_slip_floor(model, state, friction, model::slip_floor_at_rest * direction);
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

}  // namespace

void set_friction_phase(const model::Mechanism& model, system::State& state, std::size_t friction, int phase) {
  state.rubbing[friction] = phase;
  if (model.frictions[friction].partner >= 0)
    state.rubbing[static_cast<std::size_t>(model.frictions[friction].partner)] = phase;
}

void set_slip_floor(const model::Mechanism& model, system::State& state, std::size_t friction,
                    const Eigen::Vector2d& floor) {
  state.stuck_at[static_cast<Index>(friction)] = floor[0];
  state.stuck_at[model.frictions[friction].partner] = floor[1];
}

void stick_here(const model::Mechanism& model, system::State& state, std::size_t friction) {
  const auto& frictions = model.frictions;
  set_friction_phase(model, state, friction, model::friction_sticks);
  state.stuck_at[static_cast<Index>(friction)] = frictions[friction].s.value(state.q.data());
  if (const int other = frictions[friction].partner; other >= 0)
    state.stuck_at[other] = frictions[static_cast<std::size_t>(other)].s.value(state.q.data());
}

double departure(system::MechanismEquations& equations, const system::State& state, std::size_t friction) {
  equations.go_to(state, model::Side::right);
  const int partner = equations.mechanism().model().frictions[friction].partner;
  if (partner < 0)
    return model::sliding_direction(state.rubbing[friction]) *
           equations.friction_acceleration(friction, state.acceleration);
  const Eigen::Vector2d floor(state.stuck_at[static_cast<Index>(friction)], state.stuck_at[partner]);
  return floor.normalized().dot(equations.slip_acceleration(friction, state.acceleration));
}

bool let_go(system::MechanismEquations& equations, system::State& state, std::size_t friction) {
  equations.go_to(state, model::Side::right);
  if (equations.mechanism().model().frictions[friction].partner >= 0) return let_pair_go(equations, state, friction);
  const double force = equations.friction_force(friction, state.multiplier);
  state.rubbing[friction] = force < 0.0 ? model::friction_slides_up : model::friction_slides_down;
  return find_acceleration(equations, state, model::Side::right);
}

bool goes_backward(system::MechanismEquations& equations, const system::State& state, std::size_t friction) {
  const int phase = state.rubbing[friction];
  if (phase != model::friction_slides_up && phase != model::friction_slides_down) return false;
  const double size = state.acceleration.size() > 0 ? state.acceleration.cwiseAbs().maxCoeff() : 0.0;
  return departure(equations, state, friction) < -1e-6 * size;
}

double excess_of_limit(const system::MechanismEquations& equations, const system::State& state, std::size_t friction,
                       bool at_limit) {
  const double held = equations.friction_size(friction, state.multiplier);
  const double excess = held - equations.friction_limit(friction, state.multiplier);
  return at_limit ? excess + clearly * held : excess - round_off * held - equations.negligible_friction(friction);
}

bool put_held_at_limit(system::MechanismEquations& equations, system::State& state, std::vector<char>& held) {
  const auto& model = equations.mechanism().model();
  const std::vector<char> is_held = held_frictions(equations, state);
  if (is_held.size() != model.frictions.size()) return false;
  for (std::size_t i = 0; i < is_held.size(); ++i) {
    const int other = model.frictions[i].partner;
    if (equations.is_led(i) || !is_held[i] || (other >= 0 && !is_held[static_cast<std::size_t>(other)])) continue;
    held[i] = 1;
    set_friction_phase(
        model, state, i,
        state.rubbing[i] == model::friction_slides_up ? model::friction_at_limit_up : model::friction_at_limit_down);
  }
  return true;
}

}  // namespace rubato::integrate
