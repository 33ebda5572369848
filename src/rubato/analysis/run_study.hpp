#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/study_input.hpp>
#include <rubato/model/description.hpp>

namespace rubato::analysis {

/// What an analysis would do, in a line for people, and how much it would write.
struct AnalysisOutline {
  std::string summary;                     ///< "transient, generalized_alpha, 12000 steps of 0.005 s"
  double expected_bytes = 0.0;             ///< of the results, roughly
  double points = 0.0;                     ///< of a sweep; 0 for other analyses
  double memory = 0.0;                     ///< what has to be kept until its end [bytes], roughly
  std::vector<std::string> warnings = {};  ///< what a run would warn of, as far as it is known before
};

/// Evaluates an analysis and checks that it can run. Throws InvalidInput.
AnalysisOutline check_analysis(const model::AnalysisDescription& analysis, const StudyInput& input);

/// Runs it: rows go to the sink, then its conclusion. Failures of the mathematics and Ctrl-C are in the report; throws
/// InvalidInput before anything is written, and OutputError when results cannot be written.
RunReport run_analysis(const model::AnalysisDescription& analysis, const StudyInput& input, RunContext& context);

}  // namespace rubato::analysis
