#include <rubato/model/build_structure.hpp>
#include <rubato/model/mechanism_assembly.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::model {
namespace {

constexpr double largest_angle = 2.0 * std::numbers::pi;

int dimension_of(const ModelDescription& description) {
  const auto& nodes = description.structure.nodes;
  if (!nodes.empty()) return nodes.front().position.size() == 3 ? 3 : 2;
  const auto& bodies = description.bodies;
  return !bodies.empty() && bodies.front().position.size() == 3 ? 3 : 2;
}

/// The node or body that decides whether a mechanism lies in the plane.
std::string first_part(const ModelDescription& description) {
  const auto& nodes = description.structure.nodes;
  if (!nodes.empty()) return fmt::format("node \"{}\"", nodes.front().name);
  const auto& bodies = description.bodies;
  return bodies.empty() ? std::string() : fmt::format("body \"{}\"", bodies.front().name);
}

}  // namespace

MechanismAssembly::MechanismAssembly(const ModelDescription& description_, const numerics::Parameters& parameters_)
    : description(description_), parameters(parameters_), mechanism(dimension_of(description_)) {}

double MechanismAssembly::number(const Quantity& quantity, const std::string& what) const {
  return evaluate(quantity, parameters, what);
}

double MechanismAssembly::positive(const Quantity& quantity, const std::string& what) const {
  const double value = number(quantity, what);
  if (!(value > 0.0)) throw InvalidInput(quantity.where, fmt::format("{} must be positive, got {}", what, value));
  return value;
}

double MechanismAssembly::at_least_zero(const Quantity& quantity, const std::string& what) const {
  const double value = number(quantity, what);
  if (!(value >= 0.0)) throw InvalidInput(quantity.where, fmt::format("{} must not be negative, got {}", what, value));
  return value;
}

double MechanismAssembly::angle(const Quantity& quantity, const std::string& what) const {
  const double value = number(quantity, what);
  const bool is_in_radians = std::isfinite(value) && quantity.expression.find("pi") != std::string::npos;
  if (!(std::abs(value) <= largest_angle) && !is_in_radians)
    throw InvalidInput(quantity.where, fmt::format("{} is {} rad, more than a turn; if degrees are meant, write \"{} * "
                                                   "pi/180\", if turns, \"{:.6g} * pi\"",
                                                   what, value, value, value / std::numbers::pi));
  return value;
}

Axis MechanismAssembly::point(const std::vector<Quantity>& values, const Location& where,
                              const std::string& what) const {
  const auto wanted = static_cast<std::size_t>(mechanism.dimension);
  if (values.size() != wanted) {
    const std::string first = first_part(description);
    throw InvalidInput(
        where,
        fmt::format("{} takes {}, got {}{}", what, in_plane() ? "two numbers in the plane" : "three numbers in space",
                    values.size(), first.empty() ? "" : "; by the position of " + first + " the model lies there"));
  }
  Axis result = Axis::Zero();
  for (std::size_t i = 0; i < wanted; ++i) result[static_cast<Index>(i)] = number(values[i], what);
  return result;
}

Axis MechanismAssembly::direction(const std::vector<Quantity>& values, const Location& where, const std::string& part,
                                  const std::string& key) const {
  const Axis given = point(values, where, part + ": " + key);
  const double length = given.norm();
  if (!(length > 0.0) || !std::isfinite(length)) {
    const std::string numbers = in_plane() ? fmt::format("{}, {}", given[0], given[1])
                                           : fmt::format("{}, {}, {}", given[0], given[1], given[2]);
    throw InvalidInput(where, fmt::format("{}: the {} [{}] has no length", part, key, numbers));
  }
  return given / length;
}

Axis MechanismAssembly::position(Index node) const {
  const auto& numbers = mechanism.nodes[static_cast<std::size_t>(node)].numbers;
  return {numbers[0], numbers[1], in_plane() ? 0.0 : numbers[2]};
}

bool MechanismAssembly::has_axes(Index node) const {
  const MechanismNode& n = mechanism.nodes[static_cast<std::size_t>(node)];
  if (node == 0) return true;
  for (std::size_t axis = in_plane() ? 5 : 3; axis < 6; ++axis)
    if (n.place[axis] == ground && fixed.count(n.name + "." + axis_names[axis]) == 0) return false;
  return true;
}

void MechanismAssembly::extend(const Axis& place) {
  low = low.cwiseMin(place);
  high = high.cwiseMax(place);
}

