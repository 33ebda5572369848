#include <rubato/model/doubtful_values.hpp>

#include <fmt/format.h>

namespace rubato::model {
namespace {

void take_friction(const Quantity& coefficient, const std::string& part, const numerics::Parameters& parameters,
                   std::vector<DoubtfulValue>& all) {
  constexpr double largest = 3.0;
  const double value = evaluate(coefficient, parameters, part);
  if (!(value > largest)) return;
  all.push_back({coefficient.where,
                 fmt::format("{} is {:.6g}, and dry materials have 0.05 to 1.5; is it in percent? (0.3 means 30 %)",
                             part, value)});
}

void take_material(const MaterialDescription& material, const numerics::Parameters& parameters,
                   std::vector<DoubtfulValue>& all) {
  constexpr double softest = 1e3, soft = 1e6, dense = 1500.0;
  const std::string part = fmt::format("material \"{}\": young", material.name);
  const double young = evaluate(material.young, parameters, part);
  const double density = evaluate(material.density, parameters, fmt::format("material \"{}\": density", material.name));
  if (!(young > 0.0 && (young < softest || (young < soft && density > dense)))) return;
  all.push_back(
      {material.young.where,
       fmt::format("{} is {:.6g} Pa, softer than gelatine; steel has 2.1e11 Pa: is it in GPa or MPa?", part, young)});
}

}  // namespace

std::vector<DoubtfulValue> doubtful_values(const ModelDescription& description,
                                           const numerics::Parameters& parameters) {
  std::vector<DoubtfulValue> all;
  for (const auto& slider : description.sliders)
    take_friction(slider.friction_coefficient, fmt::format("slider \"{}\": friction_coefficient", slider.name),
                  parameters, all);
  for (const ContactDescription& contact : description.contacts)
    if (contact.friction_coefficient)
      take_friction(*contact.friction_coefficient, fmt::format("contact \"{}\": friction_coefficient", contact.name),
                    parameters, all);
  for (const LawDescription& law : description.laws) {
    const LawKind& kind = law_kind(law.kind);
    if (const std::string why = kind.doubt ? kind.doubt(law, parameters) : ""; !why.empty())
      all.push_back({law.where, fmt::format("{} \"{}\": {}", law.kind, law.name, why)});
  }
  for (const auto& joint : description.joints)
    if (joint.friction)
      take_friction(joint.friction->coefficient, fmt::format("joint \"{}\": coefficient of friction", joint.name),
                    parameters, all);
  for (const auto& material : description.structure.materials) take_material(material, parameters, all);
  return all;
}

}  // namespace rubato::model
