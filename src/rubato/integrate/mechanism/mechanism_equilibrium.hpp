#pragma once

#include <rubato/system/mechanism_equations.hpp>

namespace rubato::integrate {

/// How an equilibrium is looked for.
struct EquilibriumPlan {
  double tolerance = 1e-10;    ///< of the last correction, in the mass norm over the mechanism's reference [-]
  double largest_turn = 0.5;   ///< of a correction [rad]
  double largest_shift = 0.2;  ///< of a correction, over the extent of the mechanism [-]
  int most_iterations = 400;
  double first_load_step = 0.25;  ///< where the loads are raised by steps: of all loads [-]
  double least_load_step = 1e-4;  ///< a smaller one ends the search [-]
};

struct MechanismEquilibrium {
  system::State state;  ///< at rest, with the multipliers that hold it; the best found where it is not one
  bool is_found = false;
  bool is_stable = false;   ///< no motion that the constraints leave goes downhill from it
  int iterations = 0;       ///< of all load steps
  int load_steps = 0;       ///< 0: found with all loads at once
  double load = 1.0;        ///< the share of the loads in whose equilibrium the state is; 1 where it is found
  double residual = 0.0;    ///< largest force that is left [N], [N m]
  Index worst = -1;         ///< its coordinate
  int unsettled_lock = -1;  ///< one that was met and let go without end
};

/// The configuration in which nothing moves,  f(q, 0, t) + G^T multiplier = 0,  g(q, t) = 0,  near a given one.
///
/// Newton's method on K + shift M, whose shift falls with the residual (pseudo-transient continuation, Kelley and Keyes
/// 1998) and grows where the matrix is not positive definite on the constraints: it leads downhill, across
/// configurations in which the stiffness is singular, to an equilibrium that is stable, unless it begins in one that is
/// not, or next to it by no more than the tolerance: a pendulum that stands upright is found standing.
/// Where that finds none, the loads (forces, gravity, laws of joints) are raised from zero by steps, each from the
/// equilibrium of the last by Newton's method alone: a step that fails is halved, the next after one that succeeds
/// twice as long. So the way of a structure under a growing load is followed, as far as no limit point stops it,
/// through equilibria that are not stable too. Laws with a memory follow a single way without a turn from the
/// configuration given to that of equilibrium, as if all of them were loaded from what they remember. Drives are held
/// where they are at that time; friction is left out. Locks that the way meets hold as long as they press, those that
/// held at the start too; latches that did hold for good.
/// @param given  t, configuration and phases of locks count
MechanismEquilibrium find_equilibrium(system::MechanismEquations& equations, const system::State& given,
                                      const EquilibriumPlan& plan = {});

}  // namespace rubato::integrate
