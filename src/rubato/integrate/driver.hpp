#pragma once

#include <rubato/integrate/stepper.hpp>

namespace rubato::integrate {

class LoadJumps;

/// Sees every accepted step, both ends.
class Observer {
 public:
  virtual ~Observer() = default;
  /// Returns false to stop the march after this step.
  virtual bool accepted(const system::State& before, const system::State& after) = 0;
};

enum class MarchEnd {
  reached,  ///< the end of the interval
  stopped,  ///< an observer asked for it
  failed,   ///< a step failed: `step` says how; the state is the last accepted one
};

struct MarchReport {
  MarchEnd end = MarchEnd::reached;
  StepReport step;
  long steps = 0;            ///< accepted
  double failed_at = 0.0;    ///< start of the step that failed [s]
  double failed_step = 0.0;  ///< its length [s]
};

/// The loop: equal steps from state.t to `end`, the last one shortened where the interval is no multiple of the step.
/// The times are multiples of the step, not sums; one that is a jump of a load but for round-off is that jump.
/// Allocates nothing after the first step.
/// @param state     start; on return the last accepted state
/// @param step      [s], > 0
/// @param observer  may be null
/// @param jumps     of the loads of a structure; null: none of them jumps
MarchReport march(Stepper& stepper, system::State& state, double step, double end, Observer* observer = nullptr,
                  LoadJumps* jumps = nullptr);

/// Number of full steps in a length, and the rest (zero where it is round-off).
struct StepCount {
  long full = 0;
  double rest = 0.0;  ///< [s]
};
StepCount count_steps(double length, double step);

}  // namespace rubato::integrate
