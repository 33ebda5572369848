#include <rubato/model/beams/exact_beam_space.hpp>
#include <rubato/model/beams/geometrically_exact.hpp>
#include <rubato/model/build_structure.hpp>
#include <rubato/model/joints/plane_spring.hpp>
#include <rubato/model/mechanism_assembly.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::model {
namespace {

using numerics::Matrix3;
using numerics::Rotation;

constexpr std::array<std::size_t, 3> plane_axes{0, 1, 5};

struct Beam {
  Index first, second;  // nodes
  std::string name;
  double length;
  const LineProperties& properties;
};

Beam beam_of(const MechanismAssembly& assembly, const Structure& structure, const LineElement& element) {
  const Index first = element.first + 1, second = element.second + 1;  // after the ground
  const auto& nodes = assembly.mechanism.nodes;
  return {
      first, second,
      fmt::format("{}-{}", nodes[static_cast<std::size_t>(first)].name, nodes[static_cast<std::size_t>(second)].name),
      (assembly.position(second) - assembly.position(first)).norm(),
      structure.properties[static_cast<std::size_t>(element.properties)]};
}

/// The translations of a beam: a consistent mass is the same in every configuration.
void take_mass(MechanismAssembly& assembly, const Beam& beam, std::size_t axis, double mass) {
  auto& masses = assembly.mechanism.masses;
  const bool is_lumped = beam.properties.lumped_mass;
  const double same = is_lumped ? mass / 2.0 : mass / 3.0;
  masses.push_back({beam.first, beam.first, axis, axis, same});
  masses.push_back({beam.second, beam.second, axis, axis, same});
  if (!is_lumped) masses.push_back({beam.first, beam.second, axis, axis, mass / 6.0});
  if (axis == 0) assembly.mass += mass;
}

void take_plane_beam(MechanismAssembly& assembly, const Beam& beam) {
  Mechanism& mechanism = assembly.mechanism;
  const LineProperties& p = beam.properties;
  const auto at = [&](Index node) {
    const auto& numbers = mechanism.nodes[static_cast<std::size_t>(node)].numbers;
    return std::array<double, 3>{numbers[0], numbers[1], numbers[2]};
  };
  const PlaneNode first = mechanism.plane_node(beam.first), second = mechanism.plane_node(beam.second);
  const PlaneSection section{p.young * p.area, p.shear_modulus * p.shear_area_y, p.young * p.inertia_z};
  mechanism.elements.push_back(make_plane_beam(beam.name, first, second, at(beam.first), at(beam.second), section));
  if (p.retardation_time > 0.0)
    mechanism.elements.push_back(make_viscous_plane_beam(beam.name, first, second, at(beam.first), at(beam.second),
                                                         section, p.retardation_time));
  for (const std::size_t axis : plane_axes)
    take_mass(assembly, beam, axis, p.density * (axis == 5 ? p.inertia_z : p.area) * beam.length);
}

/// @param q        all numbers of all nodes
/// @param inertia  of the nodes, by their axes, to which half of the beam's goes on either side
void take_space_beam(MechanismAssembly& assembly, const Beam& beam, const Axis& orientation,
                     const std::vector<double>& q, std::vector<Matrix3>& inertia) {
  Mechanism& mechanism = assembly.mechanism;
  const LineProperties& p = beam.properties;
  const Matrix3 axes =
      local_axes(assembly.position(beam.second) - assembly.position(beam.first), orientation).transpose();
  const SpaceNode first = mechanism.space_node(beam.first), second = mechanism.space_node(beam.second);
  const SpaceBeamSection section{{p.young * p.area, p.shear_modulus * p.shear_area_y, p.shear_modulus * p.shear_area_z},
                                 {p.shear_modulus * p.torsion, p.young * p.inertia_y, p.young * p.inertia_z}};
  mechanism.elements.push_back(make_exact_beam_space(beam.name, first, second, q.data(), axes, axes, section));
  if (p.retardation_time > 0.0)
    mechanism.elements.push_back(
        make_viscous_beam_space(beam.name, first, second, q.data(), axes, axes, section, p.retardation_time));
  for (std::size_t axis = 0; axis < 3; ++axis) take_mass(assembly, beam, axis, p.density * p.area * beam.length);
  const Axis second_moments(p.inertia_y + p.inertia_z, p.inertia_y, p.inertia_z);
  const Matrix3 half = axes * (0.5 * p.density * beam.length * second_moments).asDiagonal() * axes.transpose();
  for (const Index node : {beam.first, beam.second}) inertia[static_cast<std::size_t>(node)] += half;
}

/// A single rotation held and two left free are no joint: the axis that would stay is neither that of the node nor that
/// of the world.
void refuse_one_fixed_rotation(const MechanismAssembly& assembly, const std::string& node,
                               const std::array<Index, 6>& places) {
  std::size_t fixed = 0, free = 0;
  for (std::size_t axis = 3; axis < 6; ++axis) {
    fixed += assembly.fixed.count(node + "." + axis_names[axis]);
    free += places[axis] != ground;
  }
  if (fixed != 1 || free != 2) return;
  for (const SupportDescription& support : assembly.description.structure.supports)
    if (support.node == node)
      throw InvalidInput(support.where,
                         fmt::format("the support at node \"{}\" fixes one rotation of three, which holds no axis once "
                                     "the node has turned; fix two or all, or take a [[joint]] of type \"universal\"",
                                     node));
}

void take_node(MechanismAssembly& assembly, const BuiltStructure& built, std::size_t i, Matrix3& inertia) {
  const Structure& structure = built.structure;
  Mechanism& mechanism = assembly.mechanism;
  const auto& places = structure.places[i];
  const Axis& at = structure.positions[i];
  const auto is_free = [&](std::size_t axis) { return places[axis] != ground; };
  Index node = 0;
  if (assembly.in_plane()) {
    node = mechanism.add_node(structure.names[i], {at[0], at[1], 0.0}, {is_free(0), is_free(1), is_free(5)});
  } else {
    refuse_one_fixed_rotation(assembly, structure.names[i], places);
    node = mechanism.add_space_node(structure.names[i], at, Rotation::Identity(),
                                    {is_free(0), is_free(1), is_free(2), is_free(3), is_free(4), is_free(5)});
  }
  assembly.nodes.emplace(structure.names[i], node);
  assembly.extend(at);
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!is_free(axis)) continue;
    const NodeCoordinate& coordinate = built.coordinates[static_cast<std::size_t>(places[axis])];
    mechanism.nodes[static_cast<std::size_t>(node)].velocity[axis] = coordinate.velocity;
    mechanism.nodes[static_cast<std::size_t>(node)].has_velocity[axis] = coordinate.has_velocity;
    const double mass = coordinate.mass;
    if (axis == 0) assembly.mass += mass;
    if (is_rotation(axis)) assembly.inertia += mass;
    if (!(mass > 0.0)) continue;
    if (assembly.in_plane() || !is_rotation(axis))
      mechanism.masses.push_back({node, node, axis, axis, mass});
    else
      inertia(static_cast<Index>(axis) - 3, static_cast<Index>(axis) - 3) += mass;
  }
}

