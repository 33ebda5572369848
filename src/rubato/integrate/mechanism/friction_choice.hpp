#pragma once

#include <rubato/system/mechanism_equations.hpp>

#include <vector>

namespace rubato::integrate {

/// The frictions at rest: candidates, those that stick, and those that these would hold.
/// @param candidates  one for each friction of the model
/// @return the same; without those that another leads
std::vector<char> resting_frictions(system::MechanismEquations& equations, const system::State& state,
                                    const std::vector<char>& candidates);

/// Whether the phases of the frictions at rest and the accelerations go together by Coulomb's law: what sticks takes no
/// more than its limit, and what slides goes its way.
bool agree_with_coulomb(system::MechanismEquations& equations, const system::State& state,
                        const std::vector<char>& rests, const std::vector<char>& at_limit);

/// Tries all ways in which the frictions at rest may stick or slide, and takes one that goes together with its
/// accelerations and multipliers: of several the one in which most stick, and of those the one whose frictions keep
/// the largest share of their limits. No more of them stick than it takes: of others on the same freedom all give their
/// friction, so that forces, and the limits that follow them, are determined. Needed where the friction of one joint
/// changes the limit of another: what a joint holds may then have the opposite sign of the way in which it goes. Joints
/// with friction of a preload alone have one answer (Pfeiffer and Glocker 1996); with friction that follows reactions
/// there may be several, or none (Painleve 1895).
/// @return false where none is found, or where more than six are at rest; the state is then undefined
bool choose_frictions(system::MechanismEquations& equations, system::State& state, const std::vector<char>& rests,
                      const std::vector<char>& at_limit);

}  // namespace rubato::integrate
