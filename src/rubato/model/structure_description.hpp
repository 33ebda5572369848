#pragma once

#include <rubato/model/quantity.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

// Nodes in the plane or in space and what joins them, as the user wrote it. Part of model/description.hpp.
namespace rubato::model {

struct NodeDescription {
  std::string name;
  std::vector<Quantity> position;          ///< two numbers in the plane, three in space [m]
  std::vector<Quantity> velocity;          ///< at the start [m/s]; at rest unless given
  std::vector<Quantity> angular_velocity;  ///< at the start, one number in the plane, three in space [rad/s]
  Location where, velocity_where, angular_velocity_where;
};

struct MaterialDescription {
  std::string name;
  Quantity young;                            ///< E [Pa]
  std::optional<Quantity> poisson;           ///< nu [-]; gives G = E / (2 (1 + nu))
  std::optional<Quantity> shear_modulus;     ///< G [Pa], instead
  Quantity density;                          ///< [kg/m3]
  std::optional<Quantity> retardation_time;  ///< tau [s]: stress = E (strain + tau strain rate); none: 0
  Location where;
};

struct SectionDescription {
  std::string name;
  Quantity area;                       ///< [m2]
  std::vector<Quantity> inertia;       ///< I in the plane, Iy and Iz in space [m4]; none: trusses only
  std::optional<Quantity> torsion;     ///< torsion constant, in space [m4]
  std::vector<Quantity> shear_factor;  ///< shear area over area; one, or in space one for local y and one for z
  Location where;
};

/// What a straight line between two nodes is made of.
struct LineDescription {
  std::string name;  ///< FIRST-SECOND unless given
  std::array<std::string, 2> nodes;
  std::array<Location, 2> nodes_where;
  std::string section, material;
  Location section_where, material_where;
  bool lumped_mass = false;
  Location where;
};

struct BeamDescription : LineDescription {
  enum class Formulation { timoshenko, euler_bernoulli, geometrically_exact };
  Formulation formulation = Formulation::timoshenko;
  int elements = 1;
  /// Degrees of freedom in the beam's own axes ("x", ..., "rz") that its first and its second end do not share with
  /// the node.
  std::array<std::vector<std::string>, 2> release;
  Location release_where;
  std::vector<Quantity> orientation;  ///< in space: a vector in the local x-y plane, not along the beam; may be empty
  Location orientation_where;
};

struct TrussDescription : LineDescription {};

struct PointMassDescription {
  std::string node;
  std::optional<Quantity> mass;   ///< [kg]
  std::vector<Quantity> inertia;  ///< about z in the plane; about x, y, z in space [kg m2]
  Location node_where, where;
};

struct SupportDescription {
  std::string node;
  std::vector<std::string> fix;  ///< "x", "y", "z", "rx", "ry", "rz"
  std::vector<Location> fix_where;
  Location node_where, where;
};

struct StructureDescription {
  std::vector<NodeDescription> nodes;
  std::vector<MaterialDescription> materials;
  std::vector<SectionDescription> sections;
  std::vector<BeamDescription> beams;
  std::vector<TrussDescription> trusses;
  std::vector<PointMassDescription> masses;
  std::vector<SupportDescription> supports;

  bool is_empty() const { return nodes.empty(); }
};

}  // namespace rubato::model
