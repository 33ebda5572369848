#include <rubato/model/doubtful_values.hpp>
#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/model/friction_coefficient.hpp>
#include <rubato/model/structure.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rubato::model {
namespace {

void take_friction(const Quantity& coefficient, const std::string& part, const numerics::Parameters& parameters,
                   std::vector<DoubtfulValue>& all) {
  constexpr double largest = 3.0;
  if (depends_on_rate(coefficient)) return;
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

/// Whether a study accelerates all nodes along x, y and z.
std::array<bool, 3> accelerated(const ModelDescription& description, const numerics::Parameters& parameters) {
  std::array<bool, 3> axes{};
  if (description.gravity)
    for (std::size_t i = 0; i < std::min<std::size_t>(3, description.gravity->acceleration.size()); ++i)
      axes[i] |= evaluate(description.gravity->acceleration[i], parameters, "[gravity]: acceleration") != 0.0;
  if (description.base_motion)
    for (const auto& [name, value] : description.base_motion->direction)
      for (std::size_t i = 0; i < 3; ++i)
        axes[i] |= name == axis_names[i] && evaluate(value, parameters, "[base_motion]: direction") != 0.0;
  return axes;
}

/// What accelerates all nodes alike pushes a free node by its share of the mass of the held ones beside it too, and no
/// file tells that share where the rows of held nodes are absent.
void take_inertia_of_held(const ModelDescription& description, const numerics::Parameters& parameters,
                          std::vector<DoubtfulValue>& all) {
  const auto& elements = description.finite_elements;
  if (!elements || (!description.gravity && !description.base_motion)) return;
  const bool is_lumped = elements->mass.values.nonZeros() == elements->mass.values.rows();
  if (is_lumped) return;
  const std::array<bool, 3> axes = accelerated(description, parameters);
  std::size_t count = 0;
  std::int64_t first = 0;
  for (std::size_t node = 0; node < elements->nodes.size(); ++node) {
    bool is_pushed = false;
    for (std::size_t i = 0; i < 3; ++i) is_pushed |= axes[i] && elements->freedoms[node][i] == Freedom::held;
    if (is_pushed && ++count == 1) first = elements->nodes[node];
  }
  if (count == 0) return;
  all.push_back(
      {description.gravity ? description.gravity->where : description.base_motion->where,
       fmt::format("{} leaves out what the elements at held nodes would add: the share of {} node{}, the first {}, in "
                   "the consistent mass is not in \"{}\"; to have it, export the matrices without the boundary "
                   "condition, and hold the nodes by a [[support]]",
                   description.gravity ? "[gravity]" : "[base_motion]", count, count == 1 ? "" : "s", first,
                   elements->mass.file)});
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
  take_inertia_of_held(description, parameters, all);
  return all;
}

}  // namespace rubato::model
