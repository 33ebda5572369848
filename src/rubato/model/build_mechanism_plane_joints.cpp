#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/model/mechanism_joint_laws.hpp>

#include <fmt/format.h>

#include <cmath>

namespace rubato::model {
namespace {

/// A body reaches from its centre of mass to its joints.
void draw(Mechanism& mechanism, const PlanePoint& point) {
  const Index node = point.node.q / plane_numbers;
  if (node == 0 || (point.offset[0] == 0.0 && point.offset[1] == 0.0)) return;
  mechanism.drawing.lines.push_back(
      {DrawnLine::Kind::body, {node, {}}, {node, {point.offset[0], point.offset[1], 0.0}}});
}

DrawnPoint end_of(const PlanePoint& point) {
  return {point.node.q / plane_numbers, {point.offset[0], point.offset[1], 0.0}};
}

/// In the axes of the first node, of length 1.
std::array<double, 2> axis_of(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                              Index first) {
  const Axis axis = assembly.direction(joint.axis, joint.axis_where, part, "axis");
  const double turn = assembly.mechanism.nodes[static_cast<std::size_t>(first)].numbers[2];
  const double c = std::cos(turn), s = std::sin(turn);
  return {c * axis[0] + s * axis[1], -s * axis[0] + c * axis[1]};
}

/// The friction, the lock, the drive, the law, the spring and the damper on what a joint leaves free.
void take_coordinate(MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                     PlaneCoordinate s) {
  Mechanism& mechanism = assembly.mechanism;
  const bool is_length = s.kind == PlaneCoordinate::Kind::length;
  const double now = s.value(assembly.start.data());
  const double value = is_length ? now : start_value(assembly, joint, part, s.is_angle());
  s.zero = now - value;
  mechanism.joint_coordinates.push_back({joint.name, s});
  const int pressing = is_length ? 0 : s.is_angle() ? 2 : 1;
  if (joint.friction) take_friction(assembly, joint, part, s, {0, pressing}, rubbing_radius(assembly, joint, part));
  take_laws(assembly, joint, part, s, value, take_locks(assembly, joint, part, s, value));
}

/// A mass that does not turn has no axes with which a joint could do more than hold its place.
void require_axes(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                  const JointPlaces& places) {
  using Type = JointDescription::Type;
  const bool holds_points_only = joint.type == Type::distance || joint.type == Type::strut ||
                                 (joint.type == Type::revolute && !has_law(assembly, joint));
  for (std::size_t end = 0; end < 2; ++end) {
    const Index node = places.node[end];
    if (assembly.has_axes(node)) continue;
    if (holds_points_only && places.at[end] == assembly.position(node)) continue;
    throw InvalidInput(
        joint.between_where[end],
        fmt::format("{} joins \"{}\", a mass that does not turn, by more than its place; give its "
                    "[[mass]] \"inertia\", or take a distance joint, a strut, or a revolute joint without "
                    "laws at the node itself",
                    part, joint.between[end]));
  }
}

}  // namespace

void take_plane_joint(MechanismAssembly& assembly, const JointDescription& joint) {
  using Type = JointDescription::Type;
  const std::string part = fmt::format("joint \"{}\"", joint.name);
  const JointPlaces places = take_places(assembly, joint, part);
  require_axes(assembly, joint, part, places);
  Mechanism& mechanism = assembly.mechanism;
  const PlanePoint a = mechanism.plane_point(places.node[0], places.at[0][0], places.at[0][1]);
  const PlanePoint b = mechanism.plane_point(places.node[1], places.at[1][0], places.at[1][1]);
  draw(mechanism, a);
  draw(mechanism, b);
  const double relative = mechanism.nodes[static_cast<std::size_t>(places.node[1])].numbers[2] -
                          mechanism.nodes[static_cast<std::size_t>(places.node[0])].numbers[2];
  PlaneCoordinate s;
  s.along = {a, b, {1.0, 0.0}};
  mechanism.drawing.joints.push_back(drawn_joint(joint, end_of(a), end_of(b), {}));
  switch (joint.type) {
    case Type::rigid:
      mechanism.joints.push_back(make_plane_rigid(joint.name, a, b, relative));
      return;
    case Type::distance:
      mechanism.drawing.lines.push_back({DrawnLine::Kind::link, end_of(a), end_of(b)});
      mechanism.joints.push_back(make_plane_distance(joint.name, a, b, length_of(assembly, joint, part, places)));
      ++assembly.elements;
      return;
    case Type::strut:
      require_law(assembly, joint, part);
      (void)length_of(assembly, joint, part, places);
      mechanism.drawing.lines.push_back({DrawnLine::Kind::strut, end_of(a), end_of(b)});
      s.kind = PlaneCoordinate::Kind::length;
      ++assembly.elements;
      break;
    case Type::revolute:
      if (!joint.axis.empty())
        throw InvalidInput(joint.axis_where, part + ": a revolute joint in the plane turns about z; remove \"axis\"");
      mechanism.joints.push_back(make_plane_revolute(joint.name, a, b));
      break;
    case Type::prismatic:
      require_axis(joint, part);
      s.kind = PlaneCoordinate::Kind::displacement;
      s.along.direction = axis_of(assembly, joint, part, places.node[0]);
      mechanism.drawing.joints.back().axis = {s.along.direction[0], s.along.direction[1], 0.0};
      mechanism.joints.push_back(make_plane_prismatic(joint.name, a, b, s.along.direction, relative));
      break;
    default:
      throw InvalidInput(joint.where, fmt::format("{}: its type is for mechanisms in space, and this one lies in the "
                                                  "plane; give positions three numbers",
                                                  part));
  }
  take_coordinate(assembly, joint, part, s);
}

}  // namespace rubato::model
