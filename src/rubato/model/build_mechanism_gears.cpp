#include <rubato/model/build_structure.hpp>
#include <rubato/model/joints/gear_joint.hpp>
#include <rubato/model/joints/joint_kinds.hpp>
#include <rubato/model/mechanism_assembly.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

// Ratios between the coordinates of joints.
namespace rubato::model {
namespace {

/// The one coordinate that a joint leaves free; of a screw its angle.
FreeCoordinate coordinate_of(const MechanismAssembly& assembly, const GearDescription& gear, std::size_t side,
                             const std::string& part) {
  const auto& joints = assembly.description.joints;
  const std::string& name = gear.joints[side];
  const auto is_called_so = [&](const auto& joint) { return joint.name == name; };
  const auto joint = std::find_if(joints.begin(), joints.end(), is_called_so);
  if (joint == joints.end())
    throw InvalidInput(gear.joints_where[side], fmt::format("{} joins \"{}\", which is no joint{}", part, name,
                                                            suggestion(name, assembly.joint_names)));
  if (joint_kind(joint->type).free_coordinates == 1) {
    const Mechanism& mechanism = assembly.mechanism;
    const auto& in_plane = mechanism.joint_coordinates;
    if (const auto s = std::find_if(in_plane.begin(), in_plane.end(), is_called_so); s != in_plane.end()) return s->s;
    const auto& in_space = mechanism.space_coordinates;
    if (const auto s = std::find_if(in_space.begin(), in_space.end(), is_called_so); s != in_space.end()) return s->s;
  }
  throw InvalidInput(
      gear.joints_where[side],
      fmt::format("{} joins the joint \"{}\", which does not leave one coordinate free; take revolute or "
                  "prismatic joints, screws or struts",
                  part, name));
}

}  // namespace

void take_gear(MechanismAssembly& assembly, const GearDescription& gear) {
  const std::string part = fmt::format("gear \"{}\"", gear.name);
  refuse_unfit_name(gear.name, gear.where);
  auto& names = assembly.joint_names;
  if (std::find(names.begin(), names.end(), gear.name) != names.end())
    throw InvalidInput(gear.where, fmt::format("{} has the name of a joint or another gear", part));
  if (gear.joints[0] == gear.joints[1])
    throw InvalidInput(gear.joints_where[1], fmt::format("{} joins \"{}\" with itself", part, gear.joints[1]));
  const FreeCoordinate first = coordinate_of(assembly, gear, 0, part), second = coordinate_of(assembly, gear, 1, part);
  const double ratio = assembly.number(gear.ratio, part + ": ratio");
  if (!(std::abs(ratio) > 0.0))
    throw InvalidInput(
        gear.ratio.where,
        fmt::format("{}: a ratio of 0 would hold \"{}\" in its place; take a joint that does", part, gear.joints[0]));
  // Of two drives, or of one that a rigid lock stops, one says too much.
  std::vector<std::string> driven;
  for (const JointDescription& joint : assembly.description.joints)
    if (joint.motion && (joint.name == gear.joints[0] || joint.name == gear.joints[1])) driven.push_back(joint.name);
  if (driven.size() == 2)
    throw InvalidInput(gear.where, fmt::format("{} joins two joints that are driven, \"{}\" and \"{}\"; leave out one "
                                               "of the drives, or the gear",
                                               part, driven[0], driven[1]));
  for (const JointDescription& joint : assembly.description.joints)
    if (!driven.empty() && joint.name != driven.front() && !joint.locks.empty() &&
        (joint.name == gear.joints[0] || joint.name == gear.joints[1]))
      throw InvalidInput(joint.locks.front().where,
                         fmt::format("{} joins \"{}\", which is driven, with \"{}\", which has a lock: what is driven "
                                     "cannot lock; leave one of them out",
                                     part, driven.front(), joint.name));
  names.push_back(gear.name);
  const double* const q = assembly.start.data();
  assembly.mechanism.joints.push_back(
      make_gear(gear.name, first, second, ratio, first.value(q) - ratio * second.value(q)));
}

}  // namespace rubato::model
