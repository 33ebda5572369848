#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>

namespace rubato::io {
namespace {

using namespace model;

std::vector<Quantity> required_quantities(TomlReader& reader, const std::string& key) {
  if (!reader.has(key)) {
    reader.refuse_misspelling_of(key);
    throw InvalidInput(reader.where(), fmt::format("{} lacks the key \"{}\"", reader.what(), key));
  }
  return *reader.optional_quantities(key);
}

/// One number, or a list of them.
std::vector<Quantity> optional_one_or_more(TomlReader& reader, const std::string& key) {
  const toml::node* found = reader.node(key);
  if (!found) return {};
  if (found->is_array()) return *reader.optional_quantities(key);
  return {*reader.optional_quantity(key)};
}

NodeDescription read_node(TomlReader& reader) {
  NodeDescription node;
  node.name = reader.name("name", &node.where);
  reader.rename(fmt::format("node \"{}\"", node.name));
  node.position = required_quantities(reader, "position");
  node.velocity = reader.optional_quantities("velocity").value_or(std::vector<Quantity>{});
  node.velocity_where = reader.where("velocity");
  node.angular_velocity = optional_one_or_more(reader, "angular_velocity");
  node.angular_velocity_where = reader.where("angular_velocity");
  reader.finish();
  return node;
}

MaterialDescription read_material(TomlReader& reader) {
  MaterialDescription material;
  material.name = reader.name("name", &material.where);
  reader.rename(fmt::format("material \"{}\"", material.name));
  material.young = reader.quantity("young");
  material.poisson = reader.optional_quantity("poisson");
  material.shear_modulus = reader.optional_quantity("shear_modulus");
  material.density = reader.quantity("density");
  material.retardation_time = reader.optional_quantity("retardation_time");
  reader.finish();
  return material;
}

SectionDescription read_section(TomlReader& reader) {
  SectionDescription section;
  section.name = reader.name("name", &section.where);
  reader.rename(fmt::format("section \"{}\"", section.name));
  section.area = reader.quantity("area");
  section.inertia = optional_one_or_more(reader, "inertia");
  section.torsion = reader.optional_quantity("torsion");
  section.shear_factor = optional_one_or_more(reader, "shear_factor");
  reader.finish();
  return section;
}

void read_line(TomlReader& reader, const std::string& kind, LineDescription& line) {
  line.where = reader.where();
  line.name = reader.optional_text("name").value_or("");
  if (!line.name.empty()) reader.rename(fmt::format("{} \"{}\"", kind, line.name));
  line.nodes = reader.between("nodes", line.nodes_where);
  line.section = reader.name("section", &line.section_where);
  line.material = reader.name("material", &line.material_where);
  line.lumped_mass = reader.optional_word("mass", {"consistent", "lumped"}) == "lumped";
}

BeamDescription read_beam(TomlReader& reader) {
  BeamDescription beam;
  read_line(reader, "beam", beam);
  const auto formulation =
      reader.optional_word("formulation", {"timoshenko", "euler_bernoulli", "geometrically_exact"});
  if (formulation == "euler_bernoulli") beam.formulation = BeamDescription::Formulation::euler_bernoulli;
  if (formulation == "geometrically_exact") beam.formulation = BeamDescription::Formulation::geometrically_exact;
  // n of them bend by 1/(4 n^2) too little; the others are exact at their nodes under loads there.
  const bool is_exact = beam.formulation == BeamDescription::Formulation::geometrically_exact;
  const long elements = reader.optional_integer("elements").value_or(is_exact ? 8 : 1);
  if (elements < 1 || elements > 10'000'000)
    throw InvalidInput(reader.where("elements"),
                       fmt::format("{}: elements must be from 1 to 10 million, got {}", reader.what(), elements));
  beam.elements = static_cast<int>(elements);
  beam.orientation = reader.optional_quantities("orientation").value_or(std::vector<Quantity>{});
  beam.orientation_where = reader.where("orientation");
  if (auto release = reader.optional_table("release", fmt::format("{}: release", reader.what()))) {
    beam.release_where = release->where();
    beam.release[0] = release->optional_texts("first").value_or(std::vector<std::string>{});
    beam.release[1] = release->optional_texts("second").value_or(std::vector<std::string>{});
    release->finish();
  }
  reader.finish();
  return beam;
}

PointMassDescription read_mass(TomlReader& reader) {
  PointMassDescription mass;
  mass.where = reader.where();
  mass.node = reader.name("node", &mass.node_where);
  reader.rename(fmt::format("the mass on node \"{}\"", mass.node));
  mass.mass = reader.optional_quantity("mass");
  mass.inertia = optional_one_or_more(reader, "inertia");
  reader.finish();
  return mass;
}

SupportDescription read_support(TomlReader& reader) {
  SupportDescription support;
  support.where = reader.where();
  support.node = reader.name("node", &support.node_where);
  reader.rename(fmt::format("the support at node \"{}\"", support.node));
  const auto fix = reader.optional_texts("fix", &support.fix_where);
  if (!fix) {
    reader.refuse_misspelling_of("fix");
    throw InvalidInput(reader.where(), fmt::format("{} lacks the key \"fix\"", reader.what()));
  }
  support.fix = *fix;
  reader.finish();
  return support;
}

}  // namespace

void read_structure(TomlReader& root, const StudyFolder& folder, ModelDescription& model) {
  StructureDescription& structure = model.structure;
  for (TomlReader& reader : root.tables("node")) structure.nodes.push_back(read_node(reader));
  for (TomlReader& reader : root.tables("material")) structure.materials.push_back(read_material(reader));
  for (TomlReader& reader : root.tables("section")) structure.sections.push_back(read_section(reader));
  for (TomlReader& reader : root.tables("beam")) structure.beams.push_back(read_beam(reader));
  for (TomlReader& reader : root.tables("truss")) {
    structure.trusses.emplace_back();
    read_line(reader, "truss", structure.trusses.back());
    reader.finish();
  }
  read_mesh(root, folder, structure);
  for (TomlReader& reader : root.tables("mass")) structure.masses.push_back(read_mass(reader));
  for (TomlReader& reader : root.tables("support")) structure.supports.push_back(read_support(reader));
  if (auto reader = root.optional_table("gravity", "[gravity]")) {
    GravityDescription gravity;
    gravity.where = reader->where();
    gravity.acceleration = required_quantities(*reader, "acceleration");
    reader->finish();
    model.gravity = gravity;
  }
}

}  // namespace rubato::io
