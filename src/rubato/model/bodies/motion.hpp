#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/time_law.hpp>

namespace rubato::model {

struct BlockPoint;
struct LawPoint;

/// What the laws of a mechanism know of what has been.
struct LawHistory {
  const LawPoint* from = nullptr;  ///< of each: where the step starts in which the motion is; null: it stands there
  const double* memory = nullptr;  ///< of all, at that start
  double* next = nullptr;          ///< of all: room for that where the motion is, in a step
  const BlockPoint* block_from = nullptr;  ///< as `from`, of each contact
};

/// Where a mechanism is, as its elements and joints read it. Nothing is owned.
///
/// A plane node has three numbers in q (x, y, angle), a spatial one seven (x, y, z, and a unit quaternion w, x, y, z
/// that turns the axes of the node into those of the world). Velocities lie in the tangent space: of a plane node
/// (x', y', angle'), of a spatial one the velocity in the axes of the world and the angular velocity in those of the
/// node.
struct Motion {
  double t = 0.0;                    ///< [s]
  Side side = Side::right;           ///< which limit of a law that jumps at t
  const double* q = nullptr;         ///< all numbers of all nodes
  const double* v = nullptr;         ///< [n], after a zero: v[ground] is the velocity of whatever is fixed
  const int* phase = nullptr;        ///< of the locks: see LockPhase
  const int* rubbing = nullptr;      ///< of the joints with friction: see FrictionPhase
  const double* stuck_at = nullptr;  ///< where they last stuck [rad] or [m]
  LawHistory laws = {};
  const double* multiplier = nullptr;  ///< of the constraints [c]: reactions that press on laws
};

inline constexpr int plane_numbers = 3, space_numbers = 7;

}  // namespace rubato::model
