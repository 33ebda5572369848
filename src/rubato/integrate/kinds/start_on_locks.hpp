#pragma once

#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/system/mechanism_equations.hpp>

namespace rubato::integrate {

/// make_consistent() of a state that lies on locks, which are engaged in it. Latches stay engaged. Of the stops only
/// those that do something:
///
///   velocities that lead against a stop: it engages, and a rigid one takes them
///   velocities that lead away from it: it is open
///   pressed already, and its spring and damper push: it is engaged
///   neither: it is engaged where it presses, and open where the parts accelerate away or nothing presses
///
/// @param stands  the state is one at rest, of statics or modes: neither velocities nor the rates of drives decide
ConsistentStart make_consistent_on_locks(system::MechanismEquations& equations, const system::State& given,
                                         bool stands = false);

/// Opens one rigid stop that the start lies on and that would pull. Returns whether there was one.
bool release_pulling_stop(const system::Mechanism& mechanism, system::State& state);

}  // namespace rubato::integrate
