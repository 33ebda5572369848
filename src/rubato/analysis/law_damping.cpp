#include <rubato/analysis/law_damping.hpp>
#include <rubato/integrate/equilibrium/held_by_laws.hpp>

#include <fmt/format.h>

#include <vector>

namespace rubato::analysis {

std::optional<std::string> warning_of_modal_damping(const StudyInput& input) {
  if (!input.kind.structure() || !std::holds_alternative<model::ModalDamping>(input.study.model.damping))
    return std::nullopt;
  const std::vector<Index> moving = integrate::held_by_laws_alone(input.structure());
  if (moving.empty()) return std::nullopt;
  return fmt::format(
      "damping: modal_ratio belongs to the modes of the structure without its laws, where nothing resists a motion of "
      "\"{}\"{}: that motion is not damped; give it a [[damper]], or write the elastic part of the law as a [[spring]]",
      input.kind.system().coordinates()[static_cast<std::size_t>(moving.front())],
      moving.size() > 1 ? fmt::format(" and {} more", moving.size() - 1) : "");
}

}  // namespace rubato::analysis
