#pragma once

#include <rubato/analysis/automatic_step.hpp>
#include <rubato/analysis/observed.hpp>
#include <rubato/integrate/method.hpp>
#include <rubato/model/description.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rubato::analysis {

/// A transient with all its values: what the description says, evaluated and found possible.
struct TransientPlan {
  integrate::Method method;
  system::State start;  ///< that of the system, or of equilibrium; on the constraints
  double step = 0.0;    ///< of equal steps [s]; 0 for `exact` and for steps that choose themselves
  /// How the march picks its steps; empty: they are equal, and nothing is located.
  std::optional<AutomaticStep> automatic;
  double duration = 0.0;  ///< [s]
  std::vector<Observed> observed;
  model::OutputDescription::Kind output = model::OutputDescription::Kind::every_step;
  long every = 1;
  double interval = 0.0;      ///< [s]
  std::vector<double> times;  ///< rising [s]
  bool energy = true;
  bool allow_unstable = false;
  bool project_velocities = false;
  model::SectionForcesDescription section_forces;
  double rows = 0.0, columns = 0.0;  ///< expected numbers
  /// Of what the start took (parts that moved, constraints that repeat others), and of steps that may not see what a
  /// load does.
  std::vector<std::string> warnings = {};
  std::string failure;  ///< why the equilibrium to start from was not found: the analysis fails; empty: nothing did
};

/// What is wrong with a transient without a step.
inline constexpr const char* missing_step =
    "the key \"step\" is missing: give its length [s], or step = { tolerance = 1e-3 } for steps that choose themselves";

/// The method that a description names, with the values of its parameters. Throws InvalidInput at its place.
integrate::Method method_of(const model::MethodDescription& description, const numerics::Parameters& parameters);

/// What a study asks of a transient, and where it says so.
struct TransientRequest {
  const std::string& name;
  const Location& where;
  const model::TransientDescription& description;
  const numerics::Parameters& parameters;

  /// Heads the messages.
  std::string title() const { return "analysis \"" + name + "\": "; }
};

class TransientKind;

/// Evaluates a description and checks that it can run: values in their ranges, names known, tables that reach over the
/// whole run, and what the kind of system asks. Throws InvalidInput. Where no equilibrium to start from is found the
/// plan says so.
TransientPlan plan_transient(const std::string& name, const Location& where,
                             const model::TransientDescription& description, const TransientKind& kind,
                             const numerics::Parameters& parameters);

/// "transient, generalized_alpha, 12000 steps of 0.005 s to t = 60 s"
std::string summary(const TransientPlan& plan);

}  // namespace rubato::analysis
