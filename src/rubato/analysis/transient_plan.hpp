#pragma once

#include <rubato/analysis/automatic_step.hpp>
#include <rubato/integrate/method.hpp>
#include <rubato/model/description.hpp>
#include <rubato/results/columns/observed_columns.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rubato::analysis {

using results::Observed;

/// A transient with all its values: what the description says, evaluated and found possible.
struct TransientPlan {
  integrate::Method method;
  system::State start;  ///< that of the system, or of equilibrium
  double step = 0.0;    ///< [s]; 0 for `exact` and for an automatic step
  std::optional<AutomaticStep> automatic;
  double duration = 0.0;  ///< [s]
  std::vector<Observed> observed;
  model::OutputDescription::Kind output = model::OutputDescription::Kind::every_step;
  long every = 1;
  double interval = 0.0;      ///< [s]
  std::vector<double> times;  ///< rising [s]
  bool energy = true;
  double rows = 0.0;                       ///< expected number of rows
  std::vector<std::string> warnings = {};  ///< of steps that may not see what a load does
};

/// What is wrong with a transient without a step.
inline constexpr const char* missing_step =
    "the key \"step\" is missing: give its length [s], or step = { tolerance = 1e-3 } for steps that choose themselves";

/// The method that a description names, with the values of its parameters. Throws InvalidInput at its place.
integrate::Method method_of(const model::MethodDescription& description, const numerics::Parameters& parameters);

/// Evaluates where rows are wanted and how many that makes; method, step and duration are planned already. Throws
/// InvalidInput.
void plan_output(TransientPlan& plan, const model::OutputDescription& output, const numerics::Parameters& parameters,
                 const Location& where);

/// Whether supports that move count among the coordinates, after the free ones, as in MovingSupports.
enum class Supports { left_out, observed };

/// Looks up a coordinate or a difference. Throws InvalidInput at its place, with the nearest name.
Observed observed_of(const model::ObservationDescription& description, const system::LocallyNonlinear& system,
                     Supports supports = Supports::left_out);

/// Every coordinate of a system, in its order.
std::vector<Observed> every_coordinate(const system::System& system);

/// What is asked for, or every coordinate: displacements, then rotations.
std::vector<Observed> observed_or_all(const std::optional<std::vector<model::ObservationDescription>>& wanted,
                                      const system::LocallyNonlinear& system, Supports supports = Supports::left_out);

/// Evaluates a description and checks that it can run: values in their ranges, names known, tables that reach over the
/// whole run, and a step below the stability limit of the model unless `allow_unstable`. Throws InvalidInput.
TransientPlan plan_transient(const std::string& name, const Location& where,
                             const model::TransientDescription& description, const system::LocallyNonlinear& system,
                             const numerics::Parameters& parameters);

}  // namespace rubato::analysis
