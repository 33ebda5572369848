#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/model/description.hpp>

#include <functional>
#include <string>
#include <vector>

namespace rubato::analysis {

/// What an analysis would do, in a line for people, and how much it would write.
struct AnalysisOutline {
  std::string summary;                     ///< "transient, generalized_alpha, 12000 steps of 0.005 s"
  double expected_bytes = 0.0;             ///< of the results, roughly
  double points = 0.0;                     ///< of a sweep; 0 for other analyses
  double key_bytes = 0.0;                  ///< of its key numbers, as a sample of a sweep, roughly
  double memory = 0.0;                     ///< what has to be kept until its end [bytes], roughly
  std::vector<std::string> warnings = {};  ///< what a run would warn of, as far as it is known before
};

/// An analysis that was evaluated and found possible, ready to run. The study and the parameters of the input of its
/// plan must outlive it.
struct PlannedAnalysis {
  AnalysisOutline outline;
  /// Runs it at the input of the plan, or a copy of that: a thread needs a system of its own.
  std::function<RunReport(const StudyInput& input, RunContext& context)> run;
};

/// Evaluates an analysis and checks that it can run. Throws InvalidInput.
PlannedAnalysis plan_analysis(const model::AnalysisDescription& analysis, const StudyInput& input);

/// The same for what a run would do alone.
inline AnalysisOutline check_analysis(const model::AnalysisDescription& analysis, const StudyInput& input) {
  return plan_analysis(analysis, input).outline;
}

/// Runs it: rows go to the sink, then its conclusion. Failures of the mathematics and Ctrl-C are in the report; throws
/// OutputError when results cannot be written.
RunReport run_analysis(const model::AnalysisDescription& analysis, const PlannedAnalysis& planned,
                       const StudyInput& input, RunContext& context);

/// Plans it before; throws InvalidInput before anything is written.
RunReport run_analysis(const model::AnalysisDescription& analysis, const StudyInput& input, RunContext& context);

}  // namespace rubato::analysis
