#include <rubato/model/build_mechanism.hpp>
#include <rubato/model/build_parts.hpp>
#include <rubato/model/finite_elements/finite_elements.hpp>
#include <rubato/model/mechanism_assembly.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::model {
namespace {

[[noreturn]] void refuse(const Location& where, const std::string& part, const std::string& remedy) {
  throw InvalidInput(where, fmt::format("{} does not go with a mechanism (bodies, joints, geometrically exact beams); "
                                        "{}",
                                        part, remedy));
}

void refuse_foreign_parts(const ModelDescription& d) {
  if (d.matrices) refuse(d.matrices->where, "[matrices]", "describe the structure by nodes and beams");
  if (d.finite_elements) refuse(d.finite_elements->where, "[model]", "describe the structure by nodes and beams");
  if (!d.coordinates.empty())
    refuse(d.coordinates.front().where, "a [[coordinate]]", "take a [[node]] with a [[mass]]");
  if (d.base_motion) refuse(d.base_motion->where, "[base_motion]", "apply forces");
  if (!std::holds_alternative<std::monostate>(d.damping))
    refuse(where_of(d.damping), "[damping]",
           "give the [[material]] of its beams a \"retardation_time\" [s], or take a [[damper]]");
  if (!d.distributed_forces.empty())
    refuse(d.distributed_forces.front().where, "a [[distributed_force]]", "apply forces at nodes");
  if (!d.displacements.empty())
    refuse(d.displacements.front().where, "a [[displacement]]", "give the configuration from which to start");
  if (!d.prescribed.empty())
    refuse(d.prescribed.front().where, "a [[displacement]]", "drive a joint between the ground and the node");
  if (!d.held_forces.empty()) refuse(d.held_forces.front().where, "a held force", "give the force a law of t");
  if (!d.structure.trusses.empty())
    refuse(d.structure.trusses.front().where, "a [[truss]]",
           "take a joint of type \"distance\" or \"strut\", or a beam");
  for (const BeamDescription& beam : d.structure.beams)
    if (!beam.release[0].empty() || !beam.release[1].empty())
      refuse(beam.release_where, "\"release\" of a beam",
             "end the beam at a node of its own and join both nodes by a joint of type \"revolute\"");
  for (const BeamDescription& beam : d.structure.beams)
    if (beam.formulation != BeamDescription::Formulation::geometrically_exact)
      refuse(beam.where, fmt::format("the beam from \"{}\" to \"{}\"", beam.nodes[0], beam.nodes[1]),
             "its displacements must be small: take formulation = \"geometrically_exact\"");
}

/// Cardona and Cassano (1991), appendix A-1: three translations also in the plane; beams and links count as elements,
/// and where there are none bodies do.
double reference_of(const MechanismAssembly& assembly) {
  const std::size_t parts = assembly.elements > 0 ? assembly.elements : assembly.description.bodies.size();
  const double box = (assembly.high - assembly.low).norm();
  constexpr double turn = std::numbers::pi / 10.0;
  if (parts == 0 || !std::isfinite(box)) return 0.0;
  return std::sqrt(3.0 * assembly.mass * box * box / static_cast<double>(parts) + assembly.inertia * turn * turn);
}

}  // namespace

bool is_mechanism(const ModelDescription& description) {
  const auto& beams = description.structure.beams;
  return !description.bodies.empty() || !description.joints.empty() || !description.bushings.empty() ||
         !description.gears.empty() || std::any_of(beams.begin(), beams.end(), [](const BeamDescription& beam) {
           return beam.formulation == BeamDescription::Formulation::geometrically_exact;
         });
}

Mechanism build_mechanism(const ModelDescription& description, const numerics::Parameters& parameters) {
  refuse_parts_without_nodes(description);
  refuse_foreign_parts(description);
  MechanismAssembly assembly(description, parameters);
  Mechanism& mechanism = assembly.mechanism;
  if (!description.structure.is_empty()) take_structure(assembly);
  for (const BodyDescription& body : description.bodies) take_body(assembly, body);
  assembly.start = mechanism.numbers();
  for (const JointDescription& joint : description.joints)
    (assembly.in_plane() ? take_plane_joint : take_space_joint)(assembly, joint);
  for (const GearDescription& gear : description.gears) take_gear(assembly, gear);
  for (const BushingDescription& bushing : description.bushings) take_bushing(assembly, bushing);
  take_springs(assembly);
  take_local_laws(assembly);
  take_stops(assembly);
  take_sliders(assembly);
  take_contacts(assembly);
  for (const ForceDescription& force : description.forces) take_force(assembly, force);
  if (const auto& gravity = description.gravity)
    mechanism.gravity = assembly.point(gravity->acceleration, gravity->where, "[gravity]: acceleration");
  mechanism.reference = reference_of(assembly);
  return std::move(mechanism);
}

}  // namespace rubato::model
