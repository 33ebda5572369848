#pragma once

#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/method.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rubato::integrate {

/// A step that chooses itself, with all its values.
struct AutomaticStep {
  StepPlan plan;
  EstimatorKind estimator;
  double tolerance = 1e-3;
  bool asks_for_tolerance = true;  ///< false: equal steps of a mechanism, whose error nobody asked for
  double expected_steps = 0.0;     ///< at least: what the largest step takes; for the size of files
};

/// A march with all its values: what a study says of it, evaluated and found possible.
struct MarchPlan {
  Method method;
  system::State start;  ///< that of the system, or of equilibrium; on the constraints
  double step = 0.0;    ///< of equal steps [s]; 0 for `exact` and for steps that choose themselves
  /// How the march picks its steps; empty: they are equal, and nothing is located.
  std::optional<AutomaticStep> automatic;
  double duration = 0.0;  ///< [s]
  bool allow_unstable = false;
  bool project_velocities = false;
  /// Of what the start took (parts that moved, constraints that repeat others), and of steps that may not see what a
  /// load does.
  std::vector<std::string> warnings = {};
  std::string failure;  ///< why the equilibrium to start from was not found: the march fails; empty: nothing did
};

}  // namespace rubato::integrate
