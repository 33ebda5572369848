#include <rubato/model/laws/law_kind.hpp>

#include <algorithm>
#include <stdexcept>

namespace rubato::model {

// Each in its file, bouc_wen.cpp and so on.
LawKind bouc_wen();
LawKind cable();
LawKind dahl();
LawKind iwan();
LawKind lugre();
LawKind nonlinear_spring();
LawKind smooth_friction();

std::span<const LawKind> law_kinds() {
  static const std::vector all{bouc_wen(), cable(), dahl(), iwan(), lugre(), nonlinear_spring(), smooth_friction()};
  return all;
}

LawDescription law_description(const LawKind& kind) {
  LawDescription description;
  description.kind = kind.table;
  for (const LawKey& key : kind.keys) description.values.emplace_back(key.preset.value_or(0.0));
  return description;
}

const LawKind& law_kind(std::string_view table) {
  const auto all = law_kinds();
  const auto found = std::find_if(all.begin(), all.end(), [&](const LawKind& kind) { return kind.table == table; });
  if (found == all.end()) throw std::logic_error("there is no law " + std::string(table));
  return *found;
}

}  // namespace rubato::model
