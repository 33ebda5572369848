#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/steady/steady_route.hpp>

#include <string>

namespace rubato::analysis {

struct FrequencyResponsePlan;

/// Solves the steady response at every point of a planned sweep, on several threads, and streams its tables: the main
/// one, `linear`, `waveforms` where they are asked for, and `bands` of random samples. The numbers have the same bits
/// whatever the number of threads. A point that cannot be solved has a status; the others go on.
///
/// @param solvers  of the plan's route, or others
RunReport run_frequency_response(const std::string& name, const FrequencyResponsePlan& plan, const StudyInput& input,
                                 const steady::SteadySolvers& solvers, RunContext& context);

}  // namespace rubato::analysis
