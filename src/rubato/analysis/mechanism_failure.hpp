#pragma once

#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>
#include <rubato/system/mechanism.hpp>

#include <span>
#include <string>

namespace rubato::analysis {

/// What locks and frictions did in a march.
struct Transitions {
  Index chattering = -1;                           ///< the guard that changed without end; -1: none
  std::span<const integrate::LockEvent> all = {};  ///< in the order of time
};

/// Why a march of a mechanism ended before its time, with the names of the user's parts, and what may help. A singular
/// configuration is named with the joints that repeat others there.
/// @param state           the last accepted one
/// @param transitions     of its locks and frictions
/// @param advice_on_step  what helps where the error asks for a step below the smallest
std::string failure_of(const integrate::MarchReport& report, const system::Mechanism& mechanism,
                       const system::State& state, const Transitions& transitions, const std::string& advice_on_step);

}  // namespace rubato::analysis
