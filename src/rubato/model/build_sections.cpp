#include <rubato/model/build_parts.hpp>
#include <rubato/model/build_sections.hpp>

#include <fmt/format.h>

namespace rubato::model {
namespace {

using numerics::Parameters;

double shear_factor(const Quantity& quantity, const Parameters& parameters, const std::string& part) {
  const double value = positive(quantity, parameters, part + "shear_factor");
  if (!(value <= 1.0))
    throw InvalidInput(quantity.where, fmt::format("{}shear_factor is the shear area over the area and cannot exceed "
                                                   "1, got {}",
                                                   part, value));
  return value;
}

Material build_material(const MaterialDescription& material, const Parameters& parameters) {
  const std::string part = fmt::format("material \"{}\": ", material.name);
  Material values;
  values.young = positive(material.young, parameters, part + "young");
  values.density = positive(material.density, parameters, part + "density");
  if (material.retardation_time)
    values.retardation_time = at_least_zero(*material.retardation_time, parameters, part + "retardation_time");
  if (material.poisson && material.shear_modulus)
    throw InvalidInput(material.shear_modulus->where,
                       part + "\"poisson\" and \"shear_modulus\" say the same; keep one");
  if (material.shear_modulus)
    values.shear_modulus = positive(*material.shear_modulus, parameters, part + "shear_modulus");
  if (material.poisson) {
    const double nu = evaluate(*material.poisson, parameters, part + "poisson");
    if (!(nu > -1.0 && nu <= 0.5))
      throw InvalidInput(material.poisson->where, fmt::format("{}poisson must lie in (-1, 0.5], got {}", part, nu));
    values.shear_modulus = values.young / (2.0 * (1.0 + nu));
  }
  return values;
}

Section build_section(const SectionDescription& section, bool in_plane, const Parameters& parameters) {
  const std::string part = fmt::format("section \"{}\": ", section.name);
  Section values;
  values.area = positive(section.area, parameters, part + "area");
  const std::size_t wanted = in_plane ? 1 : 2;
  if (!section.inertia.empty() && section.inertia.size() != wanted)
    throw InvalidInput(
        section.where,
        fmt::format("{}inertia takes {}, got {}", part,
                    in_plane ? "one number in the plane" : "two numbers in space, [Iy, Iz]", section.inertia.size()));
  if (!section.inertia.empty()) {
    values.inertia_z = positive(section.inertia.back(), parameters, part + "inertia");
    values.inertia_y = positive(section.inertia.front(), parameters, part + "inertia");
  }
  if (section.torsion) {
    if (in_plane) throw InvalidInput(section.torsion->where, part + "torsion is for models in space; remove the key");
    values.torsion = positive(*section.torsion, parameters, part + "torsion");
  }
  if (section.shear_factor.size() > wanted)
    throw InvalidInput(section.where, fmt::format("{}shear_factor takes {}, got {}", part,
                                                  in_plane ? "one number in the plane"
                                                           : "one number, or two in space, [along y, along z]",
                                                  section.shear_factor.size()));
  if (!section.shear_factor.empty()) {
    values.shear_factor_y = shear_factor(section.shear_factor.front(), parameters, part);
    values.shear_factor_z = shear_factor(section.shear_factor.back(), parameters, part);
  }
  return values;
}

}  // namespace

double positive(const Quantity& quantity, const Parameters& parameters, const std::string& what) {
  const double value = evaluate(quantity, parameters, what);
  if (!(value > 0.0)) throw InvalidInput(quantity.where, fmt::format("{} must be positive, got {}", what, value));
  return value;
}

ByName<Material> build_materials(const std::vector<MaterialDescription>& materials, const Parameters& parameters) {
  ByName<Material> built{"material"};
  for (const MaterialDescription& material : materials)
    built.add(material.name, material.where, build_material(material, parameters));
  return built;
}

ByName<Section> build_sections(const std::vector<SectionDescription>& sections, bool in_plane,
                               const Parameters& parameters) {
  ByName<Section> built{"section"};
  for (const SectionDescription& section : sections)
    built.add(section.name, section.where, build_section(section, in_plane, parameters));
  return built;
}

}  // namespace rubato::model
