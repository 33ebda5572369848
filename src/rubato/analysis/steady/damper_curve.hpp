#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/steady/steady_route.hpp>

#include <string>

namespace rubato::analysis {

struct DamperCurvePlan;

/// The solvers that a damper curve needs: periodic orbits to the round-off that differences of them can bear, or
/// harmonic balance to its tolerance.
steady::SteadySolvers damper_curve_solvers(const DamperCurvePlan& plan);

/// Finds the largest objective over frequency at every value of the parameter, and refines the value where it is best
/// (see find_optimum), on several threads; streams the tables of DamperCurveTables. The numbers have the same bits
/// whatever the number of threads. A value without a peak has a status; the others go on.
RunReport run_damper_curve(const std::string& name, const DamperCurvePlan& plan, const StudyInput& input,
                           const steady::SteadySolvers& solvers, RunContext& context);

}  // namespace rubato::analysis
