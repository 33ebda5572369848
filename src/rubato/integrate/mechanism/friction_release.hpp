#pragma once

#include <rubato/system/mechanism_equations.hpp>

#include <vector>

namespace rubato::integrate {

/// Whether a friction gives all of its limit while other joints hold its coordinate at rest.
inline bool is_at_limit(int phase) {
  return phase == model::friction_at_limit_up || phase == model::friction_at_limit_down;
}

/// A phase for a friction, and for the one that shares its limit.
void set_friction_phase(const model::Mechanism& model, system::State& state, std::size_t friction, int phase);

/// The floor of the slip velocity of two frictions that share a limit, with the index of the one that leads [m/s].
void set_slip_floor(const model::Mechanism& model, system::State& state, std::size_t friction,
                    const Eigen::Vector2d& floor);

/// Makes a friction, and the one that shares its limit, stick where they are.
void stick_here(const model::Mechanism& model, system::State& state, std::size_t friction);

/// Lets a friction that sticks slide the way in which it is pulled; accelerations and multipliers become those that go
/// with it. Returns false where none are found.
bool let_go(system::MechanismEquations& equations, system::State& state, std::size_t friction);

/// The acceleration of what rubs in the direction in which it slides [m/s^2], [rad/s^2].
double departure(system::MechanismEquations& equations, const system::State& state, std::size_t friction);

/// Whether something slides, but gathers speed the other way, beyond round-off.
bool goes_backward(system::MechanismEquations& equations, const system::State& state, std::size_t friction);

/// By how much a friction that sticks exceeds its limit, beyond round-off [N], [N m].
/// @param at_limit  it reached its limit just now: it sticks only if it is clearly below it
double excess_of_limit(const system::MechanismEquations& equations, const system::State& state, std::size_t friction,
                       bool at_limit);

/// Puts frictions at their limit that slide by their phase, but whose coordinates other joints hold.
/// @param held  for each friction of the model: becomes 1 where it was put at its limit
/// @return false where a matrix cannot be factorised
bool put_held_at_limit(system::MechanismEquations& equations, system::State& state, std::vector<char>& held);

}  // namespace rubato::integrate
