#pragma once

#include <rubato/system/guard.hpp>
#include <rubato/system/state.hpp>

#include <vector>

namespace rubato::integrate {

/// A transition within a step: where a law takes another branch.
struct Crossing {
  Index guard = -1;    ///< -1: there is none
  double share = 1.0;  ///< of the step after which it is expected, in (0, 1]
  double seen = 1.0;   ///< where in the step its guard is negative; below 1 by interpolation, which may err
};

/// Where in a step transitions are looked for.
enum class Look {
  between,  ///< between its ends too, by interpolation
  at_ends
};

using system::GuardValue;
using system::Passage;

/// What a march with automatic steps asks of the equations besides steps: when something is known to happen, and
/// whether something has happened. What has happened follows from the two ends of a step alone, so that a try that is
/// thrown away leaves no trace. A workspace: one a march.
class Timeline {
 public:
  virtual ~Timeline() = default;

  /// Times in (from, to) at which the loads are not smooth, rising. No step passes one.
  virtual std::vector<double> breakpoints(double from, double to) const = 0;

  /// Whether the loads, or the velocity that a drive prescribes, jump at t.
  virtual bool jumps_at(double t) = 0;

  /// Lets a state go on from a jump: the auxiliary acceleration becomes that of equilibrium after it. Returns false
  /// where there is none.
  virtual bool restart(system::State& state) = 0;

  /// Lets a state go on from the transitions in which a step ended. The auxiliary acceleration is carried over what
  /// jumps with its derivative; where the acceleration itself jumps it becomes that of equilibrium.
  /// @param before  where the step started
  /// @param shift   the auxiliary acceleration stands at state.t + shift [s]
  virtual Passage pass(const system::State& before, system::State& state, double shift) = 0;

  /// Times are located to this [s].
  virtual double resolution() const = 0;

  /// How much too long a step is for what laws do within it: the largest model::LawResolution::unresolved().
  virtual double unresolved(const system::State& from, const system::State& to) {
    (void)from;
    (void)to;
    return 0.0;
  }

  /// The first transition within a step, by interpolation between its ends.
  /// @param least  transitions before this share of the step are passed over: they were located by the last step, or
  ///               follow it so closely that locating each would stop the march
  virtual Crossing first_crossing(const system::State& from, const system::State& to, double least, Look look) = 0;

  /// The guard of a transition that first_crossing found in a step from the same state, at the end of another.
  virtual GuardValue guard(Index guard, const system::State& from, const system::State& to) = 0;
};

}  // namespace rubato::integrate
