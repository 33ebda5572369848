#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/samples/samples_plan.hpp>

#include <string>

namespace rubato::analysis {

/// Runs an analysis at every sample of its sweep, on several threads, and streams what SampleTables says. The numbers
/// have the same bits whatever the number of threads. A sample that fails keeps its row, with its reason in the table
/// `failures`, and the others go on.
RunReport run_samples(const std::string& name, const SamplesPlan& plan, const StudyInput& input,
                      const SamplePlanner& plan_one, RunContext& context);

}  // namespace rubato::analysis
