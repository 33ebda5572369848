#include <rubato/model/build_sections.hpp>
#include <rubato/model/build_structure_nodes.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace rubato::model {
namespace {

// The square of the angle [rad] below which directions count as one: positions with six digits mean no more, and what
// is left of the inertia of a motion, this share of it, nears round-off.
constexpr double same_direction = 1e-12;

}  // namespace

void StructureNodes::add(const std::string& name, const Location& where, const Axis& position) {
  refuse_unfit_name(name, where);
  names_.add(name, where, static_cast<Index>(states_.size()));
  structure_.names.push_back(name);
  structure_.positions.push_back(position);
  states_.emplace_back();
  states_.back().where = where;
}

/// Velocities of a node at the start, by the axes that it has.
void StructureNodes::take_velocity(const NodeDescription& node, NodeState& state) const {
  const auto take = [&](const std::vector<Quantity>& values, const Location& where, const char* key,
                        std::span<const std::size_t> axes) {
    if (values.empty()) return;
    const std::string what = fmt::format("node \"{}\": {}", node.name, key);
    if (values.size() != axes.size())
      throw InvalidInput(
          where, fmt::format("{} takes {} number{} {}, got {}", what,
                             axes.size() == 1   ? "one"
                             : axes.size() == 2 ? "two"
                                                : "three",
                             axes.size() == 1 ? "" : "s", in_plane() ? "in the plane" : "in space", values.size()));
    for (std::size_t i = 0; i < axes.size(); ++i) {
      state.velocity[axes[i]] = evaluated(values[i], what);
      state.has_velocity[axes[i]] = true;
    }
  };
  static constexpr std::array<std::size_t, 6> axes{0, 1, 2, 3, 4, 5};
  const std::size_t translations = in_plane() ? 2 : 3;
  take(node.velocity, node.velocity_where, "velocity", std::span(axes).first(translations));
  take(node.angular_velocity, node.angular_velocity_where, "angular_velocity",
       in_plane() ? std::span(axes).last(1) : std::span(axes).last(3));
}

void StructureNodes::take_given() {
  structure_.dimension = description_.nodes.front().position.size() == 3 ? 3 : 2;
  for (const NodeDescription& node : description_.nodes) {
    const std::size_t given = node.position.size();
    if (given != 2 && given != 3)
      throw InvalidInput(node.where, fmt::format("node \"{}\": position takes two numbers in the plane or three in "
                                                 "space, got {}",
                                                 node.name, given));
    if (static_cast<int>(given) != structure_.dimension)
      throw InvalidInput(node.where,
                         fmt::format("node \"{}\" has {} numbers for its position, and node \"{}\" has {}: a model "
                                     "lies in the plane or in space",
                                     node.name, given, description_.nodes.front().name, structure_.dimension));
    Axis position = Axis::Zero();
    for (std::size_t i = 0; i < given; ++i)
      position[static_cast<Index>(i)] = evaluated(node.position[i], fmt::format("node \"{}\": position", node.name));
    if (node.name == "ground")
      throw InvalidInput(node.where,
                         "a node cannot be called \"ground\", which is the name of what does not move; "
                         "give it another name, and hold it by a [[support]]");
    add(node.name, node.where, position);
    take_velocity(node, states_.back());
  }
}

Index StructureNodes::add_between(const std::string& name, const Location& where, Index first, Index last,
                                  double share) {
  const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(last);
  add(name, where, (1.0 - share) * structure_.positions[a] + share * structure_.positions[b]);
  NodeState& between = states_.back();
  for (std::size_t axis = 0; axis < 6; ++axis) {
    between.velocity[axis] = (1.0 - share) * states_[a].velocity[axis] + share * states_[b].velocity[axis];
    between.has_velocity[axis] = states_[a].has_velocity[axis] && states_[b].has_velocity[axis];
  }
  return static_cast<Index>(states_.size()) - 1;
}

bool StructureNodes::exists(const NodeState& state, std::size_t axis) {
  const auto i = static_cast<Index>(axis % 3);
  return state.inertia[is_rotation(axis)](i, i) > same_direction;
}

