#include <rubato/model/build_parts.hpp>
#include <rubato/model/mechanism_joint_laws.hpp>

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

namespace rubato::model {
namespace {

/// The node and axis that a coordinate is.
std::pair<Index, std::size_t> place_of(const Mechanism& mechanism, Index coordinate) {
  for (std::size_t node = 0; node < mechanism.nodes.size(); ++node)
    for (std::size_t axis = 0; axis < 6; ++axis)
      if (mechanism.nodes[node].place[axis] == coordinate) return {static_cast<Index>(node), axis};
  return {0, 0};
}

void take_following_force(MechanismAssembly& assembly, const ForceDescription& force, const std::string& part,
                          Index node, std::size_t axis, const TimeLaw& law) {
  Mechanism& mechanism = assembly.mechanism;
  const Axis at = force.at.empty() ? assembly.position(node) : assembly.point(force.at, force.at_where, part + ": at");
  if (assembly.in_plane()) {
    mechanism.add_following_force(part, mechanism.plane_point(node, at[0], at[1]), axis, law);
    return;
  }
  if (!assembly.has_axes(node))
    throw InvalidInput(force.follows_where,
                       fmt::format("{} follows a mass that does not turn; give its [[mass]] \"inertia\", or remove "
                                   "\"following\"",
                                   part));
  mechanism.add_following_force(part, mechanism.space_point(node, at), axis, law);
}

}  // namespace

MotionLaw drive_of(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                   bool is_angle, double value) {
  const DriveDescription& drive = *joint.motion;
  if (!joint.locks.empty())
    throw InvalidInput(joint.locks.front().where,
                       fmt::format("{} has a drive and a lock: what is driven cannot lock; leave one out, or drive it "
                                   "by a {}",
                                   part, is_angle ? "moment" : "force"));
  const std::string its_drive = part + ": drive";
  const auto* formula = std::get_if<TimeFormulaDescription>(&drive.law);
  MotionLaw law =
      formula
          ? MotionLaw(build_motion(*formula, assembly.parameters, its_drive))
          : MotionLaw(build_motion(std::get<TableDescription>(drive.law), assembly.parameters, its_drive, drive.where));
  const double start = derivatives(law, 0.0, Side::right).value;
  if (joint.type == JointDescription::Type::strut && !(start > 0.0))
    throw InvalidInput(drive.where, fmt::format("{}: the drive of a strut is its length and must be positive, got {} "
                                                "at the start",
                                                part, start));
  if (is_angle && !(std::abs(start - value) <= 2.0 * std::numbers::pi))
    throw InvalidInput(drive.where,
                       fmt::format("{}: the drive starts at {} rad, more than a turn away from the angle {} of the "
                                   "configuration given; if degrees are meant, write \"... * pi/180\"",
                                   part, start, value));
  return law;
}

void take_start_rate(MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                     const FreeCoordinate& s) {
  if (joint.motion)
    throw InvalidInput(joint.rate->where,
                       part + " has a drive and a rate: its drive says how it moves at the start; leave the rate out");
  assembly.mechanism.start_rates.push_back(
      {joint.name, s, assembly.number(*joint.rate, part + ": rate"), joint.rate->where});
}

CoordinateTable table_of(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                         double value) {
  const TableDescription& table = *joint.drive_table;
  for (std::size_t i = 1; i < table.times.size(); ++i)
    if (!(table.times[i] > table.times[i - 1]))
      throw InvalidInput(table.where, fmt::format("{}: the table \"{}\" jumps at {}; give its rows a way between", part,
                                                  table.file, table.times[i]));
  const auto beyond = table.beyond == TableDescription::Beyond::hold   ? CoordinateTable::Beyond::hold
                      : table.beyond == TableDescription::Beyond::zero ? CoordinateTable::Beyond::zero
                                                                       : CoordinateTable::Beyond::error;
  CoordinateTable law = make_table(table.times, table.values, beyond);
  if (beyond != CoordinateTable::Beyond::error) return law;
  // Up to a lock the rows need reach no further: what lies beyond is looked at, and not kept.
  for (const LockDescription& lock : joint.locks) {
    const double at = assembly.number(lock.at, part + ": lock: at");
    const bool is_above = lock.side ? *lock.side == LockDescription::Side::below : at > value;
    if (is_above && at <= law.at.back()) law.after = CoordinateTable::Beyond::hold;
    if (!is_above && at >= law.at.front()) law.before = CoordinateTable::Beyond::hold;
  }
  return law;
}

int take_friction(MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                  const FreeCoordinate& s, PressingRows pressing, double arm) {
  const FrictionDescription& given = *joint.friction;
  if (joint.motion)
    throw InvalidInput(given.where,
                       fmt::format("{} has a drive and friction: while the drive stands still nothing says "
                                   "what each of them holds; give the friction to another joint, or "
                                   "drive it by a {}",
                                   part, s.is_angle() ? "moment" : "force"));
  JointFriction friction;
  friction.name = joint.name;
  friction.s = s;
  if (pressing.count > 0) friction.joint = static_cast<int>(assembly.mechanism.joints.size()) - 1;
  friction.coefficient = assembly.at_least_zero(given.coefficient, part + ": friction: coefficient") * arm;
  friction.first_pressing_row = pressing.first;
  if (given.preload)
    friction.preload = assembly.at_least_zero(*given.preload, part + ": friction: preload");
  else if (pressing.count > 0)
    friction.pressing_rows = pressing.count;
  else
    throw InvalidInput(given.where,
                       fmt::format("{}: friction: it holds nothing, and no reaction presses on what slides; "
                                   "give \"preload\" [N]",
                                   part));
  return assembly.mechanism.add_friction(std::move(friction));
}

double rubbing_radius(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part) {
  const auto& radius = joint.friction->radius;
  return radius ? assembly.positive(*radius, part + ": friction: radius") : 1.0;
}

void take_force(MechanismAssembly& assembly, const ForceDescription& force) {
  const std::string part = fmt::format("the force on \"{}\"", force.on);
  Mechanism& mechanism = assembly.mechanism;
  const Index coordinate = assembly.free_coordinate(force.on, force.where, "a force is on");
  const TimeLaw law = build_time_law(force.law, assembly.parameters, part);
  const bool is_moment = mechanism.is_rotation[static_cast<std::size_t>(coordinate)] != 0;
  const bool stays = !force.follows && force.follows_where.line > 0;  // said, and not left out
  const auto [node, axis] = place_of(mechanism, coordinate);
  if (is_moment && !force.at.empty())
    throw InvalidInput(force.at_where, part + ": a moment has no point; remove \"at\"");
  // A moment of the plane is the same however its node turns, and coordinates of rotations turn with their node.
  if (is_moment && !assembly.in_plane() && stays)
    mechanism.add_fixed_moment(part, node, axis - 3, law);
  else if (!is_moment && force.follows)
    take_following_force(assembly, force, part, node, axis, law);
  else
    mechanism.forces.push_back({coordinate, law});
}

}  // namespace rubato::model
