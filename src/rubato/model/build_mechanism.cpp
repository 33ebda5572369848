#include <rubato/model/beams/geometrically_exact.hpp>
#include <rubato/model/build_mechanism.hpp>
#include <rubato/model/build_parts.hpp>
#include <rubato/model/build_structure.hpp>
#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/model/joints/plane_spring.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <unordered_set>

namespace rubato::model {
namespace {

using numerics::Parameters;

constexpr double largest_angle = 2.0 * std::numbers::pi;

class MechanismBuilder {
 public:
  MechanismBuilder(const ModelDescription& description, const Parameters& parameters)
      : description_(description), parameters_(parameters) {}

  Mechanism build() {
    refuse_foreign_parts();
    if (!description_.structure.is_empty()) take_structure();
    for (const BodyDescription& body : description_.bodies) take_body(body);
    for (const JointDescription& joint : description_.joints) take_joint(joint);
    take_springs();
    for (const ForceDescription& force : description_.forces) take_force(force);
    if (description_.gravity) take_gravity(*description_.gravity);
    take_reference();
    return std::move(mechanism_);
  }

 private:
  double number(const Quantity& quantity, const std::string& what) const {
    return evaluate(quantity, parameters_, what);
  }
  double positive(const Quantity& quantity, const std::string& what) const {
    const double value = number(quantity, what);
    if (!(value > 0.0)) throw InvalidInput(quantity.where, fmt::format("{} must be positive, got {}", what, value));
    return value;
  }
  double at_least_zero(const Quantity& quantity, const std::string& what) const {
    const double value = number(quantity, what);
    if (!(value >= 0.0))
      throw InvalidInput(quantity.where, fmt::format("{} must not be negative, got {}", what, value));
    return value;
  }
  /// An angle in radians; many write degrees.
  double angle(const Quantity& quantity, const std::string& what) const {
    const double value = number(quantity, what);
    if (!(std::abs(value) <= largest_angle))
      throw InvalidInput(quantity.where,
                         fmt::format("{} is {} rad, more than a turn; if degrees are meant, write \"{} * pi/180\"",
                                     what, value, value));
    return value;
  }
  std::array<double, 2> point(const std::vector<Quantity>& values, const Location& where,
                              const std::string& what) const {
    if (values.size() != 2)
      throw InvalidInput(where, fmt::format("{} takes two numbers in the plane, got {}{}", what, values.size(),
                                            values.size() == 3 ? "; mechanisms in space are not available" : ""));
    return {number(values[0], what), number(values[1], what)};
  }

  [[noreturn]] static void refuse(const Location& where, const std::string& part, const std::string& remedy) {
    throw InvalidInput(where, fmt::format("{} does not go with a mechanism (bodies, joints, geometrically exact "
                                          "beams); {}",
                                          part, remedy));
  }

  void refuse_foreign_parts() const {
    const ModelDescription& d = description_;
    if (d.matrices) refuse(d.matrices->where, "[matrices]", "describe the structure by nodes and beams");
    if (!d.coordinates.empty())
      refuse(d.coordinates.front().where, "a [[coordinate]]", "take a [[node]] with a [[mass]]");
    if (!d.sliders.empty()) refuse(d.sliders.front().where, "a [[slider]]", "give a joint damping instead");
    if (d.base_motion) refuse(d.base_motion->where, "[base_motion]", "apply forces");
    if (const auto* modal = std::get_if<ModalDamping>(&d.damping))
      refuse(modal->where, "[damping]", "take a [[damper]]");
    if (const auto* rayleigh = std::get_if<RayleighDamping>(&d.damping))
      refuse(rayleigh->where, "[damping]", "take a [[damper]]");
    if (!d.distributed_forces.empty())
      refuse(d.distributed_forces.front().where, "a [[distributed_force]]", "apply forces at nodes");
    if (!d.displacements.empty())
      refuse(d.displacements.front().where, "a [[displacement]]", "give the configuration from which to start");
    if (!d.held_forces.empty()) refuse(d.held_forces.front().where, "a held force", "give the force a law of t");
    if (!d.structure.trusses.empty())
      refuse(d.structure.trusses.front().where, "a [[truss]]", "take a joint of type \"distance\", or a beam");
    for (const BeamDescription& beam : d.structure.beams)
      if (beam.formulation != BeamDescription::Formulation::geometrically_exact)
        refuse(beam.where, fmt::format("the beam from \"{}\" to \"{}\"", beam.nodes[0], beam.nodes[1]),
               "its displacements must be small: take formulation = \"geometrically_exact\"");
  }

