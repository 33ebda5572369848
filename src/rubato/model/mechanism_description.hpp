#pragma once

#include <rubato/model/quantity.hpp>
#include <rubato/model/time_law_description.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

// Bodies and the joints between them, as the user wrote it. Part of model/description.hpp.
namespace rubato::model {

/// A body of one material, from which its mass and its inertia follow.
struct ShapeDescription {
  enum class Kind { box, cylinder, sphere };
  Kind kind = Kind::box;
  std::vector<Quantity> size;              ///< of a box, along x, y and z of the body [m]
  std::optional<Quantity> radius, length;  ///< of a cylinder along z of the body, of a sphere [m]
  std::optional<Quantity> density;         ///< [kg/m3]; or the mass of the body
  Location where;
};

struct BodyDescription {
  std::string name;
  std::optional<Quantity> mass;  ///< [kg]; of a shape it may follow from the density
  /// About the centre of mass, in the axes of the body [kg m2]: one number in the plane; in space xx, yy, zz, or these
  /// and xy, xz, yz of the matrix. Of a shape it follows.
  std::vector<Quantity> inertia;
  std::optional<ShapeDescription> shape;
  std::vector<Quantity> position;          ///< of the centre of mass at the start [m]
  std::optional<Quantity> angle;           ///< at the start, in the plane [rad]; 0 unless given
  std::vector<Quantity> rotation;          ///< at the start, in space: a rotation vector [rad]; none unless given
  std::vector<Quantity> velocity;          ///< at the start [m/s]; at rest unless given
  std::vector<Quantity> angular_velocity;  ///< at the start [rad/s]; in space about the axes of the body
  Location where, inertia_where, rotation_where;
};

/// A limit of the coordinate of a joint.
struct LockDescription {
  enum class Side { below, above };
  Quantity at;  ///< [rad] or [m]
  bool is_latch = false;
  std::optional<Side> side;                    ///< of `at` that is free; where the joint starts unless given
  std::optional<Quantity> stiffness, damping;  ///< [N m/rad] or [N/m]; without stiffness it is rigid
  Location where;
};

/// How a joint's coordinate moves, whatever it takes [rad] or [m].
struct DriveDescription {
  std::variant<TimeFormulaDescription, TableDescription> law;
  Location where;
};

/// Coulomb friction on a joint's coordinate, mu N; of an angle mu N radius.
struct FrictionDescription {
  Quantity coefficient;             ///< [-]
  std::optional<Quantity> preload;  ///< N [N]; unless given it is the joint's own reaction
  std::optional<Quantity> radius;   ///< of the pin of a revolute joint [m]
  Location where;
};

struct JointDescription {
  enum class Type { rigid, revolute, prismatic, distance, cylindrical, spherical, universal, planar, screw, strut };
  std::string name;
  Type type = Type::revolute;
  std::array<std::string, 2> between;  ///< nodes, bodies or "ground"
  std::array<Location, 2> between_where;
  std::vector<Quantity> at;  ///< its point on the first, in the configuration given [m]; that of a node unless given
  std::vector<Quantity> to;  ///< on the second; `at`, and of a distance its node, unless given
  Location at_where, to_where;
  std::vector<Quantity> axis;  ///< of a prismatic joint; in space of all but rigid, spherical and distance [-]
  Location axis_where;
  std::vector<Quantity> second_axis;  ///< of a universal joint, on the second part [-]
  Location second_axis_where;
  std::optional<Quantity> lead;    ///< of a screw [m] a turn; negative: left-handed
  std::optional<Quantity> value;   ///< of its angle or displacement in the configuration given [rad] or [m]
  std::optional<Quantity> rate;    ///< of its angle, displacement or length at the start [rad/s] or [m/s]
  std::optional<Quantity> length;  ///< of a distance [m]; as the points lie unless given
  std::optional<DriveDescription> motion;
  /// Moment or force, + on the second; may use `angle`, `displacement` or `length`, `rate`, `t`.
  std::optional<Quantity> drive;
  std::optional<TableDescription> drive_table;       ///< instead, over the coordinate, whose values stand as its times
  std::optional<Quantity> stiffness, rest, damping;  ///< of a spring and a damper on its coordinate
  std::vector<LockDescription> locks;
  std::optional<FrictionDescription> friction;
  Location where;
};

/// An elastic mount: stiffness and damping in all directions between two parts.
struct BushingDescription {
  std::string name;
  std::array<std::string, 2> between;  ///< nodes, bodies or "ground"
  std::array<Location, 2> between_where;
  std::vector<Quantity> at;                  ///< its point, in the configuration given [m]; that of a node unless given
  std::vector<Quantity> axis;                ///< its x; of the world unless given [-]
  std::vector<Quantity> rotation;            ///< of its axes in space, a rotation vector [rad]
  std::vector<Quantity> stiffness, damping;  ///< x, y, rz [3], or x, y, z, rx, ry, rz [6]
  Location at_where, axis_where, rotation_where, stiffness_where, damping_where, where;
};

/// A ratio between the coordinates of two joints: first = ratio second + what it is at the start.
struct GearDescription {
  std::string name;
  std::array<std::string, 2> joints;
  std::array<Location, 2> joints_where;
  Quantity ratio;  ///< [-], [m] or [1/m]
  Location where;
};

}  // namespace rubato::model
