#include <rubato/model/joints/joint_kinds.hpp>
#include <rubato/model/joints/space_coordinate.hpp>
#include <rubato/model/joints/space_joints.hpp>
#include <rubato/model/mechanism_joint_laws.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace rubato::model {
namespace {

using Type = JointDescription::Type;
using numerics::Matrix3;

/// The joint on its way: its frames, which are the same in the world in the configuration given.
struct SpaceJointPlaces {
  std::string part;
  JointPlaces places;
  SpaceFrame first, second;
};

/// A node that does not turn has no axes with which a joint could do more than hold its place.
void require_axes(const MechanismAssembly& assembly, const JointDescription& joint, const SpaceJointPlaces& built) {
  const bool holds_points_only =
      joint.type == Type::spherical || joint.type == Type::distance || joint.type == Type::strut;
  for (std::size_t end = 0; end < 2; ++end) {
    const Index node = built.places.node[end];
    if (assembly.has_axes(node)) continue;
    const bool is_at_node = built.places.at[end] == assembly.position(node);
    if (holds_points_only && is_at_node) continue;
    throw InvalidInput(
        joint.between_where[end],
        fmt::format("{} joins \"{}\", a mass that does not turn, by more than its place; give its "
                    "[[mass]] \"inertia\", or take a spherical or distance joint, or a strut, at the node itself",
                    built.part, joint.between[end]));
  }
}

SpaceFrame frame_with(const SpaceNode& node, const double* q, const Axis& at, const Matrix3& axes) {
  SpaceFrame frame = frame_at(node, q, at, Axis::UnitZ());
  frame.axes = node.rotation(q).toRotationMatrix().transpose() * axes;
  return frame;
}

/// x along the axis that belongs to the first part, y along that of the second.
Matrix3 axes_of_universal(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part) {
  require_axis(joint, part);
  const Axis x = assembly.direction(joint.axis, joint.axis_where, part, "axis");
  if (joint.second_axis.empty())
    throw InvalidInput(joint.where, part +
                                        " lacks the key \"second_axis\": the axis that belongs to its second part, "
                                        "at a right angle to \"axis\"");
  const Axis y = assembly.direction(joint.second_axis, joint.second_axis_where, part, "second_axis");
  if (!(std::abs(x.dot(y)) <= 1e-6))
    throw InvalidInput(joint.second_axis_where,
                       fmt::format("{}: the axes of a universal joint are at a right angle in the configuration given; "
                                   "these are at {:.4g} rad",
                                   part, std::acos(std::clamp(x.dot(y), -1.0, 1.0))));
  Matrix3 axes;
  const Axis z = x.cross(y).normalized();
  axes << x, z.cross(x), z;
  return axes;
}

/// A body reaches from its centre of mass to its joints.
DrawnPoint draw(Mechanism& mechanism, const SpacePoint& point) {
  const Index node = point.node.q / space_numbers;
  const DrawnPoint end{node, {point.offset[0], point.offset[1], point.offset[2]}};
  if (node != 0 && point.offset != Axis::Zero())
    mechanism.drawing.lines.push_back({DrawnLine::Kind::body, {node, {}}, end});
  return end;
}

/// In the axes of the first node.
std::array<double, 3> drawn_axis(Type type, const Matrix3& axes) {
  if (!joint_kind(type).takes("axis")) return {};
  const Axis axis = axes.col(type == Type::universal ? 0 : 2);
  return {axis[0], axis[1], axis[2]};
}

SpaceCoordinate angle_between(MechanismAssembly& assembly, const SpaceFrame& first, const SpaceFrame& second,
                              const TurnAngle& angle) {
  const Index counter = assembly.mechanism.add_turn_counter({first.point, second.point, angle});
  assembly.start.push_back(0.0);
  return {SpaceCoordinate::Kind::angle, first.point, second.point, angle, counter, 0.0};
}

/// @param axis  of the first frame
SpaceCoordinate way_between(const SpaceFrame& first, const SpaceFrame& second, Index axis) {
  return {SpaceCoordinate::Kind::displacement, first.point, second.point, BodyGap{first.axes.col(axis)}, -1, 0.0};
}

/// All of the force of a hinge presses on its pin; of a slide what is across its way; of a screw the thread alone,
/// whose flanks are square: N = |multiplier|/cos(a), with a the lead angle, makes the moment mu N radius/cos(a).
/// @param lead  of a screw
void take_space_friction(MechanismAssembly& assembly, const JointDescription& joint, const SpaceJointPlaces& built,
                         const SpaceCoordinate& s, double lead) {
  const double radius = rubbing_radius(assembly, joint, built.part);
  if (joint.type != Type::screw) {
    const int pressing = s.kind == SpaceCoordinate::Kind::length ? 0 : s.is_angle() ? 3 : 2;
    take_friction(assembly, joint, built.part, s, {0, pressing}, radius);
    return;
  }
  const SpaceCoordinate path = path_along_thread(s, built.first.axes.col(2), lead, radius);
  take_friction(assembly, joint, built.part, path, {screw_thread_row, 1}, radius / path.share);
}

/// Adds a coordinate to the results, with the laws of the joint where they are its own.
void take_coordinate(MechanismAssembly& assembly, const JointDescription& joint, const SpaceJointPlaces& built,
                     SpaceCoordinate s, bool has_laws, double lead) {
  Mechanism& mechanism = assembly.mechanism;
  const bool is_length = s.kind == SpaceCoordinate::Kind::length;
  const double now = s.value(assembly.start.data());
  const double value = is_length ? now : has_laws ? start_value(assembly, joint, built.part, s.is_angle()) : 0.0;
  s.zero = now - value;
  mechanism.space_coordinates.push_back({joint.name, s});
  if (joint.friction && has_laws) take_space_friction(assembly, joint, built, s, lead);
  if (has_laws) take_laws(assembly, joint, built.part, s, value, take_locks(assembly, joint, built.part, s, value));
}

/// Of a cylindrical joint: along and around the axis together, against the slip of the pin's surface.
void take_collar_friction(MechanismAssembly& assembly, const JointDescription& joint, const SpaceJointPlaces& built,
                          const SpaceCoordinate& way, const SpaceCoordinate& angle) {
  const int along = take_friction(assembly, joint, built.part, way, {0, 2}, 1.0);
  assembly.mechanism.add_shared_friction(along, angle, rubbing_radius(assembly, joint, built.part));
}

/// Of a planar joint: its point rubs like a small foot, against its slip in both directions together.
void take_foot_friction(MechanismAssembly& assembly, const JointDescription& joint, const SpaceJointPlaces& built) {
  const auto& [part, places, first, second] = built;
  const int along = take_friction(assembly, joint, part, way_between(first, second, 0), {0, 1}, 1.0);
  assembly.mechanism.add_shared_friction(along, way_between(first, second, 1), 1.0);
}

/// Of a universal joint: each pin of its cross rubs by itself, pressed by all of the joint's force.
void take_cross_friction(MechanismAssembly& assembly, const JointDescription& joint, const SpaceJointPlaces& built) {
  const auto& [part, places, first, second] = built;
  const auto turns = turns_of_cross(first, second);
  const double radius = rubbing_radius(assembly, joint, part);
  const int pin =
      take_friction(assembly, joint, part, angle_between(assembly, first, second, turns[0]), {0, 3}, radius);
  auto& frictions = assembly.mechanism.frictions;
  JointFriction other = frictions[static_cast<std::size_t>(pin)];
  frictions.back().pin = "first";
  other.pin = "second";
  other.s = angle_between(assembly, first, second, turns[1]);
  assembly.mechanism.add_friction(std::move(other));
}

double lead_of(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part) {
  if (!joint.lead) throw InvalidInput(joint.where, part + " lacks the key \"lead\": how far it goes in a turn [m]");
  const double lead = assembly.number(*joint.lead, part + ": lead");
  if (!(std::abs(lead) > 0.0))
    throw InvalidInput(joint.lead->where, part + ": a screw of lead 0 does not advance; take a revolute joint");
  if (!joint.to.empty())
    throw InvalidInput(joint.to_where, part + ": a screw is given in the place where it begins to turn; remove \"to\"");
  return lead;
}

SpaceJointKind kind_of(Type type) {
  switch (type) {
    case Type::revolute:
      return SpaceJointKind::revolute;
    case Type::prismatic:
      return SpaceJointKind::prismatic;
    case Type::cylindrical:
      return SpaceJointKind::cylindrical;
    case Type::spherical:
      return SpaceJointKind::spherical;
    case Type::universal:
      return SpaceJointKind::universal;
    case Type::planar:
      return SpaceJointKind::planar;
    default:
      assert(type == Type::rigid);
      return SpaceJointKind::rigid;
  }
}

SpaceJointPlaces places_of(MechanismAssembly& assembly, const JointDescription& joint) {
  SpaceJointPlaces built;
  built.part = fmt::format("joint \"{}\"", joint.name);
  built.places = take_places(assembly, joint, built.part);
  require_axes(assembly, joint, built);
  Matrix3 axes = Matrix3::Identity();
  const std::vector<double>& q = assembly.start;
  if (joint.type == Type::universal) {
    axes = axes_of_universal(assembly, joint, built.part);
  } else if (joint_kind(joint.type).takes("axis")) {
    require_axis(joint, built.part);
    axes = frame_at(assembly.mechanism.space_node(0), q.data(), Axis::Zero(),
                    assembly.direction(joint.axis, joint.axis_where, built.part, "axis"))
               .axes;
  }
  const auto& [first, second] = built.places.node;
  built.first = frame_with(assembly.mechanism.space_node(first), q.data(), built.places.at[0], axes);
  built.second = frame_with(assembly.mechanism.space_node(second), q.data(), built.places.at[1], axes);
  return built;
}

}  // namespace

