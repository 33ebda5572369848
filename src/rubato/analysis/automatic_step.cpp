#include <rubato/analysis/automatic_step.hpp>
#include <rubato/analysis/load_swings.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rubato::analysis {
namespace {

constexpr double least_step = 1e-12;  // of the duration, unless the study says

integrate::Controller controller_of(const std::string& name) {
  if (name == "fixed") return integrate::FixedStep{};
  if (name == "cardona_cassano") return integrate::CardonaCassano{};
  return integrate::PiControl{};
}

integrate::EstimatorKind estimator_of(const std::string& title, const model::StepDescription& description,
                                      const integrate::SystemKind& kind, const integrate::MarchPlan& plan,
                                      double tolerance, double reference) {
  const bool is_paper = description.estimator.empty() && description.controller == "cardona_cassano" &&
                        !std::holds_alternative<integrate::RungeKutta>(plan.method.formula) &&
                        integrate::is_of_second_order(plan.method);
  if (is_paper || description.estimator == "inertia_jump") {
    const double known = description.reference_is_initial ? 0.0 : kind.reference();
    return integrate::InertiaJump{tolerance, description.reference ? reference : known, description.as_printed};
  }
  if (description.reference || description.reference_is_initial || description.as_printed)
    throw InvalidInput(description.where,
                       title + "\"reference\" and \"as_printed\" belong to the estimator inertia_jump");
  if (description.estimator == "local_error") return integrate::LocalError{tolerance};
  if (description.estimator == "embedded") return integrate::Embedded{tolerance};
  return kind.marches().default_estimator(plan, tolerance);
}

void plan_step_range(const std::string& title, const model::StepDescription& description,
                     const numerics::Parameters& parameters, double duration, integrate::StepPlan& plan) {
  plan.smallest = positive_or(description.smallest, least_step * duration, title + "smallest", parameters);
  plan.first = positive_or(description.first, 0.0, title + "first", parameters);
  if (!(plan.smallest <= plan.largest))
    throw InvalidInput(
        description.smallest ? description.smallest->where : description.where,
        fmt::format("{}the smallest step {} s is beyond the largest, {} s", title, plan.smallest, plan.largest));
  if (plan.first > 0.0 && !(plan.first >= plan.smallest && plan.first <= plan.largest))
    throw InvalidInput(description.first->where,
                       fmt::format("{}the first step {} s lies outside the range from {} s to {} s", title, plan.first,
                                   plan.smallest, plan.largest));
  if (std::holds_alternative<integrate::FixedStep>(plan.controller) && !description.first)
    throw InvalidInput(description.where,
                       title + "the controller fixed keeps the first step; give it, first = ... [s]");
}

void plan_swings(const model::StepDescription& description, const LoadSwings& swings, integrate::StepPlan& plan,
                 std::vector<std::string>& warnings) {
  if (std::holds_alternative<integrate::FixedStep>(plan.controller))
    return swings.warn_of_long_steps(plan.first, warnings);
  if (description.largest) return;
  swings.bound(plan);
  swings.warn_of_unknown(warnings);
}

}  // namespace

std::string advice_on_smallest(const integrate::StepPlan& plan, double duration) {
  if (!(plan.smallest > 1.01 * least_step * duration))
    return "look for a load that grows without bound or jumps unannounced (a table says where it jumps), allow a "
           "smaller step, or a larger tolerance";
  if (!(plan.smallest < plan.largest))
    return fmt::format(
        "smallest and largest are both {} s, which leaves it no choice: leave smallest out, take a larger "
        "tolerance, or the fixed step {} without a tolerance",
        plan.smallest, plan.smallest);
  return fmt::format("the study sets smallest = {} s: make it smaller or leave it out, or take a larger tolerance",
                     plan.smallest);
}

double positive_or(const std::optional<model::Quantity>& quantity, double otherwise, const std::string& what,
                   const numerics::Parameters& parameters) {
  if (!quantity) return otherwise;
  const double value = model::evaluate(*quantity, parameters, what);
  if (!(value > 0.0)) throw InvalidInput(quantity->where, fmt::format("{} must be positive, got {}", what, value));
  return value;
}

