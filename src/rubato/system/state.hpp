#pragma once

#include <rubato/core/types.hpp>

#include <vector>

namespace rubato::system {

/// Where a system is: all that its equations need, and the auxiliary acceleration that one-step methods carry.
/// A value: copying, comparing and restoring it is exact, and there is nothing else to restore.
struct State {
  double t = 0.0;  ///< [s]
  Vector q;        ///< configuration [n] [m]; of a mechanism all numbers of its nodes
  Vector v;        ///< velocity [n] [m/s]
  /// fc of each slider [N], its history; then fs of each stop [N], which follows from q and v but for its jumps; then f
  /// of each other law [N]
  Vector slider_force;
  Vector memory;  ///< of the other laws, and of the laws of a mechanism, one after another: their history
  /// The acceleration that a method of the alpha family weights (that of equilibrium at a shifted time), [n] [m/s2].
  /// What is reported is system::LocallyNonlinear::acceleration instead. Methods that need none leave it as it is.
  Vector auxiliary_acceleration;
  // Of mechanisms only:
  Vector acceleration;  ///< that of equilibrium at t [n] [m/s2]
  Vector multiplier;    ///< of the constraints [c] [N], [N m]
  /// By which the reactions exceed the multipliers of a step that ends with a projection of its velocities, over its
  /// length [c] [N/s], [N m/s]; empty: nothing
  Vector reaction_lag;
  std::vector<int> phase;    ///< of each lock (model::LockPhase): its history
  std::vector<int> rubbing;  ///< of each joint with friction (model::FrictionPhase): its history
  Vector stuck_at;           ///< where each of them last stuck [rad] or [m]
  /// What a first correction of Newton's method may be taken to leave of the error, by the last step that measured it
  /// [-]; 1: not known
  double contraction = 1.0;
  double correction = 0.0;  ///< the size of that correction [m sqrt(kg)]
};

}  // namespace rubato::system
