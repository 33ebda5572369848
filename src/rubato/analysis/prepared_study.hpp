#pragma once

#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/study_transients.hpp>
#include <rubato/model/description.hpp>
#include <rubato/model/doubtful_values.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::analysis {

/// A study evaluated, assembled and found possible, with the analyses that are asked for. What is planned refers to
/// the rest, which must stay where it is.
struct PreparedStudy {
  std::shared_ptr<const model::StudyDescription> description;
  numerics::Parameters overrides, parameters;
  std::vector<model::AnalysisDescription> analyses;
  std::vector<PlannedAnalysis> planned;  ///< each of them
  std::unique_ptr<const integrate::SystemKind> kind;
  std::unique_ptr<StudyTransients> transients = nullptr;

  double expected_bytes() const;
  StudyInput input() const { return {*description, overrides, parameters, *kind, transients.get()}; }
};

/// The analyses of these names in the order of the study, all where none is named. Throws InvalidInput for a study
/// without analyses, and for a name that none has.
/// @param option  how the user gave the names, with a blank: heads the message
std::vector<model::AnalysisDescription> chosen_analyses(const model::StudyDescription& study,
                                                        const std::vector<std::string>& names,
                                                        const std::string& option = "");

/// Throws InvalidInput, and std::runtime_error where memory does not suffice.
/// @param overrides  values that replace those of the study
/// @param analyses   some of the study's
std::unique_ptr<const PreparedStudy> prepare(std::shared_ptr<const model::StudyDescription> study,
                                             const numerics::Parameters& overrides,
                                             std::vector<model::AnalysisDescription> analyses);

/// What is told of a model before it runs.
struct ModelFindings {
  std::vector<model::DoubtfulValue> doubts;  ///< values that are hardly meant
  std::vector<std::string> facts;            ///< what a finite element model is, for people
};
ModelFindings findings_of(const PreparedStudy& study);

/// Throws InvalidInput for an analysis that keeps more than the memory of this machine.
/// @param keeps_results  whether all results are kept in memory, too
void require_memory(const PreparedStudy& study, bool keeps_results = false);

}  // namespace rubato::analysis
