#pragma once

#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/model/description.hpp>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rubato::analysis {

/// The transients of a study, each planned once: by its own analysis, or before by another that refers to it. One a
/// thread.
class StudyTransients {
 public:
  /// All must outlive this.
  StudyTransients(const std::vector<model::AnalysisDescription>& analyses, const integrate::SystemKind& kind,
                  const numerics::Parameters& parameters)
      : analyses_(analyses), kind_(kind), parameters_(parameters) {}

  /// All analyses of the study.
  const std::vector<model::AnalysisDescription>& analyses() const { return analyses_; }
  /// The plan of one of them, a transient. Throws InvalidInput.
  std::shared_ptr<const TransientPlan> plan(const model::AnalysisDescription& analysis);

 private:
  const std::vector<model::AnalysisDescription>& analyses_;
  const integrate::SystemKind& kind_;
  const numerics::Parameters& parameters_;
  std::map<std::string, std::shared_ptr<const TransientPlan>> plans_;
};

}  // namespace rubato::analysis
