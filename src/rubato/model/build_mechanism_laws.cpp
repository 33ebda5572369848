#include <rubato/model/build_structure.hpp>
#include <rubato/model/joints/joint_kinds.hpp>
#include <rubato/model/mechanism_assembly.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::model {
namespace {

void refuse_taken_name(const MechanismAssembly& assembly, const LawDescription& law, const std::string& part) {
  if (law.name.empty()) throw InvalidInput(law.where, fmt::format("{} needs a name", law_kind(law.kind).title));
  refuse_unfit_name(law.name, law.where);
  const Mechanism& mechanism = assembly.mechanism;
  const auto is_called_so = [&](const auto& other) { return other.name == law.name; };
  if (std::any_of(mechanism.laws.begin(), mechanism.laws.end(), is_called_so))
    throw InvalidInput(law.where, fmt::format("two laws are called \"{}\"", law.name));
  const auto is_among = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), law.name) != names.end();
  };
  if (is_among(assembly.joint_names) || is_among(mechanism.coordinates) || assembly.fixed.count(law.name) > 0)
    throw InvalidInput(law.where,
                       fmt::format("{} has the name of a joint or a coordinate; results would mix them up", part));
}

/// The coordinate that a joint leaves free, with its zero.
LawCoordinate coordinate_of_joint(const MechanismAssembly& assembly, const LawDescription& law,
                                  const std::string& part) {
  const auto& joints = assembly.description.joints;
  const auto is_called_so = [&](const auto& joint) { return joint.name == law.joint; };
  const auto joint = std::find_if(joints.begin(), joints.end(), is_called_so);
  if (joint == joints.end())
    throw InvalidInput(law.joint_where, fmt::format("{} acts on \"{}\", which is no joint{}", part, law.joint,
                                                    suggestion(law.joint, assembly.joint_names)));
  const int free = joint_kind(joint->type).free_coordinates;
  if (free == 1) {
    // Of a screw its angle, which comes first.
    const Mechanism& mechanism = assembly.mechanism;
    const auto& in_plane = mechanism.joint_coordinates;
    if (const auto s = std::find_if(in_plane.begin(), in_plane.end(), is_called_so); s != in_plane.end()) return s->s;
    const auto& in_space = mechanism.space_coordinates;
    if (const auto s = std::find_if(in_space.begin(), in_space.end(), is_called_so); s != in_space.end()) return s->s;
  }
  const bool leaves_several = free > 1;
  throw InvalidInput(
      law.joint_where,
      fmt::format("{} acts on the joint \"{}\", which leaves {}; {}", part, law.joint,
                  leaves_several ? "more than one coordinate free" : "no coordinate free",
                  leaves_several
                      ? "build it of revolute and prismatic joints with small bodies between them, or take a "
                        "joint of type \"strut\" between two points"
                      : "take a revolute or a prismatic joint, a screw or a strut"));
}

NumberDifference difference_of(const MechanismAssembly& assembly, const LawDescription& law, const std::string& part) {
  const auto end = [&](std::size_t i) -> NodeNumber {
    if (assembly.fixed.count(law.between[i]) > 0) return {};
    return number_of(assembly, law.between[i], law.between_where[i], part,
                     "let the law act on a revolute joint, with joint = \"NAME\"");
  };
  NumberDifference u;
  u.first = end(0);
  u.second = end(1);
  if (law.between[0] == law.between[1])
    throw InvalidInput(law.between_where[1], fmt::format("{} joins \"{}\" with itself", part, law.between[1]));
  if (u.first.place == u.second.place)
    throw InvalidInput(law.between_where[1], fmt::format("{} joins \"{}\" with \"{}\", and neither moves", part,
                                                         law.between[0], law.between[1]));
  const auto turns = [&](const NodeNumber& number) {
    return assembly.mechanism.is_rotation[static_cast<std::size_t>(number.place)] != 0;
  };
  if (u.first.place != ground && u.second.place != ground && turns(u.first) != turns(u.second))
    throw InvalidInput(law.between_where[1], fmt::format("{} joins a displacement [m] and a rotation [rad]", part));
  u.is_rotation = turns(u.first.place != ground ? u.first : u.second);
  u.zero = u.value(assembly.start.data());
  return u;
}

}  // namespace

void take_local_laws(MechanismAssembly& assembly) {
  for (const LawDescription& description : assembly.description.laws) {
    const LawKind& kind = law_kind(description.kind);
    const std::string part = fmt::format("{} \"{}\"", description.kind, description.name);
    refuse_taken_name(assembly, description, part);
    if (!description.shares.empty())
      throw InvalidInput(description.shares_where,
                         fmt::format("{}: shares are of the coordinates of structures, and this model has joints or "
                                     "bodies; take `between` or `joint`",
                                     part));
    LawCoordinate u;
    if (description.joint.empty())
      u = difference_of(assembly, description, part);
    else
      u = coordinate_of_joint(assembly, description, part);
    assembly.mechanism.add_law(description.name, description.kind, u,
                               kind.make(description, assembly.parameters, part));
  }
}

}  // namespace rubato::model
