#pragma once

#include <rubato/model/joints/space_point.hpp>

#include <Eigen/Core>

#include <array>
#include <variant>

// Scalar functions of the configuration of two nodes in space, with their first and second derivatives by increments
// (x, y, z in world axes, rotations in body axes) of the first node and then of the second. Constraints of joints, and
// the coordinates that joints leave free, are made of them.
namespace rubato::model {

using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

/// A function with its gradient, and the derivative of its gradient (not symmetric: rotations do not commute).
struct SpaceValue {
  double value = 0.0;
  Vector12 gradient = Vector12::Zero();
  Matrix12 slope = Matrix12::Zero();
};

/// Two nodes at a moment, with points that move with them.
struct SpacePair {
  numerics::Vector3 position1, position2;  ///< of the nodes [m]
  numerics::Matrix3 turn1, turn2;          ///< from body axes to those of the world
  numerics::Vector3 offset1, offset2;      ///< of the points, in body axes [m]
  numerics::Vector3 between;               ///< from the first point to the second, in world axes [m]
  numerics::Matrix3 relative;              ///< from the axes of the second to those of the first
};
SpacePair pair_of(const double* q, const SpacePoint& first, const SpacePoint& second);

/// along . (p2 - p1), `along` fixed in the world [m].
struct WorldGap {
  numerics::Vector3 along;
};
/// along . (p2 - p1), `along` fixed in the first node [m].
struct BodyGap {
  numerics::Vector3 along;
};
/// first . second, directions fixed in the first and in the second node [-].
struct Alignment {
  numerics::Vector3 first, second;
};
/// (|p2 - p1|^2 - length^2)/(2 length) [m].
struct DistanceGap {
  double length;
};
/// How far the points are apart, |p2 - p1| [m].
struct PointDistance {};
/// The angle by which the second node has turned about an axis, in (-pi, pi] [rad]: that of which two alignments are
/// the cosine and the sine.
struct TurnAngle {
  Alignment cosine, sine;
};

using SpaceRow = std::variant<WorldGap, BodyGap, Alignment, DistanceGap, TurnAngle, PointDistance>;

/// How much of a SpaceValue is asked for.
enum class SpaceDetail { gradient, slope };

/// @param result  overwritten; without SpaceDetail::slope its slope stays as it is
void evaluate(const SpaceRow& row, const SpacePair& pair, SpaceValue& result, SpaceDetail detail = SpaceDetail::slope);

/// Where the gradient and the slope of a row may differ from zero.
struct SpacePattern {
  std::array<bool, 12> gradient{};
  std::array<std::array<bool, 12>, 12> slope{};
};
/// @param first, second  the points of the pair that the row is of
SpacePattern pattern_of(const SpaceRow& row, const SpacePoint& first, const SpacePoint& second);

/// The value alone [rad].
double angle_of(const TurnAngle& row, const SpacePair& pair);

}  // namespace rubato::model
