#include <rubato/model/build_parts.hpp>
#include <rubato/model/build_structure.hpp>
#include <rubato/model/finite_elements/build_finite_elements.hpp>
#include <rubato/model/laws/jenkins.hpp>
#include <rubato/model/load_laws.hpp>
#include <rubato/model/model.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

namespace rubato::model {
namespace {

using numerics::Parameters;

/// Looks names up and evaluates numbers, with messages that name the part.
class Builder final : public Places {
 public:
  Builder(const ModelDescription& description, const Parameters& parameters, NegativeLoad negative_load)
      : description_(description), parameters_(parameters), negative_load_(negative_load) {}

  Model build() {
    refuse_parts_without_nodes(description_);
    if (description_.matrices)
      take_matrices(*description_.matrices);
    else
      take_coordinates();
    if (description_.finite_elements)
      take_finite_elements();
    else if (!description_.structure.is_empty())
      take_structure();
    take_springs();
    take_damping();
    take_sliders();
    take_stops();
    take_laws();
    take_pressed_sliders();
    take_contacts();
    for (const ForceDescription& force : description_.forces) {
      if (force.follows)
        throw InvalidInput(force.follows_where, fmt::format("the force on \"{}\" follows its node, which takes a "
                                                            "mechanism; give beams formulation = "
                                                            "\"geometrically_exact\", or leave \"following\" out",
                                                            force.on));
      model_.forces.push_back(
          {find(force.on, force.where, "a force is on"), law(force.law, fmt::format("the force on \"{}\"", force.on))});
    }
    for (const HeldDescription& held : description_.held_forces)
      model_.held_forces.push_back({find(held.on, held.where, "a force is on"),
                                    number(held.value, fmt::format("the force on \"{}\": held", held.on))});
    for (const DistributedForceDescription& force : description_.distributed_forces)
      model_.distributed_forces.push_back(
          build_distributed_force(force, lines_, model_.structure.dimension, parameters_));
    take_displacements();
    take_prescribed();
    if (description_.gravity) take_gravity(*description_.gravity);
    if (description_.base_motion) take_base_motion(*description_.base_motion);
    return std::move(model_);
  }

  Index end_of(const std::string& name, const Location& where, const std::string& role) const override {
    return name == "ground" || fixed_.count(name) > 0 ? ground : find(name, where, role);
  }

 private:
  double number(const Quantity& quantity, const std::string& what) const {
    return evaluate(quantity, parameters_, what);
  }

  double at_least_zero(const Quantity& quantity, const std::string& what, const std::string& remedy = "") const {
    return model::at_least_zero(quantity, parameters_, what, remedy);
  }

  double normal_load(const Quantity& quantity, const std::string& what) const {
    if (negative_load_ == NegativeLoad::zero) return std::max(number(quantity, what), 0.0);
    return at_least_zero(quantity, what, "; a slider cannot be pulled, its least load is 0");
  }

  void add_coordinate(const std::string& name, const Location& where) {
    if (name.empty() || name == "ground")
      throw InvalidInput(where, name.empty() ? "a coordinate needs a name"
                                             : "the name \"ground\" is taken: it stands for what does not move");
    refuse_unfit_name(name, where);
    if (!places_.emplace(name, static_cast<Index>(model_.coordinates.size())).second)
      throw InvalidInput(where, fmt::format("two coordinates are called \"{}\"", name));
    model_.coordinates.push_back(name);
  }

  void take_coordinates() {
    const auto n = static_cast<Index>(description_.coordinates.size());
    if (n == 0 && description_.structure.is_empty() && !description_.finite_elements)
      throw InvalidInput(description_.where,
                         "the study has no [[coordinate]], no [[node]] and no [matrices]; it needs one of them");
    model_.mass.resize(n);
    model_.position.resize(n);
    model_.velocity.resize(n);
    for (Index i = 0; i < n; ++i) {
      const CoordinateDescription& c = description_.coordinates[static_cast<std::size_t>(i)];
      add_coordinate(c.name, c.where);
      const std::string what = fmt::format("coordinate \"{}\": ", c.name);
      const double mass = number(c.mass, what + "mass");
      if (!(mass > 0.0))
        throw InvalidInput(c.mass.where,
                           mass == 0.0
                               ? fmt::format("{}mass is 0, which makes the mass matrix singular; give it a mass, "
                                             "or remove the coordinate and join its springs in series",
                                             what)
                               : fmt::format("{}mass must be positive, got {}", what, mass));
      model_.mass[i] = mass;
      model_.position[i] = number(c.position, what + "position");
      model_.velocity[i] = number(c.velocity, what + "velocity");
    }
  }

