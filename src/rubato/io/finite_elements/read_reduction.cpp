#include <rubato/io/read_parts.hpp>

namespace rubato::io {
namespace {

void take(const model::ObservationDescription& observation, std::vector<std::string>& names) {
  for (const std::string* name : {&observation.first, &observation.second})
    if (!name->empty()) names.push_back(*name);
}

}  // namespace

void read_mesh(const model::ReductionDescription& reduction, const StudyFolder&,
               std::shared_ptr<const model::FiniteElements>& to) {
  if (!to)
    throw InvalidInput(reduction.where,
                       "[reduction] makes a smaller model of [model], and there is none; name the "
                       "files of a finite element model in [model]");
  auto reduced = std::make_shared<model::FiniteElements>(*to);
  reduced->reduction = std::make_shared<const model::ReductionDescription>(reduction);
  to = std::move(reduced);
}

void read_mesh(const model::CyclicDescription& cyclic, const StudyFolder&,
               std::shared_ptr<const model::FiniteElements>& to) {
  if (!to)
    throw InvalidInput(cyclic.where,
                       "[cyclic] says of which disk [model] is a sector, and there is none; name the files of a finite "
                       "element model in [model]");
  auto sector = std::make_shared<model::FiniteElements>(*to);
  sector->cyclic = std::make_shared<const model::CyclicDescription>(cyclic);
  to = std::move(sector);
}

void keep_observed(model::StudyDescription& study) {
  if (!study.model.finite_elements || !study.model.finite_elements->reduction) return;
  auto reduction = std::make_shared<model::ReductionDescription>(*study.model.finite_elements->reduction);
  const auto take_all = [&](const auto& task) {
    if constexpr (requires { task.observe->begin(); }) {
      if (!task.observe) return;
      for (const auto& observation : *task.observe) take(observation, reduction->observed);
    } else if constexpr (requires { task.observe; }) {
      if (task.observe) take(*task.observe, reduction->observed);
    }
  };
  for (const auto& analysis : study.analyses) std::visit(take_all, analysis.task);
  if (const auto& cyclic = study.model.finite_elements->cyclic) {
    reduction->keep_where.resize(reduction->keep.size(), reduction->where);
    for (const auto& [set, where] :
         {std::pair(&cyclic->left, &cyclic->left_where), {&cyclic->right, &cyclic->right_where}}) {
      reduction->keep.push_back(*set);
      reduction->keep_where.push_back(*where);
    }
  }
  auto elements = std::make_shared<model::FiniteElements>(*study.model.finite_elements);
  elements->reduction = std::move(reduction);
  study.model.finite_elements = std::move(elements);
}

}  // namespace rubato::io