bool MechanismAssembly::is_body(const std::string& name) const {
  return std::any_of(description.bodies.begin(), description.bodies.end(),
                     [&](const BodyDescription& body) { return body.name == name; });
}

Index MechanismAssembly::free_coordinate(const std::string& name, const Location& where,
                                         const std::string& role) const {
  const auto& known = mechanism.coordinates;
  const auto found = std::find(known.begin(), known.end(), name);
  if (found != known.end()) return static_cast<Index>(found - known.begin());
  if (fixed.count(name) > 0) throw InvalidInput(where, fmt::format("{} \"{}\", which a support holds", role, name));
  throw InvalidInput(where, fmt::format("{} \"{}\", which is no coordinate{}", role, name, suggestion(name, known)));
}

NodeNumber number_of(const MechanismAssembly& assembly, const std::string& name, const Location& where,
                     const std::string& part, const std::string& remedy) {
  if (name == "ground") return {};
  const Mechanism& mechanism = assembly.mechanism;
  const Index place = assembly.free_coordinate(name, where, part + " joins");
  if (!assembly.in_plane() && mechanism.is_rotation[static_cast<std::size_t>(place)] != 0)
    throw InvalidInput(where,
                       fmt::format("{} joins \"{}\", a rotation in space, which is no number; {}", part, name, remedy));
  for (std::size_t i = 0; i < mechanism.nodes.size(); ++i)
    for (std::size_t axis = 0; axis < 6; ++axis)
      if (mechanism.nodes[i].place[axis] == place)
        return {
            static_cast<Index>(i) * mechanism.numbers_a_node() + static_cast<Index>(axis == 5 ? std::size_t{2} : axis),
            place};
  return {};
}

JointPlaces take_places(MechanismAssembly& assembly, const JointDescription& joint, const std::string& part) {
  refuse_unfit_name(joint.name, joint.where);
  for (const std::string& other : assembly.joint_names)
    if (other == joint.name) throw InvalidInput(joint.where, fmt::format("two joints are called \"{}\"", joint.name));
  assembly.joint_names.push_back(joint.name);
  JointPlaces places;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string& name = joint.between[i];
    if (name == "ground") continue;
    const auto found = assembly.nodes.find(name);
    if (found == assembly.nodes.end()) {
      std::vector<std::string> known;
      for (const auto& node : assembly.mechanism.nodes) known.push_back(node.name);
      throw InvalidInput(joint.between_where[i], fmt::format("{} joins \"{}\", which is no node and no body{}", part,
                                                             name, suggestion(name, known)));
    }
    places.node[i] = found->second;
  }
  if (places.node[0] == places.node[1])
    throw InvalidInput(joint.between_where[1], fmt::format("{} joins \"{}\" with itself", part, joint.between[1]));
  // A joint sits at its node; a body has many places for one.
  const bool is_distance =
      joint.type == JointDescription::Type::distance || joint.type == JointDescription::Type::strut;
  const auto is_node = [&](std::size_t i) { return !places.is_ground(i) && !assembly.is_body(joint.between[i]); };
  if (!joint.at.empty())
    places.at[0] = assembly.point(joint.at, joint.at_where, part + ": at");
  else if (is_node(0) || (is_distance && !places.is_ground(0)))
    places.at[0] = assembly.position(places.node[0]);
  else if (is_node(1) && !is_distance)
    places.at[0] = assembly.position(places.node[1]);
  else
    throw InvalidInput(joint.where, fmt::format("{} needs \"at\", its place in the configuration given [m]", part));
  if (!joint.to.empty())
    places.at[1] = assembly.point(joint.to, joint.to_where, part + ": to");
  else if (is_distance && places.is_ground(1))
    throw InvalidInput(joint.where, fmt::format("{} needs \"to\", the place of its second end [m]", part));
  else
    places.at[1] = is_distance || (is_node(1) && joint.at.empty()) ? assembly.position(places.node[1]) : places.at[0];
  for (const Axis& place : places.at) assembly.extend(place);
  return places;
}

double length_of(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                 const JointPlaces& places) {
  const double length =
      joint.length ? assembly.positive(*joint.length, part + ": length") : (places.at[1] - places.at[0]).norm();
  if (!(length > 0.0))
    throw InvalidInput(joint.where, fmt::format("{} has no length: its ends lie in the same place", part));
  return length;
}

}  // namespace rubato::model
