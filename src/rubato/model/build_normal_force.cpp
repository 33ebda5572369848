#include <rubato/model/build_parts.hpp>
#include <rubato/model/friction_coefficient.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

template <class Parts>
Index place_of(const Parts& parts, const std::string& name) {
  const auto found = std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.name == name; });
  return found == parts.end() ? -1 : static_cast<Index>(found - parts.begin());
}

}  // namespace

bool has_constant_load(const SliderDescription& slider) {
  return slider.normal_law.empty() && !follows_own_reaction(slider) && !names(slider.normal_load.expression, "t");
}

bool SliderDescription::is_law() const { return !has_constant_load(*this) || depends_on_rate(friction_coefficient); }

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
