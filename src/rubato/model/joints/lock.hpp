#pragma once

#include <rubato/model/joints/free_coordinate.hpp>

#include <string>

namespace rubato::model {

/// What a lock does now; kept in the state, changed by events only.
enum LockPhase : int {
  lock_open = 0,
  lock_engaged = 1,  ///< at the stop, or latched
};

/// A limit of a joint's coordinate s (angle or displacement): a stop holds it from one side only, a latch for good.
///
///   open: nothing, until sign (s - at) reaches 0
///   engaged, with a stiffness: the force -stiffness (s - at) - damping s' on s
///   engaged, without: the constraint s = at
///
/// A stop lets go where its force would pull; a latch never does, and ends the joint's drive.
struct Lock {
  std::string name;  ///< of the joint
  FreeCoordinate s;
  bool is_latch = false;
  double at = 0.0;               ///< [rad] or [m]
  double stiffness = 0.0;        ///< [N m/rad] or [N/m]; 0: a constraint
  double damping = 0.0;          ///< [N m s/rad] or [N s/m]
  double sign = 1.0;             ///< +1: open while s < at; -1: while s > at
  bool is_met_at_start = false;  ///< the configuration given lies on it
  int joint = -1;                ///< the constraint that holds it, among the mechanism's; -1: it has a stiffness

  bool is_rigid() const { return joint >= 0; }
};

}  // namespace rubato::model
