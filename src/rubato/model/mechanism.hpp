#pragma once

#include <rubato/model/beams/beam_forces.hpp>
#include <rubato/model/bodies/element.hpp>
#include <rubato/model/joints/bushing.hpp>
#include <rubato/model/joints/contact_element.hpp>
#include <rubato/model/joints/joint.hpp>
#include <rubato/model/joints/joint_friction.hpp>
#include <rubato/model/joints/law_element.hpp>
#include <rubato/model/joints/lock.hpp>
#include <rubato/model/joints/plane_point.hpp>
#include <rubato/model/joints/prescribed_motion.hpp>
#include <rubato/model/joints/space_coordinate.hpp>
#include <rubato/model/joints/space_point.hpp>
#include <rubato/model/mechanism_drawing.hpp>
#include <rubato/model/structure.hpp>
#include <rubato/model/time_law.hpp>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace rubato::model {

/// A node of a mechanism: a point with axes of its own.
struct MechanismNode {
  std::string name;
  std::array<double, 7> numbers{};     ///< at the start: see Motion; the plane uses three
  std::array<double, 6> velocity{};    ///< at the start, by the axes x, y, z, rx, ry, rz
  std::array<bool, 6> has_velocity{};  ///< whether it is given, and not left out
  std::array<Index, 6> place{};        ///< tangent coordinate of each axis; `ground` where fixed or absent
};

/// What it takes to accelerate one axis of a node because another moves: a symmetric pair counts once.
struct MassEntry {
  Index node = 0, other_node = 0;
  std::size_t axis = 0, other_axis = 0;
  double value = 0.0;  ///< [kg], [kg m] or [kg m2]
};

/// The rate that the coordinate of a joint has at the start.
struct StartRate {
  std::string name;  ///< of the joint
  FreeCoordinate s;
  double rate = 0.0;  ///< [rad/s] or [m/s]
  Location where;
};

/// A force along an axis of the world on a tangent coordinate, or a moment about an axis of the node.
struct NodeForce {
  Index coordinate = 0;
  TimeLaw law;  ///< [N] or [N m]
};

/// The coordinate that a joint leaves free, for the results.
struct JointCoordinate {
  std::string name;  ///< of the joint
  PlaneCoordinate s;
};

/// Likewise in space, where a cylindrical joint and a screw have two.
struct SpaceJointCoordinate {
  std::string name;
  SpaceCoordinate s;
};

/// What a joint in space does to its second part, for the results: of a distance its tension, of the others a force and
/// a moment about the point where it holds.
struct SpaceReaction {
  std::size_t joint = 0;  ///< of the joints of the mechanism
  SpacePoint at;          ///< on the second part
  bool is_tension = false;
};

/// An angle whose whole turns are counted in the configuration: see SpaceCoordinate.
struct TurnCounter {
  SpacePoint first, second;
  TurnAngle angle;
};

/// Nodes, what makes forces between them and what constrains them, with values for everything. Mass is constant: bodies
/// have their node at the centre of mass, and angular velocities are those of body axes.
struct Mechanism {
  int dimension = 2;
  std::vector<MechanismNode> nodes;      ///< the first is the ground
  std::vector<std::string> coordinates;  ///< tangent coordinates, "NODE.x" [n]
  std::vector<char> is_rotation;         ///< [n]
  std::vector<MassEntry> masses;
  std::vector<std::unique_ptr<Element>> elements;
  std::vector<BeamPart> beam_parts;
  std::vector<std::unique_ptr<Joint>> joints;
  std::vector<JointCoordinate> joint_coordinates;       ///< in the plane
  std::vector<SpaceJointCoordinate> space_coordinates;  ///< in space
  std::vector<SpaceReaction> reactions;                 ///< in space
  std::vector<TurnCounter> turn_counters;
  std::vector<Lock> locks;
  std::vector<StartRate> start_rates;
  std::vector<Bushing> bushings;
  std::vector<PrescribedMotion> drives;
  std::vector<JointFriction> frictions;  ///< of two that share a limit the first, which leads, comes before the other
  std::vector<MechanismLaw> laws;
  std::vector<MechanismContact> contacts;
  Index law_memory_size = 0;  ///< of all laws and contacts together
  std::vector<NodeForce> forces;
  std::vector<TimeLaw> following_laws;  ///< of forces and moments that are elements, for when they are not smooth
  std::vector<numerics::Formula> joint_formulas;  ///< laws of joints that switch with time, for when they do
  Axis gravity = Axis::Zero();                    ///< [m/s2]
  double reference = 0.0;                         ///< characteristic size for error measures [m sqrt(kg)]; 0: none
  MechanismDrawing drawing;