  void take_structure() {
    const BuiltStructure built = build_structure(description_.structure, parameters_, 0);
    const Structure& structure = built.structure;
    if (structure.dimension == 3)
      throw InvalidInput(description_.structure.nodes.front().where,
                         "mechanisms in space are not available; give nodes two numbers for their position");
    fixed_ = built.fixed;
    for (std::size_t i = 0; i < structure.names.size(); ++i) {
      const auto& places = structure.places[i];
      const Axis& at = structure.positions[i];
      const Index node = mechanism_.add_node(structure.names[i], {at[0], at[1], 0.0},
                                             {places[0] != ground, places[1] != ground, places[5] != ground});
      nodes_.emplace(structure.names[i], node);
      extend(at[0], at[1]);
      for (const std::size_t axis : {0u, 1u, 5u}) {
        if (places[axis] == ground) continue;
        const double mass = built.coordinates[static_cast<std::size_t>(places[axis])].mass;
        if (mass > 0.0) mechanism_.masses.push_back({node, node, axis, axis, mass});
        if (axis == 0) mass_ += mass;
        if (axis == 5) inertia_ += mass;
      }
    }
    for (std::size_t i = 0; i < structure.elements.size(); ++i) take_element(structure, i);
    elements_ += structure.elements.size();
  }

  void take_element(const Structure& structure, std::size_t index) {
    const LineElement& element = structure.elements[index];
    const LineProperties& p = structure.properties[static_cast<std::size_t>(element.properties)];
    const Index first = element.first + 1, second = element.second + 1;  // after the ground
    const auto at = [&](Index node) {
      const auto& numbers = mechanism_.nodes[static_cast<std::size_t>(node)].numbers;
      return std::array<double, 3>{numbers[0], numbers[1], numbers[2]};
    };
    const double length = (structure.positions[static_cast<std::size_t>(element.second)] -
                           structure.positions[static_cast<std::size_t>(element.first)])
                              .norm();
    mechanism_.lines.push_back(
        {DrawnLine::Kind::beam, {mechanism_.plane_node(first), {}}, {mechanism_.plane_node(second), {}}});
    mechanism_.elements.push_back(
        make_plane_beam(fmt::format("{}-{}", mechanism_.nodes[static_cast<std::size_t>(first)].name,
                                    mechanism_.nodes[static_cast<std::size_t>(second)].name),
                        mechanism_.plane_node(first), mechanism_.plane_node(second), at(first), at(second),
                        {p.young * p.area, p.shear_modulus * p.shear_area_y, p.young * p.inertia_z}));
    for (const std::size_t axis : {0u, 1u, 5u}) {
      const double mass = p.density * (axis == 5 ? p.inertia_z : p.area) * length;
      const double same = p.lumped_mass ? mass / 2.0 : mass / 3.0;
      mechanism_.masses.push_back({first, first, axis, axis, same});
      mechanism_.masses.push_back({second, second, axis, axis, same});
      if (!p.lumped_mass) mechanism_.masses.push_back({first, second, axis, axis, mass / 6.0});
      if (axis == 0) mass_ += mass;
    }
  }

