#pragma once

#include <rubato/system/mechanism_equations.hpp>

#include <vector>

namespace rubato::integrate {

/// Decides which joints with friction stick and which slide, and which way, in a state whose positions and velocities
/// are known. Accelerations and multipliers become those of equilibrium by Coulomb's law.
///
/// A candidate is a friction whose coordinate is at rest. It sticks if that takes no more than mu N; otherwise it
/// slides the way in which it is pulled. Of several candidates that exceed their limits the one that exceeds it most is
/// let go first, and then all are looked at again. A friction that would then accelerate against its way sticks.
///
/// - A joint that sticks already is a candidate. A joint that slides goes on sliding.
/// - A friction that exceeds its limit, but whose joint other joints hold, is at its limit: two dry hinges on one axis,
/// of
///   which one alone is not strong enough. It is a candidate the next time.
/// - A friction whose joint is held by a rigid lock of its own is left out until that lock lets go. So is a friction
///   whose joint is held by drives that stand still.
///
/// Where the friction of a candidate may change the limit of another, all combinations are tried first
/// (choose_frictions()). If none of them satisfies Coulomb's law, or if there are more than six candidates, the
/// decisions one by one stand.
/// @param candidates  of all joints with friction
/// @param ahead       for how long a drive that stands must go on standing to count as holding a joint [s]
/// @param at_limit    the frictions that reached their limit just now, or were at it: they stick only if they are
/// clearly
///                    below it; empty: none
/// @return false where no acceleration is found
bool find_friction_phases(system::MechanismEquations& equations, system::State& state, std::vector<char> candidates,
                          double ahead, std::vector<char> at_limit = {});

/// Whether a rigid lock of the same joint holds it: nothing then determines what the lock and the friction carry each.
bool is_locked(const model::Mechanism& model, const system::State& state, std::size_t friction);

/// The same where velocities are new (at the start, after an impact): joints at rest are candidates, the others slide
/// as they move. Impulses are taken without friction, since that of a preload has no impulse in an instant, and that of
/// a reaction is left out.
bool find_phases_of_new_velocities(system::MechanismEquations& equations, system::State& state, double ahead);

}  // namespace rubato::integrate
