#pragma once

#include <rubato/analysis/automatic_step.hpp>
#include <rubato/analysis/observed.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/integrate/march_plan.hpp>
#include <rubato/model/description.hpp>

#include <string>
#include <vector>

namespace rubato::analysis {

/// A transient with all its values: what the description says, evaluated and found possible.
struct TransientPlan {
  integrate::MarchPlan march;
  // What is shown of it:
  std::vector<Observed> observed;
  model::OutputDescription::Kind output = model::OutputDescription::Kind::every_step;
  long every = 1;
  double interval = 0.0;      ///< [s]
  std::vector<double> times;  ///< rising [s]
  bool energy = true;
  bool shows_every_step = false;  ///< in the table `every_step`, besides the rows that are asked for
  model::SectionForcesDescription section_forces;
  double rows = 0.0, columns = 0.0;  ///< expected numbers
};

/// What is wrong with a transient without a step.
inline constexpr const char* missing_step =
    "the key \"step\" is missing: give its length [s], or step = { tolerance = 1e-3 } for steps that choose themselves";

/// The method that a description names, with the values of its parameters. Throws InvalidInput at its place.
integrate::Method method_of(const model::MethodDescription& description, const numerics::Parameters& parameters);

/// Evaluates a description and checks that it can run: values in their ranges, names known, tables that reach over the
/// whole run, and what the kind of system asks. Throws InvalidInput. Where no equilibrium to start from is found the
/// plan says so.
TransientPlan plan_transient(const std::string& name, const Location& where,
                             const model::TransientDescription& description, const integrate::SystemKind& kind,
                             const numerics::Parameters& parameters);

/// "transient, generalized_alpha, 12000 steps of 0.005 s to t = 60 s"
std::string summary(const TransientPlan& plan);

}  // namespace rubato::analysis
