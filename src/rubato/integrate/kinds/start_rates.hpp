#pragma once

#include <rubato/system/mechanism_equations.hpp>

#include <string>
#include <vector>

namespace rubato::integrate {

/// Velocities at the start by the rates that joints are given, in an assembled configuration:
///
///   G v + dg/dt = 0,   s' = rate for each such joint
///
/// Bodies whose velocities are given keep them where that is possible, else their change is told in `warnings`. The
/// others move as an impulse in those joints would have them move: of all such velocities those for which the kinetic
/// energy of the change from the velocities given, at rest unless given, is least. Stops that are engaged hold nothing.
/// Throws InvalidInput for rates that contradict each other, the joints or the drives.
/// @param state  whose velocities are written
void set_start_rates(system::MechanismEquations& equations, system::State& state, std::vector<std::string>& warnings);

}  // namespace rubato::integrate