  void take_body(const BodyDescription& body) {
    const std::string part = fmt::format("body \"{}\": ", body.name);
    refuse_unfit_name(body.name, body.where);
    if (body.name.empty() || body.name == "ground")
      throw InvalidInput(body.where, body.name.empty() ? "a body needs a name"
                                                       : "the name \"ground\" is taken: it stands for what does not "
                                                         "move");
    if (nodes_.count(body.name) > 0)
      throw InvalidInput(body.where, fmt::format("two nodes or bodies are called \"{}\"", body.name));
    const double mass = positive(body.mass, part + "mass");
    if (body.inertia.size() != 1)
      throw InvalidInput(body.where,
                         fmt::format("{}inertia takes one number in the plane, got {}", part, body.inertia.size()));
    const double inertia = number(body.inertia[0], part + "inertia");
    if (!(inertia > 0.0))
      throw InvalidInput(body.inertia[0].where,
                         fmt::format("{}inertia must be positive, got {}: its rotation is free; a mass that does not "
                                     "turn is a [[node]] with a [[mass]]",
                                     part, inertia));
    const auto at = point(body.position, body.where, part + "position");
    const double turn = body.angle ? angle(*body.angle, part + "angle") : 0.0;
    const Index node = mechanism_.add_node(body.name, {at[0], at[1], turn});
    mechanism_.add_mass(node, mass, inertia);
    auto& velocity = mechanism_.nodes[static_cast<std::size_t>(node)].velocity;
    if (!body.velocity.empty()) {
      const auto given = point(body.velocity, body.where, part + "velocity");
      velocity[0] = given[0];
      velocity[1] = given[1];
    }
    if (body.angular_velocity.size() > 1)
      throw InvalidInput(body.where, part + "angular_velocity takes one number in the plane");
    if (!body.angular_velocity.empty()) velocity[5] = number(body.angular_velocity[0], part + "angular_velocity");
    nodes_.emplace(body.name, node);
    extend(at[0], at[1]);
    mass_ += mass;
    inertia_ += inertia;
  }

  void take_force(const ForceDescription& force) {
    const std::string part = fmt::format("the force on \"{}\"", force.on);
    const Index coordinate = free_coordinate(force.on, force.where, "a force is on");
    const TimeLaw law = build_time_law(force.law, parameters_, part);
    for (std::size_t i = 0; force.follows && i < mechanism_.nodes.size(); ++i)
      for (const std::size_t axis : {0u, 1u}) {
        if (mechanism_.nodes[i].place[axis] != coordinate) continue;
        const auto node = static_cast<Index>(i);
        const auto& numbers = mechanism_.nodes[i].numbers;
        const std::array<double, 2> at = force.at.empty() ? std::array<double, 2>{numbers[0], numbers[1]}
                                                          : point(force.at, force.at_where, part + ": at");
        mechanism_.add_following_force(part, mechanism_.plane_point(node, at[0], at[1]), axis, law);
        return;
      }
    // A moment of the plane is the same however its node turns.
    mechanism_.forces.push_back({coordinate, law});
  }

  struct End {
    Index node = 0;
    bool is_ground = false;
    std::array<double, 2> position{};
  };
  End end_of(const JointDescription& joint, std::size_t i, const std::string& part) const {
    const std::string& name = joint.between[i];
    if (name == "ground") return {0, true, {}};
    const auto found = nodes_.find(name);
    if (found == nodes_.end()) {
      std::vector<std::string> known;
      for (const auto& node : mechanism_.nodes) known.push_back(node.name);
      throw InvalidInput(joint.between_where[i], fmt::format("{} joins \"{}\", which is no node and no body{}", part,
                                                             name, suggestion(name, known)));
    }
    const auto& numbers = mechanism_.nodes[static_cast<std::size_t>(found->second)].numbers;
    return {found->second, false, {numbers[0], numbers[1]}};
  }
  bool is_body(const std::string& name) const {
    return std::any_of(description_.bodies.begin(), description_.bodies.end(),
                       [&](const BodyDescription& body) { return body.name == name; });
  }

