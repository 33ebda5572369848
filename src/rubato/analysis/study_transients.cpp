#include <rubato/analysis/study_transients.hpp>

#include <variant>

namespace rubato::analysis {

std::shared_ptr<const TransientPlan> StudyTransients::plan(const model::AnalysisDescription& analysis) {
  std::shared_ptr<const TransientPlan>& known = plans_[analysis.name];
  if (!known)
    known = std::make_shared<const TransientPlan>(plan_transient(
        analysis.name, analysis.where, std::get<model::TransientDescription>(analysis.task), kind_, parameters_));
  return known;
}

}  // namespace rubato::analysis
