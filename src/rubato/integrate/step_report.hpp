#pragma once

#include <rubato/core/types.hpp>

namespace rubato::integrate {

/// What became of one attempted step. A failure is an outcome, not an exception: the driver decides what to do about
/// it.
enum class StepOutcome {
  accepted,        ///< the state is the solution at t + h
  not_converged,   ///< the contact problem of the sliders found no consistent set of sticking ones
  not_finite,      ///< a NaN or an infinity appeared
  singular,        ///< the effective matrix of this step cannot be factorised
  overdetermined,  ///< constraints contradict each other: no positions satisfy all of them
  too_small,       ///< the error asks for a step below the smallest (automatic steps)
  crawls,          ///< steps were so short for so long that the run would not end (automatic steps)
  no_way_on,       ///< no consistent state from which to go on after a transition, or a jump of a load or a drive
};

struct StepReport {
  StepOutcome outcome = StepOutcome::accepted;
  Index worst = -1;  ///< the equation (not_finite, singular) or the slider (not_converged) or the constraint
                     ///< (overdetermined) at fault; -1: unknown
};

}  // namespace rubato::integrate