void take_space_joint(MechanismAssembly& assembly, const JointDescription& joint) {
  if (!joint_kind(joint.type).in_space)
    throw InvalidInput(joint.where, fmt::format("joint \"{}\": its type is for mechanisms in the plane, and this one "
                                                "lies in space; give positions two numbers",
                                                joint.name));
  const SpaceJointPlaces built = places_of(assembly, joint);
  const auto& [part, places, first, second] = built;
  Mechanism& mechanism = assembly.mechanism;
  const DrawnPoint one = draw(mechanism, first.point), two = draw(mechanism, second.point);
  mechanism.drawing.joints.push_back(drawn_joint(joint, one, two, drawn_axis(joint.type, first.axes)));
  if (joint.type == Type::strut) {
    require_law(assembly, joint, part);
    (void)length_of(assembly, joint, part, places);
    mechanism.drawing.lines.push_back({DrawnLine::Kind::strut, one, two});
    ++assembly.elements;
    take_coordinate(assembly, joint, built,
                    {SpaceCoordinate::Kind::length, first.point, second.point, PointDistance{}, -1, 0.0}, true, 0.0);
    return;
  }
  mechanism.reactions.push_back({mechanism.joints.size(), second.point, joint.type == Type::distance});
  if (joint.type == Type::distance) {
    mechanism.drawing.lines.push_back({DrawnLine::Kind::link, one, two});
    mechanism.joints.push_back(
        make_space_distance(joint.name, first.point, second.point, length_of(assembly, joint, part, places)));
    ++assembly.elements;
    return;
  }
  const double lead = joint.type == Type::screw ? lead_of(assembly, joint, part) : 0.0;
  if (joint.type == Type::screw)
    mechanism.joints.push_back(make_space_screw(joint.name, first, second, lead));
  else
    mechanism.joints.push_back(make_space_joint(kind_of(joint.type), joint.name, first, second));
  const bool turns = joint.type == Type::revolute || joint.type == Type::cylindrical || joint.type == Type::screw;
  const bool slides = joint.type == Type::prismatic || joint.type == Type::cylindrical || joint.type == Type::screw;
  if (turns)
    take_coordinate(assembly, joint, built, angle_between(assembly, first, second, turn_of(first, second)),
                    joint.type != Type::cylindrical, lead);
  if (slides)
    take_coordinate(assembly, joint, built, way_between(first, second, 2), joint.type == Type::prismatic, lead);
  if (joint.type == Type::cylindrical && joint.friction) {
    const auto& coordinates = mechanism.space_coordinates;
    take_collar_friction(assembly, joint, built, coordinates.back().s, coordinates[coordinates.size() - 2].s);
  }
  if (joint.type == Type::planar && joint.friction) take_foot_friction(assembly, joint, built);
  if (joint.type == Type::universal && joint.friction) take_cross_friction(assembly, joint, built);
}

}  // namespace rubato::model
