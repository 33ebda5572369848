#pragma once

#include <rubato/core/error.hpp>
#include <rubato/system/mechanism.hpp>

#include <string>
#include <vector>

namespace rubato::integrate {

/// The start of a mechanism on its constraints. What had to move, and constraints that repeat others, are told in
/// `warnings`. Throws InvalidInput, naming the joints and by how much they are apart, where they cannot be assembled.
/// @param moves  what starts there goes on with its velocities: that they had to change is told
system::State assembled_start(const Location& where, const system::Mechanism& mechanism,
                              std::vector<std::string>& warnings, bool moves = true);

/// From an equilibrium at rest: with the velocities that are given, which may lead away from stops, and the velocities
/// and accelerations that the drives have at t = 0. Throws InvalidInput where there are none.
system::State set_in_motion(const Location& where, const system::Mechanism& mechanism, system::State at_rest,
                            std::vector<std::string>& warnings);

/// Decides which joints with friction stick at the start. Throws InvalidInput where no accelerations go with their
/// friction, and for friction that follows a reaction which joints share in a way that nothing determines.
void settle_start(const Location& where, const system::Mechanism& mechanism, double duration, system::State& state);

/// A drive, or joints that had to move, may put a coordinate beyond its lock, which was meant to be reached.
void warn_of_locks_behind(const system::Mechanism& mechanism, const system::State& start,
                          std::vector<std::string>& warnings);

}  // namespace rubato::integrate
