#pragma once

#include "commands.hpp"

#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/study_transients.hpp>
#include <rubato/io/source_files.hpp>
#include <rubato/model/description.hpp>

#include <memory>
#include <vector>

namespace rubato::app {

/// A study read, evaluated, assembled and found possible, with the analyses that are asked for.
struct PreparedStudy {
  model::StudyDescription description;
  io::SourceFiles files;  ///< that the study names
  numerics::Parameters overrides, parameters;
  std::vector<model::AnalysisDescription> analyses;
  std::vector<analysis::PlannedAnalysis> planned;  ///< each of them
  std::unique_ptr<const integrate::SystemKind> kind;
  std::unique_ptr<analysis::StudyTransients> transients = nullptr;

  double expected_bytes() const;
  analysis::StudyInput input() const { return {description, overrides, parameters, *kind, transients.get()}; }
};

/// Throws InvalidInput. What is planned refers to the rest of the study, which must stay where it is.
std::unique_ptr<const PreparedStudy> prepare(const StudyOptions& options);

}  // namespace rubato::app
