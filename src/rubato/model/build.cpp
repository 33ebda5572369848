#include <rubato/model/build_parts.hpp>
#include <rubato/model/build_structure.hpp>
#include <rubato/model/finite_elements/build_finite_elements.hpp>
#include <rubato/model/finite_elements/reduce_model.hpp>
#include <rubato/model/load_laws.hpp>
#include <rubato/model/model.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

using numerics::Parameters;

/// Looks names up and evaluates numbers, with messages that name the part.
class Builder {
 public:
  Builder(const ModelDescription& description, const Parameters& parameters, NegativeLoad negative_load)
      : description_(description),
        parameters_(parameters),
        negative_load_(negative_load),
        places_(model_, parameters, description.finite_elements != nullptr) {}

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
    build_laws(description_, parameters_, negative_load_, places_, model_);
    for (const ForceDescription& force : description_.forces) {
      if (force.follows)
        throw InvalidInput(force.follows_where, fmt::format("the force on \"{}\" follows its node, which takes a "
                                                            "mechanism; give beams formulation = "
                                                            "\"geometrically_exact\", or leave \"following\" out",
                                                            force.on));
      model_.forces.push_back({places_.find(force.on, force.where, "a force is on"),
                               law(force.law, fmt::format("the force on \"{}\"", force.on))});
    }
    for (const HeldDescription& held : description_.held_forces)
      model_.held_forces.push_back({places_.find(held.on, held.where, "a force is on"),
                                    number(held.value, fmt::format("the force on \"{}\": held", held.on))});
    for (const DistributedForceDescription& force : description_.distributed_forces)
      model_.distributed_forces.push_back(
          build_distributed_force(force, lines_, model_.structure.dimension, parameters_));
    take_displacements();
    take_prescribed();
    if (description_.gravity) take_gravity(*description_.gravity);
    if (description_.base_motion) take_base_motion(*description_.base_motion);
    reduce_finite_elements();
    return std::move(model_);
  }

 private:
  double number(const Quantity& quantity, const std::string& what) const {
    return evaluate(quantity, parameters_, what);
  }

  double at_least_zero(const Quantity& quantity, const std::string& what, const std::string& remedy = "") const {
    return model::at_least_zero(quantity, parameters_, what, remedy);
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
      places_.add(c.name, c.where);
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
      if (!places_.add_name(coordinate.name, place))
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
    places_.hold(built.fixed);
    lines_ = std::move(built.lines);
  }

  void take_finite_elements() {
    const Location& where = description_.finite_elements->where;
    first_of_nodes_ = model_.size();
    BuiltFiniteElements built = build_finite_elements(description_, parameters_, model_.mass);
    model_.is_rotation.assign(static_cast<std::size_t>(first_of_nodes_), 0);
    model_.is_rotation.insert(model_.is_rotation.end(), built.is_rotation.begin(), built.is_rotation.end());
    for (std::string& name : built.coordinates) {
      if (!places_.add_name(name, model_.size()))
        throw InvalidInput(where, fmt::format("a [[coordinate]] and a degree of freedom of [model] are both called "
                                              "\"{}\"; rename the coordinate",
                                              name));
      model_.coordinates.push_back(std::move(name));
    }
    for (Vector* values : {&model_.position, &model_.velocity}) {
      values->conservativeResize(model_.size());
      values->tail(model_.size() - first_of_nodes_).setZero();
    }
    places_.hold(built.fixed);
    places_.doubt(built.doubtful, built.doubt);
    model_.structure = std::move(built.structure);
    model_.matrices = std::move(built.matrices);
  }

  /// Last, when it is known what names which degrees of freedom.
  void reduce_finite_elements() {
    const auto* elements = description_.finite_elements.get();
    if (!elements || !elements->reduction || elements->reduction->method == ReductionMethod::none) return;
    reduce(model_, *elements, *elements->reduction, first_of_nodes_);
    const auto* modal = std::get_if<ModalDampingRatios>(&model_.damping);
    if (modal && (modal->modes > model_.size() ||
                  (modal->ratios.size() > 1 && static_cast<Index>(modal->ratios.size()) > model_.size())))
      throw InvalidInput(
          where_of(description_.damping),
          fmt::format("[damping] is of more modes than the {} of the reduced model; damp fewer", model_.size()));
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
      places_.add(name, where);
    }
    if (!matrices.names.empty())
      for (int i = 0; i < size; ++i) places_.add_name(std::to_string(i + 1), i);  // numbers serve beside names
    model_.matrices = build_matrices(matrices);
    model_.position = Vector::Zero(size);
    model_.velocity = Vector::Zero(size);
    places_.take(matrices.position, "position", model_.position);
    places_.take(matrices.velocity, "velocity", model_.velocity);
  }

  void take_springs() {
    for (const SpringDescription& spring : description_.springs) {
      const std::string part =
          fmt::format("the spring between \"{}\" and \"{}\"", spring.between[0], spring.between[1]);
      LinearElement element;
      places_.join(spring.between, spring.between_where, part, element.first, element.second);
      element.coefficient = at_least_zero(spring.stiffness, part + ": stiffness");
      model_.springs.push_back(element);
    }
    for (const DamperDescription& damper : description_.dampers) {
      const std::string part =
          fmt::format("the damper between \"{}\" and \"{}\"", damper.between[0], damper.between[1]);
      LinearElement element;
      places_.join(damper.between, damper.between_where, part, element.first, element.second);
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

  void take_displacements() {
    for (const HeldDescription& held : description_.displacements) {
      const Index place = places_.find(held.on, held.where, "a displacement is of");
      for (const Held& other : model_.held_displacements)
        if (other.coordinate == place)
          throw InvalidInput(held.where, fmt::format("\"{}\" has two displacements", held.on));
      model_.held_displacements.push_back(
          {place, number(held.value, fmt::format("the displacement of \"{}\": value", held.on))});
    }
  }

  void take_prescribed() {
    for (const PrescribedDescription& motion : description_.prescribed) {
      const Index place = places_.find(motion.on, motion.where, "a displacement is of");
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
      places_.take(description.direction, "[base_motion]: direction", motion.direction);
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
      if (axis < static_cast<std::size_t>(model_.structure.dimension) && !places_.has(name))
        motion.translation[static_cast<Index>(axis)] = number(value, "[base_motion]: direction of " + name);
      else
        by_coordinate.emplace_back(name, value);
    }
    places_.take(by_coordinate, "[base_motion]: direction", motion.direction);
    for (const auto& [name, value] : by_coordinate)
      if (places_.find(name, value.where, "[base_motion]: direction names") >= first_of_nodes_)
        throw InvalidInput(value.where, fmt::format("[base_motion]: direction names \"{}\"; the ground moves all nodes "
                                                    "alike, by x, y and z",
                                                    name));
    model_.base_motion = motion;
  }

  const ModelDescription& description_;
  const Parameters& parameters_;
  NegativeLoad negative_load_;
  Model model_;
  Places places_;
  Index first_of_nodes_ = 0;
  std::vector<NamedLine> lines_;
};

}  // namespace

Model build(const ModelDescription& description, const Parameters& parameters, NegativeLoad negative_load) {
  return Builder(description, parameters, negative_load).build();
}

}  // namespace rubato::model
