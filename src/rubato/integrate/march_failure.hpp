#pragma once

#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/events.hpp>

#include <string>
#include <vector>

namespace rubato::integrate {

/// Why a march ended before its time: what its system knows of it, with the names of the user's parts. Each kind of
/// system finds its own; empty is what it does not know.
struct MarchFailure {
  StepOutcome outcome = StepOutcome::accepted;
  double t = 0.0, step = 0.0;  ///< start of the step that failed, and its length [s]
  /// The coordinate at fault; of a step that found no consistent contacts the contact, of constraints that contradict
  /// each other the row.
  std::string worst;

  /// What a step settles beside the linear equations, in the plural; empty: it solves equations of motion with
  /// constraints by Newton's method.
  std::string contacts;

  // Of constrained systems:
  Events last_changes;              ///< of the last parts that changed, each once, the last first
  std::string chattering;           ///< the part that changed without end
  bool is_lock_chattering = false;  ///< it is a lock, else friction
  bool has_beams = false;
  bool has_followed_reactions = false;        ///< friction that follows reactions
  std::string collapsed_strut;                ///< whose ends have all but met
  std::string non_finite_part;                ///< what has no finite value a step ahead
  std::vector<std::string> repeating_joints;  ///< that say what others say there, and not at the start
  double least_tolerance = 0.0;               ///< below, the error of a step is what Newton's method leaves [-]
};

}  // namespace rubato::integrate
