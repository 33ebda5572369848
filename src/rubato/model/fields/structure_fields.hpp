#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/fields/key.hpp>

// The keys of nodes, materials, sections, beams, trusses, masses and supports, and of the files of meshes.
namespace rubato::model {

void fields(auto& visit, Like<NodeDescription> auto& node) {
  visit.name("name", node.name, node.where,
             {.required = true,
              .says = "its degrees of freedom are NAME.x, .y, .z, .rx, .ry, .rz (in the plane .x, .y, .rz)"});
  visit.title("node", node.name);
  visit.quantities("position", node.position, {2, 3},
                   {.required = true, .unit = "m", .says = "two numbers in the plane, three in space"});
  visit.quantities(
      "velocity", node.velocity, {2, 3},
      {.unit = "m/s", .says = "at the start: two numbers in the plane, three in space", .unless = "at rest"});
  visit.where(node.velocity_where, "velocity");
  visit.one_or_more(
      "angular_velocity", node.angular_velocity, {1, 3},
      {.unit = "rad/s", .says = "at the start: about z in the plane; about x, y and z in space", .unless = "at rest"});
  visit.where(node.angular_velocity_where, "angular_velocity");
}

void fields(auto& visit, Like<MaterialDescription> auto& material) {
  visit.name("name", material.name, material.where, {.required = true, .says = "named by beams and trusses"});
  visit.title("material", material.name);
  visit.quantity("young", material.young, {.required = true, .unit = "Pa", .says = "E", .range = Range::positive});
  visit.quantity("poisson", material.poisson, {.unit = "-", .says = "nu; gives the shear modulus"});
  visit.quantity("shear_modulus", material.shear_modulus, {.unit = "Pa", .says = "G, instead of poisson"});
  visit.quantity("density", material.density, {.required = true, .unit = "kg/m3", .range = Range::positive});
  visit.quantity("retardation_time", material.retardation_time,
                 {.unit = "s",
                  .says = "tau: stress = E (strain + tau strain rate), and so in shear",
                  .unless = "0",
                  .range = Range::not_negative});
  visit.excludes("poisson", "shear_modulus");
}

void fields(auto& visit, Like<SectionDescription> auto& section) {
  visit.name("name", section.name, section.where, {.required = true, .says = "named by beams and trusses"});
  visit.title("section", section.name);
  visit.quantity("area", section.area, {.required = true, .unit = "m2", .range = Range::positive});
  visit.one_or_more("inertia", section.inertia, {1, 2},
                    {.unit = "m4", .says = "second moment of area; in space [Iy, Iz]"});
  visit.quantity("torsion", section.torsion, {.unit = "m4", .says = "torsion constant, in space"});
  visit.one_or_more(
      "shear_factor", section.shear_factor, {1, 2},
      {.unit = "-", .says = "shear area over area, 5/6 for a rectangle; in space one number, or [along y, along z]"});
}

/// What beams and trusses share.
/// @param kind  for messages
void line_fields(auto& visit, const char* kind, auto& line) {
  visit.where(line.where);
  visit.text("name", line.name, {.says = "for messages, loads and the nodes within", .unless = "FIRST-SECOND"});
  if (!line.name.empty()) visit.title(kind, line.name);
  visit.between("nodes", line.nodes, line.nodes_where, {.required = true, .says = "from one node to another"});
  visit.name("section", line.section, line.section_where, {.required = true, .says = "a [[section]]"});
  visit.name("material", line.material, line.material_where, {.required = true, .says = "a [[material]]"});
  visit.word("mass", line.lumped_mass, {{"consistent", false}, {"lumped", true}},
             {.says = "mass matrix", .unless = "consistent"});
}

/// In space, of beams and of files of beams.
inline constexpr Key orientation_key{.says = "in space: a vector in the local x-y plane", .unless = "vertical"};

void fields(auto& visit, Like<BeamDescription> auto& beam) {
  using Formulation = BeamDescription::Formulation;
  line_fields(visit, "beam", beam);
  visit.word("formulation", beam.formulation,
             {{"timoshenko", Formulation::timoshenko},
              {"euler_bernoulli", Formulation::euler_bernoulli},
              {"geometrically_exact", Formulation::geometrically_exact}},
             {.says = "with shear, without, or with shear and large motions (a mechanism)", .unless = "timoshenko"});
  // n of them bend by 1/(4 n^2) too little; the others are exact at their nodes under loads there.
  const bool is_exact = beam.formulation == Formulation::geometrically_exact;
  visit.whole(
      "elements", beam.elements, is_exact ? 8 : 1, {1, 10'000'000, "from 1 to 10 million"},
      {.says = "equal parts; nodes within are NAME:1, NAME:2, ...", .unless = "1, of geometrically exact beams 8"});
  visit.quantities("orientation", beam.orientation, {3, 3}, orientation_key);
  visit.where(beam.orientation_where, "orientation");
  const std::vector<const char*> freedoms{"x", "y", "z", "rx", "ry", "rz"};
  visit.part("release", {.says = "what its ends do not share with their nodes, in the beam's own axes: rz is a hinge"},
             [&](auto& inner) {
               inner.where(beam.release_where);
               inner.names("first", beam.release[0], nullptr, freedoms, {.says = "of the first end"});
               inner.names("second", beam.release[1], nullptr, freedoms, {.says = "of the second end"});
               inner.some_of({"first", "second"});
             });
}

void fields(auto& visit, Like<TrussDescription> auto& truss) { line_fields(visit, "truss", truss); }

void fields(auto& visit, Like<PointMassDescription> auto& mass) {
  visit.where(mass.where);
  visit.name("node", mass.node, mass.node_where, {.required = true, .says = "a [[node]]"});
  visit.title("the mass on node", mass.node);
  visit.quantity("mass", mass.mass, {.unit = "kg", .range = Range::positive});
  visit.one_or_more("inertia", mass.inertia, {1, 3},
                    {.unit = "kg m2", .says = "about z in the plane; about x, y and z in space"});
  visit.some_of({"mass", "inertia"});
}

void fields(auto& visit, Like<SupportDescription> auto& support) {
  visit.where(support.where);
  visit.name("node", support.node, support.node_where, {.required = true, .says = "a [[node]]"});
  visit.title("the support at node", support.node);
  visit.names("fix", support.fix, &support.fix_where, {"x", "y", "z", "rx", "ry", "rz"},
              {.required = true, .says = "which degrees of freedom do not move"});
}

void fields(auto& visit, Like<MatricesDescription> auto& matrices) {
  visit.where(matrices.where);
  visit.matrix("mass", matrices.mass, {.required = true, .unit = "kg", .says = "Matrix Market file"});
  visit.matrix("damping", matrices.damping, {.unit = "N s/m", .says = "Matrix Market file"});
  visit.matrix("stiffness", matrices.stiffness, {.required = true, .unit = "N/m", .says = "Matrix Market file"});
  visit.names("names", matrices.names, &matrices.names_where, {},
              {.says = "of the coordinates; numbers serve beside them", .unless = "1, 2, ..."});
  visit.by_name("position", matrices.position, {.unit = "m", .says = "at the start, where not zero"});
  visit.by_name("velocity", matrices.velocity, {.unit = "m/s", .says = "at the start, where not zero"});
}

/// [nodes]: nodes from a CSV file.
struct NodeFileDescription {
  std::string file;
  Location file_where;
};

/// [beams]: beams from a CSV file, with what all of them share.
struct BeamFileDescription {
  BeamDescription common;
  std::string file;
  Location file_where;
};

void fields(auto& visit, Like<NodeFileDescription> auto& nodes) {
  visit.text("file", nodes.file,
             {.required = true, .says = "CSV: a header with name, x, y and in space z; a row a node"});
  visit.where(nodes.file_where, "file");
}

void fields(auto& visit, Like<BeamFileDescription> auto& beams) {
  using Formulation = BeamDescription::Formulation;
  auto& common = beams.common;
  visit.name("section", common.section, common.section_where, {.says = "a [[section]], of rows that name none"});
  visit.name("material", common.material, common.material_where, {.says = "a [[material]], of rows that name none"});
  visit.word("mass", common.lumped_mass, {{"consistent", false}, {"lumped", true}},
             {.says = "mass matrix", .unless = "consistent"});
  visit.word("formulation", common.formulation,
             {{"timoshenko", Formulation::timoshenko}, {"euler_bernoulli", Formulation::euler_bernoulli}},
             {.says = "with shear or without", .unless = "timoshenko"});
  visit.quantities("orientation", common.orientation, {3, 3}, orientation_key);
  visit.where(common.orientation_where, "orientation");
  visit.text("file", beams.file,
             {.required = true,
              .says = "CSV: a header with first, second, and optionally name, section, material; a row a beam"});
  visit.where(beams.file_where, "file");
}

}  // namespace rubato::model
