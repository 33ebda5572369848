#include <rubato/core/error.hpp>
#include <rubato/model/bodies/following_force.hpp>
#include <rubato/model/bodies/gyroscopic.hpp>
#include <rubato/model/joints/stop_element.hpp>
#include <rubato/model/mechanism.hpp>

#include <fmt/format.h>

#include <cmath>
#include <type_traits>
#include <variant>

namespace rubato::model {

Mechanism::Mechanism(int dimension_) : dimension(dimension_) {
  MechanismNode still;
  still.name = "ground";
  still.place.fill(ground);
  if (dimension == 3) still.numbers[3] = 1.0;
  nodes.push_back(still);
}

Index Mechanism::add_node(const std::string& name, const std::array<double, 3>& position,
                          const std::array<bool, 3>& is_free) {
  MechanismNode node;
  node.name = name;
  node.place.fill(ground);
  for (std::size_t i = 0; i < 3; ++i) {
    node.numbers[i] = position[i];
    if (!is_free[i]) continue;
    const std::size_t axis = i < 2 ? i : 5;
    node.place[axis] = size();
    coordinates.push_back(name + "." + axis_names[axis]);
    is_rotation.push_back(axis == 5);
  }
  nodes.push_back(node);
  return static_cast<Index>(nodes.size()) - 1;
}

Index Mechanism::add_space_node(const std::string& name, const numerics::Vector3& position,
                                const numerics::Rotation& rotation, const std::array<bool, 6>& is_free) {
  MechanismNode node;
  node.name = name;
  node.place.fill(ground);
  node.numbers = {position[0], position[1], position[2], rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!is_free[axis]) continue;
    node.place[axis] = size();
    coordinates.push_back(name + "." + axis_names[axis]);
    is_rotation.push_back(model::is_rotation(axis));
  }
  nodes.push_back(node);
  return static_cast<Index>(nodes.size()) - 1;
}

void Mechanism::add_space_body(Index node, double mass, const numerics::Matrix3& inertia) {
  for (std::size_t axis = 0; axis < 3; ++axis) masses.push_back({node, node, axis, axis, mass});
  add_space_inertia(node, inertia);
}

void Mechanism::add_space_inertia(Index node, const numerics::Matrix3& inertia) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j) {
      const double value = inertia(static_cast<Index>(i), static_cast<Index>(j));
      if (value != 0.0) masses.push_back({node, node, 3 + i, 3 + j, value});
    }
  elements.push_back(make_gyroscopic_moment(nodes[static_cast<std::size_t>(node)].name, space_node(node), inertia));
}

Index Mechanism::add_turn_counter(const TurnCounter& counter) {
  turn_counters.push_back(counter);
  return static_cast<Index>(nodes.size()) * numbers_a_node() + static_cast<Index>(turn_counters.size()) - 1;
}

std::vector<double> Mechanism::numbers() const {
  std::vector<double> all;
  for (const MechanismNode& node : nodes)
    all.insert(all.end(), node.numbers.begin(), node.numbers.begin() + numbers_a_node());
  return all;
}

SpaceNode Mechanism::space_node(Index node) const {
  return {node * space_numbers, nodes[static_cast<std::size_t>(node)].place};
}

PlaneNode Mechanism::plane_node(Index node) const {
  const auto& place = nodes[static_cast<std::size_t>(node)].place;
  return {node * plane_numbers, {place[0], place[1], place[5]}};
}

PlanePoint Mechanism::plane_point(Index node, double x, double y) const {
  const auto& at = nodes[static_cast<std::size_t>(node)].numbers;
  const double c = std::cos(at[2]), s = std::sin(at[2]), dx = x - at[0], dy = y - at[1];
  return {plane_node(node), {c * dx + s * dy, -s * dx + c * dy}};
}

SpacePoint Mechanism::space_point(Index node, const numerics::Vector3& at) const {
  const SpaceNode place = space_node(node);
  const std::vector<double> all = numbers();
  return {place, place.rotation(all.data()).conjugate() * (at - place.position(all.data()))};
}

