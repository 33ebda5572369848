#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/joints/plane_spring.hpp>
#include <rubato/model/mechanism.hpp>
#include <rubato/model/quantity.hpp>

#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

// Private to the model floor: what the builders of the parts of a mechanism share.
namespace rubato::model {

/// A mechanism on its way from its description: what there is so far, by the user's names, and how values are read.
struct MechanismAssembly {
  const ModelDescription& description;
  const numerics::Parameters& parameters;
  Mechanism mechanism;
  std::unordered_map<std::string, Index> nodes;  ///< and bodies
  std::unordered_set<std::string> fixed;         ///< "NODE.rx" held by supports
  std::vector<std::string> joint_names;
  std::vector<double> start;  ///< all numbers of all nodes, once they are there, then of counters of turns
  Axis low = Axis::Constant(HUGE_VAL), high = Axis::Constant(-HUGE_VAL);  ///< the box around all places
  double mass = 0.0, inertia = 0.0;                                       ///< of the error measure
  std::size_t elements = 0;                                               ///< beams and links

  /// Decides by the first node or body whether it lies in the plane or in space.
  MechanismAssembly(const ModelDescription& description_, const numerics::Parameters& parameters_);

  bool in_plane() const { return mechanism.dimension == 2; }
  double number(const Quantity& quantity, const std::string& what) const;
  double positive(const Quantity& quantity, const std::string& what) const;
  double at_least_zero(const Quantity& quantity, const std::string& what) const;
  /// An angle in radians; many write degrees.
  double angle(const Quantity& quantity, const std::string& what) const;
  /// Two numbers in the plane, three in space.
  Axis point(const std::vector<Quantity>& values, const Location& where, const std::string& what) const;
  /// Of length 1. Throws InvalidInput for one that has none.
  Axis direction(const std::vector<Quantity>& values, const Location& where, const std::string& part,
                 const std::string& key) const;

  Axis position(Index node) const;
  /// Whether the axes of a node in space can turn, or are held: those of a mass that does not turn are unknown.
  bool has_axes(Index node) const;
  void extend(const Axis& place);
  bool is_body(const std::string& name) const;
  /// The coordinate of a name. Throws InvalidInput for one that a support holds, or that is none.
  Index free_coordinate(const std::string& name, const Location& where, const std::string& role) const;
};

/// Where in q the coordinate of a name stands; "ground" stands nowhere. Throws InvalidInput for a rotation in space.
/// @param remedy  what to take instead of such a rotation
NodeNumber number_of(const MechanismAssembly& assembly, const std::string& name, const Location& where,
                     const std::string& part, const std::string& remedy);

/// Where a joint holds its two parts, in the configuration given.
struct JointPlaces {
  std::array<Index, 2> node{};  ///< 0: the ground
  std::array<Axis, 2> at{};     ///< [m]
  bool is_ground(std::size_t end) const { return node[end] == 0; }
};

/// Looks up the parts of a joint and where it holds them, and takes its name. Throws InvalidInput.
/// @param part  "joint \"A\"", for messages
JointPlaces take_places(MechanismAssembly& assembly, const JointDescription& joint, const std::string& part);

/// The length of a distance joint, as given or as its ends lie. Throws InvalidInput where there is none.
double length_of(const MechanismAssembly& assembly, const JointDescription& joint, const std::string& part,
                 const JointPlaces& places);

/// Throws InvalidInput for a law, slider, stop or contact without a name, or with that of another or of a joint.
/// @param title  "a slider"   @param part  "slider \"A\"", for messages
void refuse_taken_name(const MechanismAssembly& assembly, const LawDescription& law, const std::string& title,
                       const std::string& part);

// Each takes its parts of the description into the assembly, in this order. Throws InvalidInput.
void take_structure(MechanismAssembly& assembly);
void take_body(MechanismAssembly& assembly, const BodyDescription& body);
void take_plane_joint(MechanismAssembly& assembly, const JointDescription& joint);
void take_space_joint(MechanismAssembly& assembly, const JointDescription& joint);
void take_gear(MechanismAssembly& assembly, const GearDescription& gear);
void take_bushing(MechanismAssembly& assembly, const BushingDescription& bushing);
void take_springs(MechanismAssembly& assembly);
void take_local_laws(MechanismAssembly& assembly);
void take_stops(MechanismAssembly& assembly);
void take_sliders(MechanismAssembly& assembly);
void take_contacts(MechanismAssembly& assembly);
void take_force(MechanismAssembly& assembly, const ForceDescription& force);

}  // namespace rubato::model
