#pragma once

#include <rubato/model/mechanism.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// What bounds the steps of a mechanism that choose themselves: a sixth of the shortest period of a harmonic load, and
/// of a formula where dry joints or rigid stops may hold the mechanism [s]; HUGE_VAL where nothing does.
double period_limit(const model::Mechanism& mechanism, double duration);

/// Tells of formulas that swing too fast for the samples by which they bound the steps.
void warn_of_fast_swings(const model::Mechanism& mechanism, double duration, std::vector<std::string>& warnings);

}  // namespace rubato::analysis
