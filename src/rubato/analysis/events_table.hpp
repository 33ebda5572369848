#pragma once

#include <rubato/integrate/events.hpp>
#include <rubato/results/sink.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// The table `events`: what locks, frictions, sliders and stops did; before that what holds at the start. Nothing of a
/// system that has no such part.
void write_events(const std::string& name, const integrate::Events& events, results::Sink& sink);

/// That the table lacks some; empty: it does not.
std::string warning_of(const integrate::Events& events);

/// The first changes of each part, and the number of all where there are more.
/// @param known  of their times [s]
void report_events(const integrate::Events& events, double known, std::vector<std::string>& findings);

}  // namespace rubato::analysis
