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
/// A stop lets go where its force would pull; a latch never does, and ends the joint's drive. A [[stop]] is such a lock
/// with a stiffness, under a name of its own, which may also act between two coordinates.
struct Lock {
  std::string name;           ///< of the joint, or of the [[stop]]
  bool is_stop_part = false;  ///< a [[stop]]
  std::string on_joint = {};  ///< of a [[stop]]: the joint on whose coordinate it acts; empty: between two coordinates
  FreeCoordinate s;
  bool is_latch = false;
  double at = 0.0;               ///< [rad] or [m]
  double stiffness = 0.0;        ///< [N m/rad] or [N/m]; 0: a constraint
  double damping = 0.0;          ///< [N m s/rad] or [N s/m]
  double sign = 1.0;             ///< +1: open while s < at; -1: while s > at
  bool is_met_at_start = false;  ///< the configuration given lies on it
  int joint = -1;                ///< the constraint that holds it, among the mechanism's; -1: it has a stiffness

  bool is_rigid() const { return joint >= 0; }
  /// A spring that pushes from one side, and nothing else.
  bool is_spring() const { return !is_latch && !is_rigid() && damping == 0.0; }
  /// On whose coordinate it acts; empty: on that of none.
  const std::string& joint_name() const { return is_stop_part ? on_joint : name; }
  /// Of one with a stiffness: how far s is beyond it [m] or [rad], and the force that its spring and damper make there.
  double depth(const Motion& motion) const { return sign * (s.value(motion.q) - at); }
  double push(const Motion& motion) const { return stiffness * depth(motion) + damping * sign * s.rate(motion); }
};

}  // namespace rubato::model
