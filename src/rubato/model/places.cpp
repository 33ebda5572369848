#include <rubato/model/build_structure.hpp>
#include <rubato/model/places.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace rubato::model {

void Places::add(const std::string& name, const Location& where) {
  if (name.empty() || name == "ground")
    throw InvalidInput(where, name.empty() ? "a coordinate needs a name"
                                           : "the name \"ground\" is taken: it stands for what does not move");
  refuse_unfit_name(name, where);
  if (!places_.emplace(name, static_cast<Index>(model_.coordinates.size())).second)
    throw InvalidInput(where, fmt::format("two coordinates are called \"{}\"", name));
  model_.coordinates.push_back(name);
}

Index Places::find(const std::string& name, const Location& where, const std::string& role) const {
  const auto found = places_.find(name);
  if (found != places_.end()) return found->second;
  if (name == "ground")
    throw InvalidInput(where, fmt::format("{} the ground, which does not move; name a coordinate", role));
  if (held_.count(name) > 0) throw InvalidInput(where, fmt::format("{} \"{}\", which a support holds", role, name));
  if (doubtful_.count(name) > 0)
    throw InvalidInput(where,
                       fmt::format("{} \"{}\", of which the matrices have no row: it may be held, but {}; name a node "
                                   "that has rows, or \"ground\" where it is held",
                                   role, name, doubt_));
  refuse_missing_axis(name, where, role);
  const std::vector<std::string> what_does_not_move{"ground"};
  const bool means_ground =
      nearest_name(name, model_.coordinates).empty() && !nearest_name(name, what_does_not_move).empty();
  throw InvalidInput(where, fmt::format("{} \"{}\", which is no coordinate{}", role, name,
                                        suggestion(name, means_ground ? what_does_not_move : model_.coordinates)));
}

/// A node that exists, and a degree of freedom that it has not.
void Places::refuse_missing_axis(const std::string& name, const Location& where, const std::string& role) const {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) return;
  const auto& nodes = model_.structure.names;
  const std::string node = name.substr(0, dot), axis = name.substr(dot + 1);
  if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) return;
  const bool in_plane = model_.structure.dimension == 2;
  if (has_finite_elements_)
    throw InvalidInput(where, fmt::format("{} \"{}\", and the matrices have no such row: node {} has {}", role, name,
                                          node, rows_of(node)));
  const bool is_axis = in_plane ? axis == "x" || axis == "y" || axis == "rz"
                                : std::find(axis_names.begin(), axis_names.end(), axis) != axis_names.end();
  if (is_axis)
    throw InvalidInput(where, fmt::format("{} \"{}\", and node \"{}\" has no inertia in {}: join it by a beam, or "
                                          "give it a [[mass]] with {}",
                                          role, name, node, axis, axis.front() == 'r' ? "an inertia" : "a mass"));
  throw InvalidInput(where, fmt::format("{} \"{}\", but a node has {}", role, name,
                                        in_plane ? "x, y, rz in the plane" : "x, y, z, rx, ry, rz in space"));
}

/// The directions of a node that have a row.
std::string Places::rows_of(const std::string& node) const {
  std::vector<std::string> axes;
  for (const char* axis : axis_names)
    if (places_.count(node + "." + axis) > 0) axes.emplace_back(axis);
  return axes.empty() ? "none: it is held" : fmt::format("{}", fmt::join(axes, ", "));
}

void Places::join(const Between& names, const std::array<Location, 2>& where, const std::string& part, Index& first,
                  Index& second) const {
  const auto end = [&](std::size_t i) { return end_of(names[i], where[i], part + " joins"); };
  first = end(0);
  second = end(1);
  if (first == second && names[0] == names[1])
    throw InvalidInput(where[1], fmt::format("{} joins \"{}\" with itself", part, names[1]));
  if (first == second)
    throw InvalidInput(where[1],
                       fmt::format("{} joins \"{}\" with \"{}\", and neither moves", part, names[0], names[1]));
  if (first != ground && second != ground && is_rotation_at(first) != is_rotation_at(second))
    throw InvalidInput(where[1], fmt::format("{} joins a displacement [m] and a rotation [rad]", part));
}

void Places::take(const std::vector<std::pair<std::string, Quantity>>& values, const std::string& key,
                  Vector& out) const {
  std::unordered_map<Index, std::string> given;
  for (const auto& [name, value] : values) {
    const Index place = find(name, value.where, key + " names");
    const auto [other, is_first] = given.emplace(place, name);
    if (!is_first)
      throw InvalidInput(
          value.where, fmt::format("{} names one coordinate twice, as \"{}\" and as \"{}\"", key, other->second, name));
    out[place] = evaluate(value, parameters_, fmt::format("{} of \"{}\"", key, name));
  }
}

}  // namespace rubato::model