  void take_joint(const JointDescription& joint) {
    using Type = JointDescription::Type;
    const std::string part = fmt::format("joint \"{}\"", joint.name);
    refuse_unfit_name(joint.name, joint.where);
    for (const std::string& other : joint_names_)
      if (other == joint.name) throw InvalidInput(joint.where, fmt::format("two joints are called \"{}\"", joint.name));
    joint_names_.push_back(joint.name);
    const End first = end_of(joint, 0, part), second = end_of(joint, 1, part);
    if (first.node == second.node)
      throw InvalidInput(joint.between_where[1], fmt::format("{} joins \"{}\" with itself", part, joint.between[1]));
    const bool is_distance = joint.type == Type::distance;
    // A joint sits at its node; a body has many places for one.
    std::array<double, 2> at{}, to{};
    const bool first_is_node = !first.is_ground && !is_body(joint.between[0]);
    const bool second_is_node = !second.is_ground && !is_body(joint.between[1]);
    if (!joint.at.empty())
      at = point(joint.at, joint.at_where, part + ": at");
    else if (first_is_node || (is_distance && !first.is_ground))
      at = first.position;
    else if (second_is_node && !is_distance)
      at = second.position;
    else
      throw InvalidInput(joint.where, fmt::format("{} needs \"at\", its place in the configuration given [m]", part));
    if (!joint.to.empty())
      to = point(joint.to, joint.to_where, part + ": to");
    else if (is_distance && second.is_ground)
      throw InvalidInput(joint.where, fmt::format("{} needs \"to\", the place of its second end [m]", part));
    else
      to = is_distance || (second_is_node && joint.at.empty()) ? second.position : at;
    extend(at[0], at[1]);
    extend(to[0], to[1]);
    const PlanePoint a = mechanism_.plane_point(first.node, at[0], at[1]);
    const PlanePoint b = mechanism_.plane_point(second.node, to[0], to[1]);
    draw(first, a);
    draw(second, b);
    if (is_distance) mechanism_.lines.push_back({DrawnLine::Kind::link, a, b});
    const double relative = mechanism_.nodes[static_cast<std::size_t>(second.node)].numbers[2] -
                            mechanism_.nodes[static_cast<std::size_t>(first.node)].numbers[2];
    PlaneCoordinate s;
    s.along = {a, b, {1.0, 0.0}};
    switch (joint.type) {
      case Type::rigid:
        mechanism_.joints.push_back(make_plane_rigid(joint.name, a, b, relative));
        return;
      case Type::distance:
        take_distance(joint, part, a, b, std::hypot(to[0] - at[0], to[1] - at[1]));
        return;
      case Type::revolute:
        mechanism_.joints.push_back(make_plane_revolute(joint.name, a, b));
        break;
      case Type::prismatic:
        s.kind = PlaneCoordinate::Kind::displacement;
        s.along.direction = axis_of(joint, part, first.node);
        mechanism_.joints.push_back(make_plane_prismatic(joint.name, a, b, s.along.direction, relative));
        break;
    }
    take_coordinate(joint, part, s);
  }

  /// A body reaches from its centre of mass to its joints.
  void draw(const End& end, const PlanePoint& point) {
    if (end.is_ground || (point.offset[0] == 0.0 && point.offset[1] == 0.0)) return;
    mechanism_.lines.push_back({DrawnLine::Kind::body, {point.node, {}}, point});
  }

  void take_distance(const JointDescription& joint, const std::string& part, const PlanePoint& a, const PlanePoint& b,
                     double between) {
    const double length = joint.length ? positive(*joint.length, part + ": length") : between;
    if (!(length > 0.0))
      throw InvalidInput(joint.where, fmt::format("{} has no length: its ends lie in the same place", part));
    mechanism_.joints.push_back(make_plane_distance(joint.name, a, b, length));
    ++elements_;
  }

