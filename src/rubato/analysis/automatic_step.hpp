#pragma once

#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/integrate/march_plan.hpp>
#include <rubato/model/description.hpp>
#include <rubato/results/sink.hpp>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rubato::analysis {

using integrate::AutomaticStep;

/// A value that must be positive where it is given. Throws InvalidInput at its place.
double positive_or(const std::optional<model::Quantity>& quantity, double otherwise, const std::string& what,
                   const numerics::Parameters& parameters);

/// Evaluates the step of a description; method, start and duration are planned already. Defaults: controller `pi`;
/// estimator `inertia_jump` for the controller `cardona_cassano`, else what suits the method; smallest step 1e-12 of
/// the duration; largest a fiftieth of it, at most a sixth of the shortest period of a harmonic load and, unless
/// `allow_unstable`, the stability limit of the method; where formulas of loads swing, shorter. Throws InvalidInput at
/// the place of the value.
AutomaticStep plan_automatic_step(const integrate::TransientRequest& request, const integrate::SystemKind& kind,
                                  const integrate::MarchPlan& march, std::vector<std::string>& warnings);

/// Streams every try of a step into the table `steps`: time, step, error and what became of it.
class StepRecorder final : public integrate::TryLog {
 public:
  StepRecorder(const std::string& analysis, const AutomaticStep& step, results::Sink& sink);
  void tried(const integrate::StepTry& step_try) override;

 private:
  double tolerance_;
  std::unique_ptr<results::RowWriter> rows_;
};

/// "tolerance 0.001 (local_error, pi)"
std::string summary(const AutomaticStep& step);

/// What to do where the error asks for a step below the smallest: look at the study's own limits first.
std::string advice_on_smallest(const integrate::StepPlan& plan, double duration);

/// What to tell of a march that kept steps whose error is above the tolerance; empty: nothing.
std::string warning_of(const integrate::AdaptiveReport& report, const AutomaticStep& step);

/// What the march counted, for the results.
std::vector<std::pair<std::string, std::string>> statistics(const integrate::AdaptiveReport& report,
                                                            const integrate::MarchPlan& plan, double length);

}  // namespace rubato::analysis
