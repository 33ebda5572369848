#pragma once

#include <rubato/integrate/events.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>
#include <rubato/system/mechanism.hpp>

#include <span>

namespace rubato::integrate {

/// What locks and frictions of a mechanism did, as all systems tell it: the parts are its locks, then its frictions.
/// @param start  locks that hold there are told as if they had engaged then; null: they are not told
Events events_of(std::span<const LockEvent> events, const system::Mechanism& mechanism,
                 const system::State* start = nullptr);

}  // namespace rubato::integrate