  void take_structure() {
    first_of_nodes_ = model_.size();
    BuiltStructure built = build_structure(description_.structure, parameters_, first_of_nodes_);
    const Index before = first_of_nodes_, n = before + static_cast<Index>(built.coordinates.size());
    for (Vector* values : {&model_.mass, &model_.position, &model_.velocity}) {
      values->conservativeResize(n);
      values->tail(n - before).setZero();
    }
    model_.is_rotation.assign(static_cast<std::size_t>(n), 0);
    for (NodeCoordinate& coordinate : built.coordinates) {
      const Index place = model_.size();
      if (!places_.emplace(coordinate.name, place).second)
        throw InvalidInput(description_.structure.nodes.front().where,
                           fmt::format("a coordinate and a degree of freedom are both called \"{}\"; rename the "
                                       "coordinate",
                                       coordinate.name));
      model_.mass[place] = coordinate.mass;
      model_.velocity[place] = coordinate.velocity;
      model_.is_rotation[static_cast<std::size_t>(place)] = coordinate.is_rotation;
      model_.coordinates.push_back(std::move(coordinate.name));
    }
    model_.structure = std::move(built.structure);
    fixed_ = std::move(built.fixed);
    lines_ = std::move(built.lines);
  }

  void take_finite_elements() {
    const Location& where = description_.finite_elements->where;
    first_of_nodes_ = model_.size();
    BuiltFiniteElements built = build_finite_elements(description_, parameters_, model_.mass);
    model_.is_rotation.assign(static_cast<std::size_t>(first_of_nodes_), 0);
    model_.is_rotation.insert(model_.is_rotation.end(), built.is_rotation.begin(), built.is_rotation.end());
    for (std::string& name : built.coordinates) {
      if (!places_.emplace(name, model_.size()).second)
        throw InvalidInput(where, fmt::format("a [[coordinate]] and a degree of freedom of [model] are both called "
                                              "\"{}\"; rename the coordinate",
                                              name));
      model_.coordinates.push_back(std::move(name));
    }
    for (Vector* values : {&model_.position, &model_.velocity}) {
      values->conservativeResize(model_.size());
      values->tail(model_.size() - first_of_nodes_).setZero();
    }
    fixed_.insert(built.fixed.begin(), built.fixed.end());
    model_.structure = std::move(built.structure);
    model_.matrices = std::move(built.matrices);
  }

  void take_matrices(const MatricesDescription& matrices) {
    const auto refuse = [&](const Location& where, const std::string& key) {
      throw InvalidInput(where,
                         fmt::format("[[{}]] does not go with [matrices], which hold the whole structure; add it to "
                                     "the matrices",
                                     key));
    };
    if (!description_.coordinates.empty()) refuse(description_.coordinates.front().where, "coordinate");
    if (!description_.springs.empty()) refuse(description_.springs.front().where, "spring");
    if (!description_.dampers.empty()) refuse(description_.dampers.front().where, "damper");
    if (!description_.structure.is_empty()) refuse(description_.structure.nodes.front().where, "node");
    const int size = matrices.mass.size;
    require_masses(matrices);  // before anything of that size is made: the head of a file may announce any
    if (!matrices.names.empty() && static_cast<int>(matrices.names.size()) != size)
      throw InvalidInput(matrices.where,
                         fmt::format("[matrices]: {} names for {} coordinates", matrices.names.size(), size));
    for (int i = 0; i < size; ++i) {
      const auto place = static_cast<std::size_t>(i);
      const std::string number = std::to_string(i + 1);
      const std::string& name = matrices.names.empty() ? number : matrices.names[place];
      const Location& where = place < matrices.names_where.size() ? matrices.names_where[place] : matrices.where;
      if (name != number && !name.empty() && name.find_first_not_of("0123456789") == std::string::npos)
        throw InvalidInput(where,
                           fmt::format("[matrices]: the name \"{}\" of coordinate {} is a number, and numbers mean "
                                       "places; choose another",
                                       name, number));
      add_coordinate(name, where);
    }
    if (!matrices.names.empty())
      for (int i = 0; i < size; ++i) places_.emplace(std::to_string(i + 1), i);  // numbers serve beside names
    model_.matrices = build_matrices(matrices);
    model_.position = Vector::Zero(size);
    model_.velocity = Vector::Zero(size);
    take_by_name(matrices.position, "position", model_.position);
    take_by_name(matrices.velocity, "velocity", model_.velocity);
  }

