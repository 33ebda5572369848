#include <rubato/model/build_parts.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace rubato::model {
namespace {

bool is_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Whether a formula has the name t in it, which no parameter may have.
bool names_time(const std::string& formula) {
  for (std::size_t i = 0; i < formula.size(); ++i) {
    const bool begins = i == 0 || !(is_of_name(formula[i - 1]) || formula[i - 1] == '.');
    const bool ends = i + 1 == formula.size() || !is_of_name(formula[i + 1]);
    if (formula[i] == 't' && begins && ends) return true;
  }
  return false;
}

template <class Parts>
Index place_of(const Parts& parts, const std::string& name) {
  const auto found = std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.name == name; });
  return found == parts.end() ? -1 : static_cast<Index>(found - parts.begin());
}

}  // namespace

bool SliderDescription::is_law() const {
  return !normal_law.empty() || follows_own_reaction(*this) || names_time(normal_load.expression);
}

NormalForce build_normal_formula(const SliderDescription& description, const numerics::Parameters& parameters,
                                 const std::string& part) {
  NormalForce normal;
  const Quantity& load = description.normal_load;
  try {
    normal.formula = std::make_shared<const numerics::Formula>(load.expression, parameters, true);
  } catch (const InvalidInput& error) {
    throw InvalidInput(load.where, fmt::format("{}: normal_load: {}", part, error.message()));
  }
  const double start = (*normal.formula)(0.0);
  if (!std::isfinite(start))
    throw InvalidInput(load.where, fmt::format("{}: normal_load is {} at t = 0 (from \"{}\"); give a formula that is "
                                               "finite",
                                               part, start, load.expression));
  return normal;
}

NormalForce build_normal_force(const SliderDescription& description, const ModelDescription& all, const Model& model,
                               const numerics::Parameters& parameters, const std::string& part) {
  if (follows_own_reaction(description))
    throw InvalidInput(description.normal_load.where,
                       fmt::format("{}: normal_load is the reaction of a joint, and the model has no [[joint]]; name a "
                                   "[[stop]] or a [[nonlinear_spring]] across it, with {{ law = \"NAME\" }}",
                                   part));
  if (description.normal_law.empty()) return build_normal_formula(description, parameters, part);
  NormalForce normal;
  const std::string& name = description.normal_law;
  normal.stop = place_of(model.stops, name);
  if (normal.stop < 0) normal.law = place_of(model.laws, name);
  if (normal.depends_on_motion()) return normal;
  if (place_of(all.contacts, name) >= 0)
    throw InvalidInput(
        description.normal_law_where,
        fmt::format("{}: normal_load names the contact \"{}\", and contacts cannot press a slider; name a "
                    "[[stop]] across it, or make the slider a [[contact]] of its own",
                    part, name));
  if (place_of(all.sliders, name) >= 0)
    throw InvalidInput(description.normal_law_where,
                       fmt::format("{}: the force of the slider \"{}\" rubs, it does not press; name a [[stop]] or a "
                                   "[[nonlinear_spring]] across it",
                                   part, name));
  std::vector<std::string> known;
  for (const Stop& stop : model.stops) known.push_back(stop.name);
  for (const LawBetween& law : model.laws) known.push_back(law.name);
  throw InvalidInput(
      description.normal_law_where,
      fmt::format("{}: normal_load names \"{}\", which is no stop and no law{}", part, name, suggestion(name, known)));
}

}  // namespace rubato::model
