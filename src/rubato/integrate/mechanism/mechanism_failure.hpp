#pragma once

#include <rubato/integrate/march_failure.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>
#include <rubato/system/mechanism.hpp>

#include <span>

namespace rubato::integrate {

/// What locks and frictions did in a march.
struct Transitions {
  Index chattering = -1;                ///< the guard that changed without end; -1: none
  std::span<const LockEvent> all = {};  ///< in the order of time
};

/// Why a march of a mechanism ended before its time. A singular configuration is named with the joints that repeat
/// others there.
/// @param equations    lent; wherever they are left is well
/// @param state        the last accepted one
/// @param transitions  of its locks and frictions
MarchFailure failure_of(const MarchReport& report, system::MechanismEquations& equations, const system::State& state,
                        const Transitions& transitions);

}  // namespace rubato::integrate