int Mechanism::add_lock(Lock lock) {
  const int index = static_cast<int>(locks.size());
  if (lock.is_stop_part) {
    elements.push_back(make_stop_element(lock, index));
    locks.push_back(std::move(lock));
    return index;
  }
  const AtLock when{index, 1, true};
  std::visit(
      [&](const auto& s) {
        if (lock.stiffness > 0.0) {
          elements.push_back(make_joint_spring(lock.name, s, lock.stiffness, lock.at, when));
        } else {
          lock.joint = static_cast<int>(joints.size());
          joints.push_back(make_lock_joint(lock.name, s, lock.at, index));
        }
        if (lock.damping > 0.0) elements.push_back(make_joint_damper(lock.name, s, lock.damping, when));
      },
      lock.s.of);
  locks.push_back(std::move(lock));
  return index;
}

int Mechanism::add_friction(JointFriction friction) {
  const int index = static_cast<int>(frictions.size());
  friction.sticking_joint = static_cast<int>(joints.size());
  if (friction.joint < 0) friction.joint = friction.sticking_joint;
  std::visit(
      [&](const auto& s) {
        using Coordinate = std::decay_t<decltype(s)>;
        joints.push_back(std::make_unique<StickingJoint<Coordinate>>(friction.name, s, index));
      },
      friction.s.of);
  frictions.push_back(std::move(friction));
  return index;
}

int Mechanism::add_shared_friction(int leader, const FreeCoordinate& s, double arm) {
  JointFriction second = frictions[static_cast<std::size_t>(leader)];
  second.s = s;
  second.coefficient *= arm / second.arm;
  second.arm = arm;
  second.partner = leader;
  const int index = add_friction(std::move(second));
  frictions[static_cast<std::size_t>(leader)].partner = index;
  return index;
}

void Mechanism::add_law(const std::string& name, const std::string& kind, const LawCoordinate& u,
                        std::shared_ptr<const Law> law, const NormalForce& normal, const PressingReaction& reaction) {
  MechanismLaw added{name, kind, u, std::move(law), static_cast<Index>(laws.size()), law_memory_size, elements.size()};
  added.normal = normal;
  added.reaction = reaction;
  if (normal.law >= 0) added.pressing = std::make_shared<MechanismLaw>(laws.at(static_cast<std::size_t>(normal.law)));
  if (normal.stop >= 0) added.stop = std::make_shared<Lock>(locks.at(static_cast<std::size_t>(normal.stop)));
  law_memory_size += added.law->memory_size();
  elements.push_back(make_law_element(added));
  laws.push_back(std::move(added));
}

void Mechanism::add_contact(MechanismContact contact) {
  contact.index = static_cast<Index>(contacts.size());
  contact.memory = law_memory_size;
  contact.element = elements.size();
  law_memory_size += contact.law->memory_size();
  elements.push_back(make_contact_element(contact));
  contacts.push_back(std::move(contact));
}

void Mechanism::add_following_force(const std::string& name, const PlanePoint& point, std::size_t axis,
                                    const TimeLaw& law) {
  elements.push_back(make_following_force(name, point, axis, law));
  following_laws.push_back(law);
}

void Mechanism::add_following_force(const std::string& name, const SpacePoint& point, std::size_t axis,
                                    const TimeLaw& law) {
  elements.push_back(make_following_force(name, point, axis, law));
  following_laws.push_back(law);
}

void Mechanism::add_fixed_moment(const std::string& name, Index node, std::size_t axis, const TimeLaw& law) {
  elements.push_back(make_fixed_moment(name, space_node(node), axis, law));
  following_laws.push_back(law);
}

void Mechanism::add_mass(Index node, double mass, double inertia) {
  masses.push_back({node, node, 0, 0, mass});
  masses.push_back({node, node, 1, 1, mass});
  if (dimension == 3) masses.push_back({node, node, 2, 2, mass});
  if (inertia != 0.0) masses.push_back({node, node, 5, 5, inertia});
}

}  // namespace rubato::model
