#pragma once

#include <rubato/system/mechanism_equations.hpp>

#include <vector>

namespace rubato::integrate {

/// Decides which joints with friction stick and which slide, and which way, in a state whose positions and velocities
/// are known; accelerations and multipliers become those of equilibrium (of Coulomb's law).
///
/// A candidate, whose coordinate is at rest, sticks if that takes no more than mu N; otherwise it goes the way in which
/// it is pulled. Of several the one that exceeds its limit most is let go first, and then the others are looked at
/// again; one that would then move against its way is held. Joints that stick already are looked at like candidates;
/// those that slide go on. What goes, but cannot since others hold it (two dry hinges on one axis, of which one alone
/// is not strong enough), pulls; what pulls already is a candidate again. One that a rigid lock of its own joint holds
/// is left out, and is a candidate when that lets go; so is one that drives hold which stand still. Where the friction
/// of one that rests may change the limit of another all ways are tried first (choose_frictions()); where none of them
/// is one, what was decided one by one stands, as it does for more than six.
/// @param candidates  of all joints with friction
/// @param ahead       for which a drive that stands must stand to hold joints [s]
/// @param at_limit    those that sticking took to their limit just now, or that pulled: they stick only if they are
///                    clearly below it; empty: none
/// @return false where no acceleration is found
bool settle_friction(system::MechanismEquations& equations, system::State& state, std::vector<char> candidates,
                     double ahead, std::vector<char> at_limit = {});

/// Whether a rigid lock of the same joint holds what rubs: what either of them carries nothing tells.
bool is_locked(const model::Mechanism& model, const system::State& state, std::size_t friction);

/// The same where velocities are new (at the start, after an impact): joints at rest are candidates, the others slide
/// as they move. Impulses are taken without friction: one of a preload is none in no time, one of a reaction is left
/// out.
bool settle_new_velocities(system::MechanismEquations& equations, system::State& state, double ahead);

}  // namespace rubato::integrate