  explicit Mechanism(int dimension_ = 2);

  Index size() const { return static_cast<Index>(coordinates.size()); }
  int numbers_a_node() const { return dimension == 2 ? plane_numbers : space_numbers; }

  /// Adds a node in the plane.
  /// @param is_free  x, y, angle: which of them move
  /// @return its index
  Index add_node(const std::string& name, const std::array<double, 3>& position,
                 const std::array<bool, 3>& is_free = {true, true, true});
  /// Adds a node in space.
  /// @param rotation  turns its axes into those of the world
  /// @param is_free   x, y, z and the three body axes: which of them move
  Index add_space_node(const std::string& name, const numerics::Vector3& position, const numerics::Rotation& rotation,
                       const std::array<bool, 6>& is_free = {true, true, true, true, true, true});
  /// Gives a node in space a body whose centre of mass it is: mass, inertia, and the gyroscopic moment.
  /// @param inertia  in the axes of the node [kg m2]
  void add_space_body(Index node, double mass, const numerics::Matrix3& inertia);
  /// The inertia and the gyroscopic moment alone.
  void add_space_inertia(Index node, const numerics::Matrix3& inertia);
  SpaceNode space_node(Index node) const;
  /// Counts the turns of an angle. Call it when all nodes are there: their numbers come first.
  /// @return where in q
  Index add_turn_counter(const TurnCounter& counter);
  /// All numbers of all nodes at the start.
  std::vector<double> numbers() const;
  PlaneNode plane_node(Index node) const;
  /// The point of a node that lies at (x, y) of the world at the start.
  PlanePoint plane_point(Index node, double x, double y) const;
  /// The point of a node in space that lies at a point of the world at the start.
  SpacePoint space_point(Index node, const numerics::Vector3& at) const;
  /// A lock with the parts that make it: a spring and a damper, or a constraint; of a [[stop]] a force. A latch with a
  /// stiffness keeps it for good. What it turns off is made with AtLock{index, 1, false}.
  /// @return its index
  int add_lock(Lock lock);
  /// Adds friction, with the constraint that lets it stick. @return its index
  int add_friction(JointFriction friction);
  /// Adds a friction that shares its limit with another of the same joint: of the same coefficient, load and rows.
  /// @param arm  of its slip velocity over the rate of s
  int add_shared_friction(int leader, const FreeCoordinate& s, double arm);
  /// Adds a law with the element that makes its force.
  /// @param kind    its table in the study file
  /// @param normal    what presses on one that takes a normal force; of other laws and of stops those that are there
  /// @param reaction  what presses on it instead
  void add_law(const std::string& name, const std::string& kind, const LawCoordinate& u, std::shared_ptr<const Law> law,
               const NormalForce& normal = {}, const PressingReaction& reaction = {});
  /// Adds a contact with the element that makes its forces; its index, memory and element are set.
  void add_contact(MechanismContact contact);
  /// A force along an axis of a node that turns with it: see make_following_force.
  void add_following_force(const std::string& name, const PlanePoint& point, std::size_t axis, const TimeLaw& law);
  void add_following_force(const std::string& name, const SpacePoint& point, std::size_t axis, const TimeLaw& law);
  /// A moment about an axis of the world on a node in space: see make_fixed_moment.
  void add_fixed_moment(const std::string& name, Index node, std::size_t axis, const TimeLaw& law);
  /// Moves a coordinate as a law says. @param name  of the joint
  template <class Coordinate>
  void add_drive(const std::string& name, const Coordinate& s, const MotionLaw& law) {
    drives.push_back({name, law, static_cast<int>(joints.size())});
    joints.push_back(std::make_unique<PrescribedJoint<Coordinate>>(name, s, law));
  }
  /// Mass, and in the plane a moment of inertia, at a node.
  void add_mass(Index node, double mass, double inertia = 0.0);
};

}  // namespace rubato::model
