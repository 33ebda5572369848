#pragma once

#include <rubato/integrate/mechanism/mechanism_timeline.hpp>
#include <rubato/results/sink.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// The locks that engaged and let go, and the joints that stuck and slipped, in a table `events`; before them the locks
/// on which the run starts at rest, as if they had engaged then.
void write_events(const std::string& name, const system::State& start, const std::vector<integrate::LockEvent>& events,
                  const system::Mechanism& mechanism, results::Sink& sink);

/// Locks one by one; friction, which may stick and slip often, by its first changes and their number.
/// @param known  of their times [s]
void report_events(const std::vector<integrate::LockEvent>& events, const system::Mechanism& mechanism, double known,
                   std::vector<std::string>& findings);

}  // namespace rubato::analysis
