#include <rubato/analysis/parameter_dependence.hpp>
#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/samples/samples_plan.hpp>
#include <rubato/analysis/steady/steady_plan.hpp>
#include <rubato/integrate/kinds/assemble_kind.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <type_traits>
#include <utility>
#include <variant>

namespace rubato::analysis {
namespace {

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

/// Null where an analysis of its type is not repeated, or has a sweep of its own.
template <class Analysis>
auto* swept_of_task(Analysis& analysis) {
  using Swept = std::conditional_t<std::is_const_v<Analysis>, const model::SweptDescription, model::SweptDescription>;
  return std::visit(
      [](auto& task) -> Swept* {
        if constexpr (requires { task.swept; })
          return &task.swept;
        else
          return nullptr;
      },
      analysis.task);
}

/// The names of swept parameters, as they are written.
std::vector<std::string> names_of(const model::SweepDescription& sweep) {
  std::vector<std::string> names;
  if (const auto* grid = std::get_if<model::GridSweepDescription>(&sweep))
    for (const auto& [name, values] : grid->parameters) names.push_back(name);
  if (const auto* cases = std::get_if<model::CaseSweepDescription>(&sweep)) names = cases->names;
  if (const auto* random = std::get_if<model::RandomSweepDescription>(&sweep))
    for (const auto& distribution : random->parameters) names.push_back(distribution.parameter);
  return names;
}

void take(const std::optional<model::Quantity>& quantity, std::vector<model::Quantity>& to) {
  if (quantity) to.push_back(*quantity);
}

void take(const model::MethodDescription& method, std::vector<model::Quantity>& to) {
  for (const auto& [key, quantity] : method.parameters) to.push_back(quantity);
}

/// The numbers of an analysis that may be formulas of the parameters.
std::vector<model::Quantity> quantities_of(const model::AnalysisDescription& analysis,
                                           const std::vector<model::AnalysisDescription>& analyses) {
  std::vector<model::Quantity> quantities;
  if (const auto* transient = std::get_if<model::TransientDescription>(&analysis.task)) {
    take(transient->method, quantities);
    take(transient->step, quantities);
    quantities.push_back(transient->duration);
    quantities.push_back(transient->output.interval);
    for (const auto& time : transient->output.times) quantities.push_back(time);
    if (const auto& step = transient->automatic_step) {
      quantities.push_back(step->tolerance);
      for (const auto* quantity : {&step->first, &step->smallest, &step->largest, &step->reference})
        take(*quantity, quantities);
    }
  }
  if (const auto* modes = std::get_if<model::ModesDescription>(&analysis.task)) {
    take(modes->count, quantities);
    for (const auto& limit : modes->contacts.value_or(std::vector<model::ContactLimitDescription>{}))
      for (const auto& [name, sign] : limit.sliding) quantities.push_back(sign);
    if (const auto& reached = modes->about_reached) {
      take(reached->time, quantities);
      for (const auto& other : analyses)
        if (other.name == reached->analysis && std::holds_alternative<model::TransientDescription>(other.task)) {
          const auto more = quantities_of(other, {});
          quantities.insert(quantities.end(), more.begin(), more.end());
        }
    }
  }
  return quantities;
}

/// Names that columns of these results have, and that a parameter cannot bear. Columns of a model's parts are compared
/// when they are known, in the run.
const std::vector<std::string>& taken_names() {
  static const std::vector<std::string> names{"sample",
                                              "status",
                                              "warnings",
                                              "steps",
                                              "time_end",
                                              "time",
                                              "mode",
                                              "limit",
                                              "frequency",
                                              "state",
                                              "angular_frequency",
                                              "position",
                                              "angle",
                                              "shape",
                                              "damping_ratio",
                                              "engine_order",
                                              "coordinate",
                                              "rotation",
                                              "slider",
                                              "joint",
                                              "reason",
                                              "statistic",
                                              "histories",
                                              "modes",
                                              "failures",
                                              "crossings",
                                              "statistics",
                                              "eigenvalue_real",
                                              "eigenvalue_imaginary"};
  return names;
}

void require_effects(const SamplesPlan& plan, const StudyInput& input, const std::string& title) {
  const ParameterDependence dependence = dependence_of(input, plan.sweep.places());
  const auto quantities = quantities_of(plan.sample, input.study.analyses);
  for (std::size_t i = 0; i < plan.sweep.places().size(); ++i) {
    const std::size_t parameter = plan.sweep.places()[i];
    const std::string& name = plan.sweep.names()[i];
    const bool does_something = dependence.reaches_model(parameter) ||
                                std::any_of(quantities.begin(), quantities.end(), [&](const model::Quantity& quantity) {
                                  return dependence.follows(quantity, parameter);
                                });
    if (!does_something)
      throw InvalidInput(
          plan.sweep.where()[i],
          fmt::format("{}nothing in the model or in this analysis depends on the swept parameter \"{}\"; "
                      "use it there, or leave it out of the sweep",
                      title, name));
    if (std::find(taken_names().begin(), taken_names().end(), name) != taken_names().end())
      throw InvalidInput(plan.sweep.where()[i],
                         fmt::format("{}the swept parameter \"{}\" would head a column of results that has another "
                                     "meaning; rename it",
                                     title, name));
  }
}

}  // namespace

const model::SweptDescription* swept_of(const model::AnalysisDescription& analysis) {
  const model::SweptDescription* swept = swept_of_task(analysis);
  return swept && swept->is_wanted() ? swept : nullptr;
}

void refuse_ambiguous_state(const model::AnalysisDescription& analysis,
                            const std::vector<model::AnalysisDescription>& analyses) {
  const auto* modes = std::get_if<model::ModesDescription>(&analysis.task);
  if (!modes || !modes->about_reached) return;
  const model::ReachedDescription& reached = *modes->about_reached;
  const auto other =
      std::find_if(analyses.begin(), analyses.end(), [&](const auto& one) { return one.name == reached.analysis; });
  const model::SweptDescription* swept = other == analyses.end() ? nullptr : swept_of(*other);
  if (!swept) return;
  const std::vector<std::string> own = names_of(modes->swept.sweep);
  for (const std::string& name : names_of(swept->sweep)) {
    if (std::find(own.begin(), own.end(), name) != own.end()) continue;
    throw InvalidInput(
        place(reached.analysis_where, analysis.where),
        fmt::format("analysis \"{}\": about names \"{}\", which is repeated over \"{}\": which of its samples "
                    "is meant is not said; sweep these modes over \"{}\" too, or refer to a transient "
                    "without a sweep",
                    analysis.name, reached.analysis, name, name));
  }
}

SamplesPlan plan_samples(const model::AnalysisDescription& analysis, const StudyInput& input,
                         const SamplePlanner& plan_one) {
  const model::SweptDescription& swept = *swept_of(analysis);
  const std::string title = "analysis \"" + analysis.name + "\": ";
  const Location where = place(swept.where, analysis.where);
  SamplesPlan plan{analysis, Sweep(swept.sweep, where, input, title), swept.keeps_samples};
  *swept_of_task(plan.sample) = {};
  // Key numbers see every step; rows at other times are for histories alone.
  if (auto* transient = std::get_if<model::TransientDescription>(&plan.sample.task)) {
    if (!plan.keeps_samples) transient->output = {};
    transient->output.shows_every_step = plan.keeps_samples;
  }
  require_effects(plan, input, title);
  if (!swept.engine_orders.empty()) plan.campbell = plan_campbell(swept, plan.sweep, input.parameters, title, where);
  std::vector<std::pair<std::size_t, std::string>> given;
  for (const std::size_t parameter : plan.sweep.places()) given.emplace_back(parameter, "the sweep");
  plan.warnings = warn_of_settings(input, given);
  Possibility possibility(title, where);
  for (const long number : {0L, plan.sweep.lines() - 1})
    possibility.attempt([&] {
      const SampleModel model(plan.sweep, number, input);
      const PlannedAnalysis one = plan_one(plan.sample, model.input());
      if (!plan.summary.empty()) return;
      plan.summary = fmt::format("{} sample{} over {}: {}", plan.sweep.lines(), plan.sweep.lines() == 1 ? "" : "s",
                                 fmt::join(plan.sweep.names(), ", "), one.outline.summary);
      plan.bytes_of_one = one.outline.key_bytes + (plan.keeps_samples ? 2.0 * one.outline.expected_bytes : 0.0);
    });
  possibility.require();
  return plan;
}

SampleModel::SampleModel(const Sweep& sweep, long number, const StudyInput& input) : study_(input.study) {
  std::vector<double> values(sweep.names().size());
  sweep.values(number, values);
  for (const auto& setting : input.overrides)
    if (std::find(sweep.names().begin(), sweep.names().end(), setting.first) == sweep.names().end())
      overrides_.push_back(setting);
  for (std::size_t i = 0; i < values.size(); ++i) overrides_.emplace_back(sweep.names()[i], values[i]);
  parameters_ = model::evaluate_parameters(study_.parameters, overrides_);
  kind_ = integrate::assemble_kind(study_.model, parameters_);
}

std::string place_text(const Sweep& sweep, long number) {
  std::vector<double> values(sweep.names().size());
  sweep.values(number, values);
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i)
    text += fmt::format("{}{} = {:.6g}", text.empty() ? "" : ", ", sweep.names()[i], values[i]);
  return text;
}

}  // namespace rubato::analysis