void StructureNodes::give_axis(NodeState& state, std::size_t axis) {
  const auto i = static_cast<Index>(axis % 3);
  state.inertia[is_rotation(axis)](i, i) += 1.0;
}

void StructureNodes::give_axes(Index node, bool has_rotations) {
  NodeState& state = states_[static_cast<std::size_t>(node)];
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const bool is_in_plane = axis < 2 || axis == 5;
    if ((is_in_plane || !in_plane()) && (has_rotations || !is_rotation(axis))) give_axis(state, axis);
  }
}

void StructureNodes::give_kept_axes(Index node, const std::array<bool, 6>& is_kept, const Eigen::Matrix3d& axes,
                                    const Location& where) {
  NodeState& state = states_[static_cast<std::size_t>(node)];
  state.release_where = where;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!is_kept[axis]) continue;
    const Axis direction = axes.row(static_cast<Index>(axis % 3));
    state.inertia[is_rotation(axis)] += direction * direction.transpose();
  }
}

void StructureNodes::take_masses_and_supports() {
  for (const PointMassDescription& mass : description_.masses) take_mass(mass);
  for (const SupportDescription& support : description_.supports) take_support(support);
}

void StructureNodes::take_mass(const PointMassDescription& mass) {
  const std::string part = fmt::format("the mass on node \"{}\"", mass.node);
  const std::size_t node = names_.place(mass.node, mass.node_where, "a mass is on");
  NodeState& state = states_[node];
  if (!mass.mass && mass.inertia.empty())
    throw InvalidInput(mass.where, part + " needs \"mass\" [kg], \"inertia\" [kg m2] or both");
  if (mass.mass) {
    const double value = positive(*mass.mass, parameters_, part + ": mass");
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(structure_.dimension); ++axis) {
      state.mass[axis] += value;
      give_axis(state, axis);
    }
  }
  if (mass.inertia.empty()) return;
  const std::size_t wanted = in_plane() ? 1 : 3;
  if (mass.inertia.size() != wanted)
    throw InvalidInput(mass.where, fmt::format("{}: inertia takes {}, got {}", part,
                                               in_plane() ? "one number in the plane, about z"
                                                          : "three numbers in space, about x, y and z",
                                               mass.inertia.size()));
  for (std::size_t i = 0; i < wanted; ++i) {
    const std::size_t axis = in_plane() ? 5 : 3 + i;
    state.mass[axis] += positive(mass.inertia[i], parameters_, part + ": inertia");
    give_axis(state, axis);
  }
}

void StructureNodes::take_support(const SupportDescription& support) {
  const std::size_t node = names_.place(support.node, support.node_where, "a support is at");
  if (support.fix.empty())
    throw InvalidInput(support.where, fmt::format("the support at node \"{}\" fixes nothing", support.node));
  for (std::size_t i = 0; i < support.fix.size(); ++i) {
    const auto axis =
        static_cast<std::size_t>(std::find(axis_names.begin(), axis_names.end(), support.fix[i]) - axis_names.begin());
    const Location& where = i < support.fix_where.size() ? support.fix_where[i] : support.where;
    if (axis == axis_names.size() || (in_plane() && axis >= 2 && axis != 5))
      throw InvalidInput(where,
                         fmt::format("the support at node \"{}\" fixes \"{}\"; a node {}", support.node, support.fix[i],
                                     in_plane() ? "in the plane has x, y, rz" : "in space has x, y, z, rx, ry, rz"));
    if (states_[node].is_fixed[axis])
      throw InvalidInput(where, fmt::format("node \"{}\" is fixed in {} twice", support.node, support.fix[i]));
    states_[node].is_fixed[axis] = true;
  }
}