  /// In the axes of the first node, of length 1.
  std::array<double, 2> axis_of(const JointDescription& joint, const std::string& part, Index first) const {
    const auto axis = point(joint.axis, joint.axis_where, part + ": axis");
    const double length = std::hypot(axis[0], axis[1]);
    if (!(length > 0.0) || !std::isfinite(length))
      throw InvalidInput(joint.axis_where, fmt::format("{}: the axis [{}, {}] has no length", part, axis[0], axis[1]));
    const double turn = mechanism_.nodes[static_cast<std::size_t>(first)].numbers[2];
    const double c = std::cos(turn) / length, s = std::sin(turn) / length;
    return {c * axis[0] + s * axis[1], -s * axis[0] + c * axis[1]};
  }

  /// The law, the spring, the damper and the lock on what a joint leaves free.
  void take_coordinate(const JointDescription& joint, const std::string& part, PlaneCoordinate s) {
    const bool is_angle = s.kind == PlaneCoordinate::Kind::angle;
    const std::string name = is_angle ? "angle" : "displacement";
    const double value = !joint.value ? 0.0
                         : is_angle   ? angle(*joint.value, part + ": angle")
                                      : number(*joint.value, part + ": displacement");
    Vector q(static_cast<Index>(mechanism_.nodes.size()) * plane_numbers);
    for (std::size_t i = 0; i < mechanism_.nodes.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        q[static_cast<Index>(i) * plane_numbers + static_cast<Index>(k)] = mechanism_.nodes[i].numbers[k];
    s.zero = s.value(q.data()) - value;
    mechanism_.joint_coordinates.push_back({joint.name, s});
    if (joint.motion) take_motion(joint, part, s, value);
    if (joint.friction) take_friction(joint, part, s);
    AtLock drive;
    if (joint.lock) {
      const Lock lock = lock_of(joint, part, s, value);
      const int index = mechanism_.add_lock(lock);
      if (lock.is_latch) drive = {index, false};
    }
    if (joint.drive) {
      const std::string text =
          joint.drive->expression.empty() ? fmt::format("{}", joint.drive->value) : joint.drive->expression;
      try {
        mechanism_.elements.push_back(make_joint_drive(joint.name, s, text, parameters_, drive));
      } catch (const InvalidInput& fault) {
        throw InvalidInput(joint.drive->where,
                           fmt::format("{}: {}: {}", part, is_angle ? "moment" : "force", fault.message()));
      }
    }
    if (joint.stiffness) {
      const double rest = joint.rest ? number(*joint.rest, part + ": rest") : value;
      mechanism_.elements.push_back(
          make_joint_spring(joint.name, s, at_least_zero(*joint.stiffness, part + ": stiffness"), rest));
    }
    if (joint.damping)
      mechanism_.elements.push_back(
          make_joint_damper(joint.name, s, at_least_zero(*joint.damping, part + ": damping")));
  }

  /// The drive that moves a joint's coordinate.
  /// @param value  of the coordinate in the configuration given
  void take_motion(const JointDescription& joint, const std::string& part, const PlaneCoordinate& s, double value) {
    const DriveDescription& drive = *joint.motion;
    if (joint.lock)
      throw InvalidInput(
          joint.lock->where,
          fmt::format("{} has a drive and a lock: what is driven cannot lock; leave one out, or drive it "
                      "by a {}",
                      part, s.kind == PlaneCoordinate::Kind::angle ? "moment" : "force"));
    const MotionLaw law = build_motion_law(drive, part);
    const numerics::TimeDerivatives start = derivatives(law, 0.0, Side::right);
    if (!std::isfinite(start.value) || !std::isfinite(start.rate) || !std::isfinite(start.second_rate))
      throw InvalidInput(drive.where, fmt::format("{}: the drive has no finite value, rate and second rate at t = 0 "
                                                  "({}, {}, {})",
                                                  part, start.value, start.rate, start.second_rate));
    if (s.kind == PlaneCoordinate::Kind::angle && !(std::abs(start.value - value) <= largest_angle))
      throw InvalidInput(drive.where,
                         fmt::format("{}: the drive starts at {} rad, more than a turn away from the angle {} of the "
                                     "configuration given; if degrees are meant, write \"... * pi/180\"",
                                     part, start.value, value));
    mechanism_.add_drive(joint.name, s, law);
  }

  /// The friction on a joint's coordinate.
  void take_friction(const JointDescription& joint, const std::string& part, const PlaneCoordinate& s) {
    const FrictionDescription& given = *joint.friction;
    if (joint.motion)
      throw InvalidInput(given.where,
                         fmt::format("{} has a drive and friction: while the drive stands still nothing says "
                                     "what each of them holds; give the friction to another joint, or "
                                     "drive it by a {}",
                                     part, s.kind == PlaneCoordinate::Kind::angle ? "moment" : "force"));
    JointFriction friction;
    friction.name = joint.name;
    friction.s = s;
    friction.joint = static_cast<int>(mechanism_.joints.size()) - 1;
    friction.coefficient = at_least_zero(given.coefficient, part + ": friction: coefficient");
    if (given.radius) friction.coefficient *= positive(*given.radius, part + ": friction: radius");
    if (given.preload)
      friction.preload = at_least_zero(*given.preload, part + ": friction: preload");
    else
      friction.pressing_rows = s.kind == PlaneCoordinate::Kind::angle ? 2 : 1;
    mechanism_.add_friction(std::move(friction));
  }

  MotionLaw build_motion_law(const DriveDescription& drive, const std::string& part) const {
    if (const auto* formula = std::get_if<TimeFormulaDescription>(&drive.law)) {
      try {
        return numerics::TimeFormula(formula->formula.expression, parameters_);
      } catch (const InvalidInput& fault) {
        throw InvalidInput(drive.where, fmt::format("{}: drive: {}", part, fault.message()));
      }
    }
    const TimeLaw law = build_time_law(std::get<TableDescription>(drive.law), parameters_, part + ": drive");
    const auto& table = std::get<TableLaw>(law);
    if (table.beyond == TableLaw::Beyond::zero)
      throw InvalidInput(drive.where, fmt::format("{}: drive: beyond = \"zero\" would make it jump; take \"hold\", or "
                                                  "extend the table \"{}\"",
                                                  part, table.source));
    for (std::size_t i = 1; i < table.times.size(); ++i)
      if (!(table.times[i] > table.times[i - 1]))
        throw InvalidInput(drive.where, fmt::format("{}: drive: the table \"{}\" jumps at t = {} s, and nothing moves "
                                                    "from one place to another at once; give its rows a time between",
                                                    part, table.source, table.times[i]));
    return table;
  }

  Lock lock_of(const JointDescription& joint, const std::string& part, const PlaneCoordinate& s, double value) const {
    const LockDescription& given = *joint.lock;
    const bool is_angle = s.kind == PlaneCoordinate::Kind::angle;
    Lock lock;
    lock.name = joint.name;
    lock.s = s;
    lock.is_latch = given.is_latch;
    lock.at = is_angle ? angle(given.at, part + ": lock: at") : number(given.at, part + ": lock: at");
    if (given.stiffness) lock.stiffness = positive(*given.stiffness, part + ": lock: stiffness");
    if (given.damping) lock.damping = at_least_zero(*given.damping, part + ": lock: damping");
    if (!(std::abs(lock.at - value) > 1e-9 * (1.0 + std::abs(value))))
      throw InvalidInput(given.where,
                         fmt::format("{}: lock: the joint starts at its lock, {}; say from which side it comes by "
                                     "another {}",
                                     part, lock.at, is_angle ? "angle" : "displacement"));
    lock.sign = lock.at > value ? 1.0 : -1.0;
    return lock;
  }

  Index free_coordinate(const std::string& name, const Location& where, const std::string& role) const {
    const auto& known = mechanism_.coordinates;
    const auto found = std::find(known.begin(), known.end(), name);
    if (found != known.end()) return static_cast<Index>(found - known.begin());
    if (fixed_.count(name) > 0) throw InvalidInput(where, fmt::format("{} \"{}\", which a support holds", role, name));
    throw InvalidInput(where, fmt::format("{} \"{}\", which is no coordinate{}", role, name, suggestion(name, known)));
  }

  NodeNumber number_of(const std::string& name, const Location& where, const std::string& role) const {
    if (name == "ground") return {};
    const Index place = free_coordinate(name, where, role);
    for (std::size_t i = 0; i < mechanism_.nodes.size(); ++i)
      for (const std::size_t axis : {0u, 1u, 5u})
        if (mechanism_.nodes[i].place[axis] == place)
          return {static_cast<Index>(i) * plane_numbers + static_cast<Index>(std::min<std::size_t>(axis, 2)), place};
    return {};
  }

  void take_springs() {
    const auto value = [&](const NodeNumber& n) {
      if (n.q < 0) return 0.0;
      return mechanism_.nodes[static_cast<std::size_t>(n.q / plane_numbers)]
          .numbers[static_cast<std::size_t>(n.q % plane_numbers)];
    };
    for (const SpringDescription& spring : description_.springs) {
      const std::string part =
          fmt::format("the spring between \"{}\" and \"{}\"", spring.between[0], spring.between[1]);
      const NodeNumber first = number_of(spring.between[0], spring.between_where[0], part + " joins");
      const NodeNumber second = number_of(spring.between[1], spring.between_where[1], part + " joins");
      mechanism_.elements.push_back(make_coordinate_spring(
          part, first, second, at_least_zero(spring.stiffness, part + ": stiffness"), value(first) - value(second)));
    }
    for (const DamperDescription& damper : description_.dampers) {
      const std::string part =
          fmt::format("the damper between \"{}\" and \"{}\"", damper.between[0], damper.between[1]);
      const NodeNumber first = number_of(damper.between[0], damper.between_where[0], part + " joins");
      const NodeNumber second = number_of(damper.between[1], damper.between_where[1], part + " joins");
      mechanism_.elements.push_back(
          make_coordinate_damper(part, first, second, at_least_zero(damper.damping, part + ": damping")));
    }
  }

  void take_gravity(const GravityDescription& gravity) {
    const auto value = point(gravity.acceleration, gravity.where, "[gravity]: acceleration");
    mechanism_.gravity = {value[0], value[1], 0.0};
  }

  void extend(double x, double y) {
    low_ = {std::min(low_[0], x), std::min(low_[1], y)};
    high_ = {std::max(high_[0], x), std::max(high_[1], y)};
  }

  /// Cardona and Cassano (1991), appendix A-1: three translations also in the plane; beams and links count as elements,
  /// and where there are none bodies do.
  void take_reference() {
    const std::size_t parts = elements_ > 0 ? elements_ : description_.bodies.size();
    const double box = std::hypot(high_[0] - low_[0], high_[1] - low_[1]);
    constexpr double turn = std::numbers::pi / 10.0;
    if (parts > 0 && std::isfinite(box))
      mechanism_.reference = std::sqrt(3.0 * mass_ * box * box / static_cast<double>(parts) + inertia_ * turn * turn);
  }

  const ModelDescription& description_;
  const Parameters& parameters_;
  Mechanism mechanism_{2};
  std::unordered_map<std::string, Index> nodes_;  // and bodies
  std::unordered_set<std::string> fixed_;
  std::vector<std::string> joint_names_;
  std::array<double, 2> low_{HUGE_VAL, HUGE_VAL}, high_{-HUGE_VAL, -HUGE_VAL};
  double mass_ = 0.0, inertia_ = 0.0;
  std::size_t elements_ = 0;
};

}  // namespace

bool is_mechanism(const ModelDescription& description) {
  const auto& beams = description.structure.beams;
  return !description.bodies.empty() || !description.joints.empty() ||
         std::any_of(beams.begin(), beams.end(), [](const BeamDescription& beam) {
           return beam.formulation == BeamDescription::Formulation::geometrically_exact;
         });
}

Mechanism build_mechanism(const ModelDescription& description, const Parameters& parameters) {
  return MechanismBuilder(description, parameters).build();
}

}  // namespace rubato::model