  /// Writes the values of { name = value, ... } into `out` [n].
  void take_by_name(const std::vector<std::pair<std::string, Quantity>>& values, const std::string& key,
                    Vector& out) const {
    std::unordered_map<Index, std::string> given;
    for (const auto& [name, value] : values) {
      const Index place = find(name, value.where, key + " names");
      const auto [other, is_first] = given.emplace(place, name);
      if (!is_first)
        throw InvalidInput(value.where, fmt::format("{} names one coordinate twice, as \"{}\" and as \"{}\"", key,
                                                    other->second, name));
      out[place] = number(value, fmt::format("{} of \"{}\"", key, name));
    }
  }

  /// @param role  "slider \"contact1\" joins"
  Index find(const std::string& name, const Location& where, const std::string& role) const {
    const auto found = places_.find(name);
    if (found != places_.end()) return found->second;
    if (name == "ground")
      throw InvalidInput(where, fmt::format("{} the ground, which does not move; name a coordinate", role));
    if (fixed_.count(name) > 0) throw InvalidInput(where, fmt::format("{} \"{}\", which a support holds", role, name));
    refuse_missing_axis(name, where, role);
    const std::vector<std::string> what_does_not_move{"ground"};
    const bool means_ground =
        nearest_name(name, model_.coordinates).empty() && !nearest_name(name, what_does_not_move).empty();
    throw InvalidInput(where, fmt::format("{} \"{}\", which is no coordinate{}", role, name,
                                          suggestion(name, means_ground ? what_does_not_move : model_.coordinates)));
  }

  /// A node that exists, and a degree of freedom that it has not.
  void refuse_missing_axis(const std::string& name, const Location& where, const std::string& role) const {
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos) return;
    const auto& nodes = model_.structure.names;
    const std::string node = name.substr(0, dot), axis = name.substr(dot + 1);
    if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) return;
    const bool in_plane = model_.structure.dimension == 2;
    if (description_.finite_elements)
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
  std::string rows_of(const std::string& node) const {
    std::vector<std::string> axes;
    for (const char* axis : axis_names)
      if (places_.count(node + "." + axis) > 0) axes.emplace_back(axis);
    return axes.empty() ? "none: it is held" : fmt::format("{}", fmt::join(axes, ", "));
  }

  bool is_rotation_at(Index place) const {
    return !model_.is_rotation.empty() && model_.is_rotation[static_cast<std::size_t>(place)];
  }