/// A velocity along what a support holds, or of a rotation that nothing gives an inertia.
void StructureNodes::refuse_lost_velocity(std::size_t node) const {
  if (node >= description_.nodes.size()) return;  // within a beam
  const NodeState& state = states_[node];
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (state.velocity[axis] == 0.0 || (exists(state, axis) && !state.is_fixed[axis])) continue;
    const NodeDescription& given = description_.nodes[node];
    throw InvalidInput(
        is_rotation(axis) ? given.angular_velocity_where : given.velocity_where,
        fmt::format("node \"{}\" starts with a velocity in {}, {}", given.name, axis_names[axis],
                    state.is_fixed[axis] ? "which a support holds; leave it out"
                                         : "where nothing gives it an inertia; leave it out, or add a [[mass]]"));
  }
}

/// Releases oblique to the axes of the model may leave a node free to move, along or about a direction between them,
/// without inertia: the mass matrix is singular then, and no stiffness holds the motion either.
void StructureNodes::refuse_direction_without_inertia(std::size_t node) const {
  const NodeState& state = states_[node];
  for (const std::size_t kind : {0, 1}) {
    // What is held or does not exist gets an inertia, so that the lowest direction is one of the others.
    Eigen::Matrix3d inertia = state.inertia[kind];
    for (Index i = 0; i < 3; ++i) {
      const std::size_t axis = 3 * kind + static_cast<std::size_t>(i);
      if (exists(state, axis) && !state.is_fixed[axis]) continue;
      inertia.row(i).setZero();
      inertia.col(i).setZero();
      inertia(i, i) = 1.0;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(inertia);
    if (directions.eigenvalues()[0] > same_direction) continue;
    Axis direction = directions.eigenvectors().col(0);
    Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    direction /= direction[largest] < 0.0 ? -1.0 : 1.0;
    for (Index i = 0; i < 3; ++i)
      if (std::abs(direction[i]) < 1e-6) direction[i] = 0.0;  // round-off
    throw InvalidInput(
        state.release_where,
        fmt::format("the releases of beams leave node \"{}\" free to {} ({:.3g}), oblique to the axes of the model, "
                    "without mass or stiffness; leave out one of them, or give the node a [[mass]] with {}",
                    structure_.names[node], kind == 0 ? "move along" : "turn about",
                    fmt::join(std::span(direction.data(), static_cast<std::size_t>(structure_.dimension)), ", "),
                    kind == 0 ? "a mass" : "an inertia"));
  }
}

void StructureNodes::number(Index offset, BuiltStructure& built) {
  for (std::size_t node = 0; node < states_.size(); ++node) {
    const NodeState& state = states_[node];
    if (state.inertia[0].isZero() && state.inertia[1].isZero())
      throw InvalidInput(state.where, fmt::format("node \"{}\" is joined by nothing: no beam, truss or mass names it",
                                                  structure_.names[node]));
    refuse_lost_velocity(node);
    refuse_direction_without_inertia(node);
    std::array<Index, 6> places{};
    places.fill(ground);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (!exists(state, axis) && !state.is_fixed[axis]) continue;
      std::string name = structure_.names[node] + "." + axis_names[axis];
      if (state.is_fixed[axis]) {
        built.fixed.insert(std::move(name));
        continue;
      }
      places[axis] = offset + static_cast<Index>(built.coordinates.size());
      built.coordinates.push_back(
          {std::move(name), is_rotation(axis), state.mass[axis], state.velocity[axis], state.has_velocity[axis]});
    }
    structure_.places.push_back(places);
  }
}

void refuse_unfit_name(const std::string& name, const Location& where) {
  const auto is_unfit = [](unsigned char c) {
    return c < 0x20 || c == 0x7f || c == ',' || c == ';' || c == '"' || c == '/';
  };
  if (name.empty() || (name.front() != ' ' && name.back() != ' ' && name.find(" - ") == std::string::npos &&
                       std::none_of(name.begin(), name.end(), is_unfit)))
    return;
  std::string shown = name;
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  std::replace_if(shown.begin(), shown.end(), is_control, '?');
  throw InvalidInput(where,
                     fmt::format("the name \"{}\" cannot head a column of results: no comma, semicolon, quote, slash, "
                                 "control character, \" - \", or space at its ends",
                                 shown));
}

}  // namespace rubato::model
