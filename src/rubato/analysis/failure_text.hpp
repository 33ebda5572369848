#pragma once

#include <rubato/integrate/march_failure.hpp>
#include <rubato/integrate/march_plan.hpp>

#include <string>

namespace rubato::analysis {

/// What helps where the error asked for a step below the smallest.
std::string advice_on_step(const integrate::MarchFailure& failure, const integrate::MarchPlan& plan);

/// Why a march ended before its time, with the names of the user's parts, and what may help.
/// @param advice_on_step  see there
std::string text_of(const integrate::MarchFailure& failure, const std::string& advice_on_step);

}  // namespace rubato::analysis