std::array<NodeNumber, 2> ends_of(const MechanismAssembly& assembly, const Between& between,
                                  const std::array<Location, 2>& where, const std::string& part) {
  const char* remedy = "give a revolute joint \"stiffness\" or \"damping\"";
  return {number_of(assembly, between[0], where[0], part, remedy),
          number_of(assembly, between[1], where[1], part, remedy)};
}

}  // namespace

void take_structure(MechanismAssembly& assembly) {
  BuiltStructure built = build_structure(assembly.description.structure, assembly.parameters, 0);
  const Structure& structure = built.structure;
  assembly.fixed = std::move(built.fixed);
  Mechanism& mechanism = assembly.mechanism;
  std::vector<Matrix3> inertia(structure.names.size() + 1, Matrix3::Zero());
  for (std::size_t i = 0; i < structure.names.size(); ++i) take_node(assembly, built, i, inertia[i + 1]);
  const std::vector<double> q = mechanism.numbers();
  std::vector<std::size_t> first_of;  // of each beam element among the elements of the mechanism, and their end
  for (const LineElement& element : structure.elements) {
    first_of.push_back(mechanism.elements.size());
    const Beam beam = beam_of(assembly, structure, element);
    mechanism.drawing.lines.push_back({DrawnLine::Kind::beam, {beam.first, {}}, {beam.second, {}}});
    if (assembly.in_plane())
      take_plane_beam(assembly, beam);
    else
      take_space_beam(assembly, beam, element.orientation, q, inertia);
  }
  assembly.elements += structure.elements.size();
  first_of.push_back(mechanism.elements.size());
  for (const NamedLine& beam : built.beams)
    for (std::size_t i = 0; i < beam.count; ++i) {
      const std::size_t at = beam.first + i;
      mechanism.beam_parts.push_back(
          {beam.name, fmt::format("{}({})", beam.name, i + 1), first_of[at], first_of[at + 1] - first_of[at]});
    }
  if (assembly.in_plane()) return;
  for (std::size_t node = 1; node < inertia.size(); ++node)
    if (inertia[node] != Matrix3::Zero()) mechanism.add_space_inertia(static_cast<Index>(node), inertia[node]);
}

void take_springs(MechanismAssembly& assembly) {
  auto& elements = assembly.mechanism.elements;
  const auto value = [&](const NodeNumber& n) { return n.q < 0 ? 0.0 : assembly.start[static_cast<std::size_t>(n.q)]; };
  for (const SpringDescription& spring : assembly.description.springs) {
    const std::string part = fmt::format("the spring between \"{}\" and \"{}\"", spring.between[0], spring.between[1]);
    const auto [first, second] = ends_of(assembly, spring.between, spring.between_where, part);
    elements.push_back(make_coordinate_spring(part, first, second,
                                              assembly.at_least_zero(spring.stiffness, part + ": stiffness"),
                                              value(first) - value(second)));
  }
  for (const DamperDescription& damper : assembly.description.dampers) {
    const std::string part = fmt::format("the damper between \"{}\" and \"{}\"", damper.between[0], damper.between[1]);
    const auto [first, second] = ends_of(assembly, damper.between, damper.between_where, part);
    elements.push_back(
        make_coordinate_damper(part, first, second, assembly.at_least_zero(damper.damping, part + ": damping")));
  }
}

}  // namespace rubato::model
