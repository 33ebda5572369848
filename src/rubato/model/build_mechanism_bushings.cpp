#include <rubato/model/joints/space_coordinate.hpp>
#include <rubato/model/mechanism_assembly.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

// Elastic mounts: in the plane springs and dampers on two displacements and an angle, in space on three displacements
// and on the rotation vector.
namespace rubato::model {
namespace {

using numerics::Matrix3;
using numerics::Vector3;

std::vector<double> values_of(const MechanismAssembly& assembly, const std::vector<Quantity>& given,
                              const Location& where, const std::string& what) {
  const std::size_t wanted = assembly.in_plane() ? 3 : 6;
  if (given.size() != wanted)
    throw InvalidInput(where,
                       fmt::format("{} takes {}, got {}", what,
                                   assembly.in_plane() ? "three numbers in the plane: along x and y, and about z"
                                                       : "six numbers in space: along x, y and z, and about them",
                                   given.size()));
  std::vector<double> values;
  for (const Quantity& quantity : given) values.push_back(assembly.at_least_zero(quantity, what));
  return values;
}

/// Its places as those of a joint that holds both parts at its point.
JointPlaces places_of(MechanismAssembly& assembly, const BushingDescription& given, const std::string& part) {
  JointDescription joint;
  joint.name = given.name;
  joint.type = JointDescription::Type::rigid;
  joint.between = given.between;
  joint.between_where = given.between_where;
  joint.at = given.at;
  joint.at_where = given.at_where;
  joint.where = given.where;
  const JointPlaces places = take_places(assembly, joint, part);
  for (std::size_t end = 0; end < 2; ++end)
    if (!assembly.has_axes(places.node[end]))
      throw InvalidInput(given.between_where[end],
                         fmt::format("{} joins \"{}\", a mass that does not turn, and holds more than its place; give "
                                     "its [[mass]] \"inertia\", or take springs",
                                     part, given.between[end]));
  return places;
}

/// Its displacements and angle in the plane.
void take_in_plane(MechanismAssembly& assembly, const BushingDescription& given, const std::string& part,
                   const JointPlaces& places, Bushing& bushing) {
  if (!given.rotation.empty())
    throw InvalidInput(given.rotation_where, part + ": rotation is for bushings in space; in the plane give \"axis\"");
  const Mechanism& mechanism = assembly.mechanism;
  const Axis axis =
      given.axis.empty() ? Axis(Axis::UnitX()) : assembly.direction(given.axis, given.axis_where, part, "axis");
  const double turn = mechanism.nodes[static_cast<std::size_t>(places.node[0])].numbers[2];
  const double c = std::cos(turn), s = std::sin(turn);
  const std::array<double, 2> x{c * axis[0] + s * axis[1], -s * axis[0] + c * axis[1]};
  PlaneCoordinate coordinate;
  coordinate.along.first = mechanism.plane_point(places.node[0], places.at[0][0], places.at[0][1]);
  coordinate.along.second = mechanism.plane_point(places.node[1], places.at[1][0], places.at[1][1]);
  coordinate.kind = PlaneCoordinate::Kind::displacement;
  for (const auto& direction : {x, std::array<double, 2>{-x[1], x[0]}}) {
    coordinate.along.direction = direction;
    bushing.s.emplace_back(coordinate);
  }
  coordinate.kind = PlaneCoordinate::Kind::angle;
  coordinate.zero = coordinate.value(assembly.start.data());
  bushing.s.emplace_back(coordinate);
}

void take_in_space(const MechanismAssembly& assembly, const BushingDescription& given, const std::string& part,
                   const JointPlaces& places, Bushing& bushing) {
  if (!given.axis.empty())
    throw InvalidInput(given.axis_where,
                       part + ": axis is for bushings in the plane; in space give \"rotation\", a rotation vector");
  const Mechanism& mechanism = assembly.mechanism;
  Axis turn = Axis::Zero();
  if (!given.rotation.empty()) turn = assembly.point(given.rotation, given.rotation_where, part + ": rotation");
  const Matrix3 axes = numerics::rotation_of(turn).toRotationMatrix();
  const SpacePoint first = mechanism.space_point(places.node[0], places.at[0]);
  const SpacePoint second = mechanism.space_point(places.node[1], places.at[1]);
  const double* const q = assembly.start.data();
  RelativeTurn relative{first.node, second.node, first.node.rotation(q).toRotationMatrix().transpose() * axes,
                        second.node.rotation(q).toRotationMatrix().transpose() * axes};
  for (Index i = 0; i < 3; ++i)
    bushing.s.emplace_back(
        SpaceCoordinate{SpaceCoordinate::Kind::displacement, first, second, BodyGap{relative.axes1.col(i)}, -1, 0.0});
  bushing.turn.push_back(relative);
}

void add_elements(Mechanism& mechanism, const Bushing& bushing) {
  auto& elements = mechanism.elements;
  for (std::size_t i = 0; i < bushing.s.size(); ++i)
    std::visit(
        [&](const auto& s) {
          if (bushing.stiffness[i] > 0.0)
            elements.push_back(make_joint_spring(bushing.name, s, bushing.stiffness[i], 0.0));
          if (bushing.damping[i] > 0.0) elements.push_back(make_joint_damper(bushing.name, s, bushing.damping[i]));
        },
        bushing.s[i].of);
  for (const RelativeTurn& turn : bushing.turn) {
    const Vector3 stiffness(&bushing.stiffness[3]), damping(&bushing.damping[3]);
    if (!stiffness.isZero(0.0)) elements.push_back(make_turn_spring(bushing.name, turn, stiffness));
    if (!damping.isZero(0.0)) elements.push_back(make_turn_damper(bushing.name, turn, damping));
  }
}

}  // namespace

void take_bushing(MechanismAssembly& assembly, const BushingDescription& given) {
  const std::string part = fmt::format("bushing \"{}\"", given.name);
  const JointPlaces places = places_of(assembly, given, part);
  Bushing bushing;
  bushing.name = given.name;
  bushing.stiffness = values_of(assembly, given.stiffness, given.stiffness_where, part + ": stiffness");
  if (given.damping.empty())
    bushing.damping.assign(bushing.stiffness.size(), 0.0);
  else
    bushing.damping = values_of(assembly, given.damping, given.damping_where, part + ": damping");
  const auto is_zero = [](double value) { return value == 0.0; };
  if (std::all_of(bushing.stiffness.begin(), bushing.stiffness.end(), is_zero) &&
      std::all_of(bushing.damping.begin(), bushing.damping.end(), is_zero))
    throw InvalidInput(given.where, part + " does nothing: its stiffness and its damping are zero in all directions");
  if (assembly.in_plane())
    take_in_plane(assembly, given, part, places, bushing);
  else
    take_in_space(assembly, given, part, places, bushing);
  add_elements(assembly.mechanism, bushing);
  assembly.mechanism.bushings.push_back(std::move(bushing));
}

}  // namespace rubato::model