  void join(const Between& names, const std::array<Location, 2>& where, const std::string& part, Index& first,
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

  void take_springs() {
    for (const SpringDescription& spring : description_.springs) {
      const std::string part =
          fmt::format("the spring between \"{}\" and \"{}\"", spring.between[0], spring.between[1]);
      LinearElement element;
      join(spring.between, spring.between_where, part, element.first, element.second);
      element.coefficient = at_least_zero(spring.stiffness, part + ": stiffness");
      model_.springs.push_back(element);
    }
    for (const DamperDescription& damper : description_.dampers) {
      const std::string part =
          fmt::format("the damper between \"{}\" and \"{}\"", damper.between[0], damper.between[1]);
      LinearElement element;
      join(damper.between, damper.between_where, part, element.first, element.second);
      element.coefficient = at_least_zero(damper.damping, part + ": damping");
      model_.dashpots.push_back(element);
    }
  }

  void take_damping() {
    if (!std::holds_alternative<std::monostate>(description_.damping) && description_.matrices &&
        description_.matrices->damping)
      throw InvalidInput(where_of(description_.damping),
                         "[damping] and the damping matrix of [matrices] would count damping twice; keep one");
    if (!std::holds_alternative<std::monostate>(description_.damping) && description_.finite_elements &&
        description_.finite_elements->damping)
      throw InvalidInput(where_of(description_.damping),
                         "[damping] and the damping matrix of [model] would count damping twice; keep one");
    model_.damping = build_damping(description_.damping, model_.size(), parameters_);
  }

  void take_sliders() {
    for (const SliderDescription& description : description_.sliders) {
      const std::string part = fmt::format("slider \"{}\"", description.name);
      if (description.name.empty()) throw InvalidInput(description.where, "a slider needs a name");
      refuse_unfit_name(description.name, description.where);
      if (is_slider(description.name))
        throw InvalidInput(description.where, fmt::format("two sliders are called \"{}\"", description.name));
      if (places_.count(description.name) > 0)
        throw InvalidInput(description.where,
                           fmt::format("{} has the name of a coordinate; results would mix them up", part));
      Slider slider;
      slider.name = description.name;
      join(description.between, description.between_where, part, slider.first, slider.second);
      slider.stiffness = number(description.stiffness, part + ": stiffness");
      if (!(slider.stiffness > 0.0))
        throw InvalidInput(description.stiffness.where,
                           fmt::format("{}: stiffness must be positive, got {}", part, slider.stiffness));
      if (description.normal_law.empty() && description.normal_law_where.line > 0)
        throw InvalidInput(description.normal_law_where,
                           fmt::format("{}: normal_load names no law; give the name of a stop or of another law, or a "
                                       "number",
                                       part));
      const double mu = at_least_zero(description.friction_coefficient, part + ": friction_coefficient");
      if (description.is_law()) {
        pressed_.push_back(
            {slider.name, "slider", slider.first, slider.second, make_jenkins(slider.stiffness, mu), {}, {}});
        continue;
      }
      slider.limit = mu * normal_load(description.normal_load, part + ": normal_load");
      model_.sliders.push_back(slider);
    }
  }

  /// Sliders that are laws, behind the laws that may press on them.
  void take_pressed_sliders() {
    std::size_t next = 0;
    for (const SliderDescription& description : description_.sliders) {
      if (!description.is_law()) continue;
      LawBetween& law = pressed_[next++];
      law.normal = build_normal_force(description, description_.sliders, model_, parameters_,
                                      fmt::format("slider \"{}\"", law.name));
    }
    model_.laws.insert(model_.laws.end(), pressed_.begin(), pressed_.end());
  }

  void take_contacts() {
    for (const ContactDescription& description : description_.contacts) {
      const std::string& name = description.name;
      if (name.empty()) throw InvalidInput(description.where, "a contact needs a name");
      refuse_unfit_name(name, description.where);
      const auto is_called_so = [&](const auto& other) { return other.name == name; };
      const auto is_one_of = [&](const auto& parts) { return std::any_of(parts.begin(), parts.end(), is_called_so); };
      if (is_one_of(model_.blocks))
        throw InvalidInput(description.where, fmt::format("two contacts are called \"{}\"", name));
      if (is_slider(name) || is_one_of(model_.stops) || is_one_of(model_.laws) || places_.count(name) > 0)
        throw InvalidInput(
            description.where,
            fmt::format("contact \"{}\" has the name of a slider, a stop, a law or a coordinate; results "
                        "would mix them up",
                        name));
      model_.blocks.push_back(build_contact(description, model_, *this, parameters_));
    }
  }

  bool is_slider(const std::string& name) const {
    const auto is_called_so = [&](const auto& other) { return other.name == name; };
    return std::any_of(model_.sliders.begin(), model_.sliders.end(), is_called_so) ||
           std::any_of(pressed_.begin(), pressed_.end(), is_called_so);
  }

  void take_stops() {
    for (const StopDescription& description : description_.stops) {
      const std::string part = fmt::format("stop \"{}\"", description.name);
      if (description.name.empty()) throw InvalidInput(description.where, "a stop needs a name");
      refuse_unfit_name(description.name, description.where);
      const auto is_called_so = [&](const auto& other) { return other.name == description.name; };
      if (std::any_of(model_.stops.begin(), model_.stops.end(), is_called_so))
        throw InvalidInput(description.where, fmt::format("two stops are called \"{}\"", description.name));
      if (is_slider(description.name) || places_.count(description.name) > 0)
        throw InvalidInput(description.where,
                           fmt::format("{} has the name of a slider or a coordinate; results would mix them up", part));
      Stop stop;
      stop.name = description.name;
      join(description.between, description.between_where, part, stop.first, stop.second);
      stop.gap = number(description.gap, part + ": gap");
      stop.stiffness = number(description.stiffness, part + ": stiffness");
      if (!(stop.stiffness > 0.0))
        throw InvalidInput(description.stiffness.where,
                           fmt::format("{}: stiffness must be positive, got {}", part, stop.stiffness));
      stop.damping = at_least_zero(description.damping, part + ": damping");
      model_.stops.push_back(stop);
    }
  }

  void take_laws() {
    for (const LawDescription& description : description_.laws) {
      const LawKind& kind = law_kind(description.kind);
      const std::string part = fmt::format("{} \"{}\"", description.kind, description.name);
      if (description.name.empty()) throw InvalidInput(description.where, fmt::format("{} needs a name", kind.title));
      refuse_unfit_name(description.name, description.where);
      const auto is_called_so = [&](const auto& other) { return other.name == description.name; };
      if (std::any_of(model_.laws.begin(), model_.laws.end(), is_called_so))
        throw InvalidInput(description.where, fmt::format("two laws are called \"{}\"", description.name));
      if (is_slider(description.name) || std::any_of(model_.stops.begin(), model_.stops.end(), is_called_so) ||
          places_.count(description.name) > 0)
        throw InvalidInput(
            description.where,
            fmt::format("{} has the name of a slider, a stop or a coordinate; results would mix them up", part));
      if (!description.joint.empty())
        throw InvalidInput(description.joint_where,
                           fmt::format("{} acts on the joint \"{}\", but the model has no [[joint]]; join two "
                                       "coordinates, with between = [\"NAME\", \"ground\"]",
                                       part, description.joint));
      LawBetween law{description.name, description.kind, ground, ground, kind.make(description, parameters_, part)};
      if (description.shares.empty())
        join(description.between, description.between_where, part, law.first, law.second);
      else
        law.shares = shares_of(description, part);
      model_.laws.push_back(std::move(law));
    }
  }

  /// u of a law as a sum of coordinates: those that are fixed drop out. A share of zero, as within a sweep, stays.
  std::vector<Share> shares_of(const LawDescription& law, const std::string& part) const {
    std::vector<Share> shares;
    for (const auto& [name, weight] : law.shares) {
      const double value = number(weight, fmt::format("{}: the share of \"{}\"", part, name));
      if (name == "ground" || fixed_.count(name) > 0) continue;
      const Index place = find(name, law.shares_where, part + " takes a share of");
      shares.push_back({place, value});
    }
    if (shares.empty())
      throw InvalidInput(law.shares_where, fmt::format("{}: no coordinate that moves has a share in its u", part));
    return shares;
  }

  void take_displacements() {
    for (const HeldDescription& held : description_.displacements) {
      const Index place = find(held.on, held.where, "a displacement is of");
      for (const Held& other : model_.held_displacements)
        if (other.coordinate == place)
          throw InvalidInput(held.where, fmt::format("\"{}\" has two displacements", held.on));
      model_.held_displacements.push_back(
          {place, number(held.value, fmt::format("the displacement of \"{}\": value", held.on))});
    }
  }

  void take_prescribed() {
    for (const PrescribedDescription& motion : description_.prescribed) {
      const Index place = find(motion.on, motion.where, "a displacement is of");
      const auto refuse = [&](const std::string& why) {
        throw InvalidInput(motion.where,
                           fmt::format("\"{}\" moves as its [[displacement]] says, and {}", motion.on, why));
      };
      const auto is_of_it = [&](const auto& other) { return other.coordinate == place; };
      if (std::any_of(model_.prescribed.begin(), model_.prescribed.end(), is_of_it)) refuse("as another one says");
      if (std::any_of(model_.held_displacements.begin(), model_.held_displacements.end(), is_of_it))
        refuse("another one holds it; a law has a value at t = 0 already");
      if (model_.position[place] != 0.0 || model_.velocity[place] != 0.0)
        refuse("it is given a position or velocity at the start; leave them out");
      if (const std::string contact = contact_at(model_, place); !contact.empty())
        refuse(
            fmt::format("\"{}\" joins it: sliders, stops and laws join what moves freely; put a light mass on a stiff "
                        "spring between, or take [base_motion], by which the ground itself moves",
                        contact));
      model_.prescribed.push_back(build_prescribed(motion, place, parameters_));
    }
    if (static_cast<Index>(model_.prescribed.size()) == model_.size())
      throw InvalidInput(description_.prescribed.empty() ? description_.where : description_.prescribed.front().where,
                         "every coordinate moves as a [[displacement]] says: nothing is left to compute");
  }

  void take_gravity(const GravityDescription& gravity) {
    if (model_.structure.is_empty())
      throw InvalidInput(gravity.where, "[gravity] acts on nodes, and there are none; give a coordinate a [[force]]");
    const auto wanted = static_cast<std::size_t>(model_.structure.dimension);
    if (gravity.acceleration.size() != wanted)
      throw InvalidInput(gravity.where, fmt::format("[gravity]: acceleration takes {} numbers, as the positions of "
                                                    "nodes do, got {}",
                                                    wanted, gravity.acceleration.size()));
    for (std::size_t i = 0; i < wanted; ++i)
      model_.gravity[static_cast<Index>(i)] = number(gravity.acceleration[i], "[gravity]: acceleration");
  }

  TimeLaw law(const TimeLawDescription& description, const std::string& part) const {
    return build_time_law(description, parameters_, part);
  }

  void take_base_motion(const BaseMotionDescription& description) {
    BaseMotion motion;
    motion.law = law(description.law, "[base_motion]");
    if (const auto* harmonic = std::get_if<HarmonicLaw>(&motion.law))
      motion.law = derivative(*harmonic, acceleration_order(description.of));
    motion.direction = Vector::Ones(model_.size());
    if (!model_.structure.is_empty()) return take_direction_of_nodes(description, std::move(motion));
    if (!description.direction.empty()) {
      motion.direction.setZero();
      take_by_name(description.direction, "[base_motion]: direction", motion.direction);
    }
    model_.base_motion = motion;
  }

  /// With nodes: `x`, `y` and `z` are the translation of the ground, other names those of coordinates.
  void take_direction_of_nodes(const BaseMotionDescription& description, BaseMotion motion) {
    motion.direction.setZero();
    if (description.direction.empty())
      throw InvalidInput(description.where,
                         "[base_motion]: with nodes it needs the direction in which the ground moves, such as "
                         "direction = { x = 1.0 }");
    std::vector<std::pair<std::string, Quantity>> by_coordinate;
    for (const auto& [name, value] : description.direction) {
      const std::size_t axis = name == "x" ? 0 : name == "y" ? 1 : name == "z" ? 2 : 3;
      if (axis < static_cast<std::size_t>(model_.structure.dimension) && places_.count(name) == 0)
        motion.translation[static_cast<Index>(axis)] = number(value, "[base_motion]: direction of " + name);
      else
        by_coordinate.emplace_back(name, value);
    }
    take_by_name(by_coordinate, "[base_motion]: direction", motion.direction);
    for (const auto& [name, value] : by_coordinate)
      if (places_.at(name) >= first_of_nodes_)
        throw InvalidInput(value.where, fmt::format("[base_motion]: direction names \"{}\"; the ground moves all nodes "
                                                    "alike, by x, y and z",
                                                    name));
    model_.base_motion = motion;
  }

  const ModelDescription& description_;
  const Parameters& parameters_;
  NegativeLoad negative_load_;
  Model model_;
  std::vector<LawBetween> pressed_;  // sliders whose load does not stay the same
  Index first_of_nodes_ = 0;
  std::unordered_map<std::string, Index> places_;
  std::unordered_set<std::string> fixed_;
  std::vector<NamedLine> lines_;
};

}  // namespace

Model build(const ModelDescription& description, const Parameters& parameters, NegativeLoad negative_load) {
  return Builder(description, parameters, negative_load).build();
}

}  // namespace rubato::model
