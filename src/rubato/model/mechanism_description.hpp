#pragma once

#include <rubato/model/quantity.hpp>
#include <rubato/model/time_law_description.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

// Bodies and the joints between them, as the user wrote it. Part of model/description.hpp.
namespace rubato::model {

struct BodyDescription {
  std::string name;
  Quantity mass;                           ///< [kg]
  std::vector<Quantity> inertia;           ///< about the centre of mass; one number in the plane [kg m2]
  std::vector<Quantity> position;          ///< of the centre of mass at the start [m]
  std::optional<Quantity> angle;           ///< at the start [rad]; 0 unless given
  std::vector<Quantity> velocity;          ///< at the start [m/s]; at rest unless given
  std::vector<Quantity> angular_velocity;  ///< at the start [rad/s]
  Location where;
};

/// A limit of the coordinate of a joint.
struct LockDescription {
  Quantity at;  ///< [rad] or [m]
  bool is_latch = false;
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
  enum class Type { rigid, revolute, prismatic, distance };
  std::string name;
  Type type = Type::revolute;
  std::array<std::string, 2> between;  ///< nodes, bodies or "ground"
  std::array<Location, 2> between_where;
  std::vector<Quantity> at;  ///< its point on the first, in the configuration given [m]; that of a node unless given
  std::vector<Quantity> to;  ///< on the second; `at`, and of a distance its node, unless given
  Location at_where, to_where;
  std::vector<Quantity> axis;  ///< of a prismatic joint [-]
  Location axis_where;
  std::optional<Quantity> value;   ///< of its angle or displacement in the configuration given [rad] or [m]
  std::optional<Quantity> length;  ///< of a distance [m]; as the points lie unless given
  std::optional<DriveDescription> motion;
  std::optional<Quantity> drive;  ///< moment or force, + on the second; may use `angle` or `displacement`, `rate`, `t`
  std::optional<Quantity> stiffness, rest, damping;  ///< of a spring and a damper on its coordinate
  std::optional<LockDescription> lock;
  std::optional<FrictionDescription> friction;
  Location where;
};

}  // namespace rubato::model