AutomaticStep plan_automatic_step(const integrate::TransientRequest& request, const integrate::SystemKind& kind,
                                  const integrate::MarchPlan& march, std::vector<std::string>& warnings) {
  const model::StepDescription& description = *request.description.automatic_step;
  const std::string title = request.title() + "step: ";
  AutomaticStep step;
  step.tolerance = model::evaluate(description.tolerance, request.parameters, title + "tolerance");
  const double reference = positive_or(description.reference, 0.0, title + "reference", request.parameters);
  integrate::StepPlan& plan = step.plan;
  plan.controller = controller_of(description.controller);
  plan.rebuild = description.rebuild;
  kind.marches().plan_events(title, description, march, plan);
  const LoadSwings swings(kind, march.duration);
  const double safe = std::min(march.duration / 50.0, swings.harmonic_limit());
  const double wanted = positive_or(description.largest, safe, title + "largest", request.parameters);
  plan.largest = kind.marches().largest_step(title, description, march, std::min(march.duration, wanted));
  plan_step_range(title, description, request.parameters, march.duration, plan);
  plan_swings(description, swings, plan, warnings);
  step.estimator = estimator_of(title, description, kind, march, step.tolerance, reference);
  try {
    kind.marches().try_estimator(march, step);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(description.tolerance.where, title + fault.message());
  }
  const bool is_fixed = std::holds_alternative<integrate::FixedStep>(plan.controller);
  step.expected_steps = is_fixed ? std::ceil(march.duration / plan.first) : swings.least_steps(plan);
  return step;
}

StepRecorder::StepRecorder(const std::string& analysis, const AutomaticStep& step, results::Sink& sink)
    : tolerance_(step.tolerance) {
  rows_ = sink.open({analysis,
                     "steps",
                     "time",
                     {{"time", "s", "start of the step that is tried", "", {}},
                      {"step", "s", "its length", "", {}},
                      {"error", "1", "its error, to be compared with the tolerance", "", {}},
                      {"accepted", "1", "1: accepted, 0: tried again with another length", "", {}},
                      {"reason",
                       "1",
                       "what became of it",
                       "",
                       {},
                       {"accepted", "error_too_large", "not_converged", "not_finite", "singular", "event"}}},
                     {{"type", "steps"},
                      {"tolerance", fmt::format("{}", step.tolerance)},
                      {"estimator", integrate::name_of(step.estimator)},
                      {"controller", integrate::name_of(step.plan.controller)}}});
}

void StepRecorder::tried(const integrate::StepTry& step_try) {
  const std::array<double, 5> row{step_try.t, step_try.step, step_try.error * tolerance_,
                                  step_try.outcome == integrate::TryOutcome::accepted ? 1.0 : 0.0,
                                  static_cast<double>(step_try.outcome)};
  rows_->append(row);
}

std::string summary(const AutomaticStep& step) {
  return fmt::format("tolerance {} ({}, {})", step.tolerance, integrate::name_of(step.estimator),
                     integrate::name_of(step.plan.controller));
}

std::string warning_of(const integrate::AdaptiveReport& report, const AutomaticStep& step) {
  if (report.beyond_tolerance == 0 || !step.asks_for_tolerance) return "";
  return fmt::format(
      "the tolerance {} is not met: the estimated error of {} of {} steps is above it, up to {:.2g} times; the "
      "controller "
      "fixed only watches: take the controller pi, or a shorter first step",
      step.tolerance, report.beyond_tolerance, report.march.steps, report.largest_error);
}

std::vector<std::pair<std::string, std::string>> statistics(const integrate::AdaptiveReport& report,
                                                            const integrate::MarchPlan& plan, double length) {
  if (!plan.automatic)
    return {{"steps", std::to_string(report.march.steps)}, {"factorisations", std::to_string(report.factorisations)}};
  std::vector<std::pair<std::string, std::string>> all{
      {"steps", std::to_string(report.march.steps)},       {"rejected", std::to_string(report.rejected)},
      {"failed", std::to_string(report.failed)},           {"events", std::to_string(report.events)},
      {"event_tries", std::to_string(report.event_tries)}, {"restarts", std::to_string(report.restarts)},
      {"solves", std::to_string(report.solves)},           {"factorisations", std::to_string(report.factorisations)}};
  if (report.march.steps > 0) {
    all.emplace_back("smallest_step", fmt::format("{:.6g} s", report.smallest_step));
    all.emplace_back("mean_step", fmt::format("{:.6g} s", length / static_cast<double>(report.march.steps)));
    all.emplace_back("largest_step", fmt::format("{:.6g} s", report.largest_step));
  }
  return all;
}

}  // namespace rubato::analysis
