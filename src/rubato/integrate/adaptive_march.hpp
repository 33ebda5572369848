#pragma once

#include <rubato/integrate/controllers/controller.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/estimators/estimator.hpp>
#include <rubato/integrate/timeline.hpp>
#include <rubato/numerics/formula_swings.hpp>

#include <vector>

namespace rubato::integrate {

/// How a march picks its steps.
struct StepPlan {
  Controller controller = PiControl{};
  double first = 0.0;         ///< [s]; 0: the estimator's, and after a jump of a load its again
  double smallest = 0.0;      ///< a controller that asks for less ends the march [s]
  double largest = HUGE_VAL;  ///< [s]
  /// Where steps must be shorter still, to see how loads swing: rising, apart. A step that starts before such a time
  /// reaches into it by no more than its bound.
  std::vector<numerics::StepBound> bounds;
  bool locate_events = false;  ///< steps end at transitions of the timeline
  bool locate_sliders = true;  ///< those of the sliders of a structure among them, else those of its stops alone
  bool rebuild = true;  ///< the auxiliary acceleration when the step changes; the paper of Cardona and Cassano does not
};

enum class TryOutcome {
  accepted,
  error_too_large,  ///< the controller rejected it
  not_converged,    ///< the step failed and is halved; likewise the next two
  not_finite,
  singular,
  event,  ///< ended beyond a transition, or was a try on the way to it
};

/// One try of a step, for the history.
struct StepTry {
  double t = 0.0;  ///< its start [s]
  double step = 0.0;
  double error = 0.0;  ///< over the tolerance; NaN where there was none to estimate
  TryOutcome outcome = TryOutcome::accepted;
};

class TryLog {
 public:
  virtual ~TryLog() = default;
  virtual void tried(const StepTry& step_try) = 0;
};

struct AdaptiveReport {
  MarchReport march;
  long rejected = 0;  ///< for their error
  long failed = 0;    ///< not converged, not finite or singular: halved
  long events = 0;    ///< transitions located
  long event_tries = 0;
  long beyond_tolerance = 0;  ///< accepted steps whose error is above the tolerance: what the controller `fixed` allows
  double largest_error = 0.0;  ///< of an accepted step, over the tolerance
  long restarts = 0;           ///< after jumps of loads and transitions
  long solves = 0;
  long factorisations = 0;
  double smallest_step = HUGE_VAL, largest_step = 0.0;  ///< accepted [s]
};

/// The loop with steps that choose themselves: from state.t to `end`, which the last step meets exactly. No step passes
/// a breakpoint of the timeline; steps towards one are made equal. A rejected try leaves no trace: the next starts from
/// the same bits.
///
/// With `locate_events` a step that would pass a transition is tried again with the length at which the guard vanishes
/// on the interpolated step, then corrected by Newton's iteration on the guard within a bracket, until the guard is
/// zero, or its zero bracketed, to the resolution of the timeline. Only then is its error estimated: a transition is no
/// error. The march restarts there. A transition within a millionth of the wanted step after the start of a step is
/// passed over, so that an accumulation of transitions does not stop the march.
/// @param state     start, with the acceleration of equilibrium as its auxiliary one (consistent_start); on return the
///                  last accepted state
/// @param observer  may be null   @param log  may be null
AdaptiveReport march(Stepper& stepper, Estimator& estimator, const StepPlan& plan, Timeline& timeline,
                     system::State& state, double end, Observer* observer = nullptr, TryLog* log = nullptr);

/// To what events of a structure are located, over the length of a march [-].
inline constexpr double relative_resolution = 1e-12;

/// The same with the timeline of a structure.
AdaptiveReport march(Stepper& stepper, Estimator& estimator, const StepPlan& plan,
                     const system::LocallyNonlinear& system, system::State& state, double end,
                     Observer* observer = nullptr, TryLog* log = nullptr);

}  // namespace rubato::integrate
