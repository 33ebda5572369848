#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/mechanism_description.hpp>

#include <array>
#include <string>
#include <vector>

// What pictures of a mechanism are made of. Nothing here enters the equations.
namespace rubato::model {

/// A point that a node carries.
struct DrawnPoint {
  Index node = 0;
  std::array<double, 3> offset{};  ///< in the axes of the node [m]
  bool operator==(const DrawnPoint&) const = default;
};

/// A straight line between two points.
struct DrawnLine {
  enum class Kind { beam, body, link, strut };
  using End = DrawnPoint;
  Kind kind = Kind::beam;
  End first, second;
};

/// A joint, which pictures show by a symbol of its type.
struct DrawnJoint {
  /// What acts on its coordinate: of several the first of drive, spring, force, damper.
  enum class Law { none, drive, spring, force, damper };
  enum class Limit { none, stop, latch, both };
  std::string name;
  JointDescription::Type type = JointDescription::Type::revolute;
  DrawnPoint first, second;      ///< where it holds its parts
  std::array<double, 3> axis{};  ///< in the axes of the first node [-]; zero where the type has none
  Law law = Law::none;
  Limit limit = Limit::none;
};

/// A body of simple shape, about its node.
struct DrawnShape {
  ShapeDescription::Kind kind = ShapeDescription::Kind::box;
  Index node = 0;
  std::array<double, 3> size{};  ///< of the box around it, along the axes of the body [m]
};

struct MechanismDrawing {
  std::vector<DrawnLine> lines;
  std::vector<DrawnJoint> joints;
  std::vector<DrawnShape> shapes;
};

/// The symbol of a joint between two points. @param axis  in the axes of the first node [-]
DrawnJoint drawn_joint(const JointDescription& joint, const DrawnPoint& first, const DrawnPoint& second,
                       const std::array<double, 3>& axis);

}  // namespace rubato::model
