#include <rubato/analysis/cyclic_modes.hpp>
#include <rubato/analysis/law_damping.hpp>
#include <rubato/analysis/method_study.hpp>
#include <rubato/analysis/modes.hpp>
#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/samples/samples.hpp>
#include <rubato/analysis/static.hpp>
#include <rubato/analysis/steady/damper_curve.hpp>
#include <rubato/analysis/steady/damper_curve_plan.hpp>
#include <rubato/analysis/steady/frequency_response.hpp>
#include <rubato/analysis/steady/frequency_response_plan.hpp>
#include <rubato/analysis/study_transients.hpp>
#include <rubato/analysis/transient.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/integrate/kinds/assemble_kind.hpp>
#include <rubato/results/drawing/kind_drawing.hpp>
#include <rubato/results/drawing/structure_drawing.hpp>

#include <fmt/format.h>

#include <memory>
#include <utility>

namespace rubato::analysis {
namespace {

std::string status_name(RunStatus status) {
  switch (status) {
    case RunStatus::done:
      return "done";
    case RunStatus::failed:
      return "failed";
    case RunStatus::interrupted:
      return "interrupted";
  }
  return {};
}

/// What the plan of an analysis warns of, and that it will fail.
template <typename Plan>
std::vector<std::string> warnings_of(const Plan& plan) {
  std::vector<std::string> warnings = plan.warnings;
  if (!plan.failure.empty()) warnings.push_back("it will fail: " + plan.failure);
  return warnings;
}

AnalysisOutline outline(const TransientPlan& plan) {
  // A number takes 8 bytes in netCDF and about 20 in CSV.
  AnalysisOutline result{summary(plan), plan.rows * plan.columns * 28.0};
  result.key_bytes = 5.0 * 28.0 * plan.columns;
  result.warnings = warnings_of(plan.march);
  return result;
}

AnalysisOutline outline(const FrequencyResponsePlan& plan, Index slider_count) {
  const auto observed = static_cast<double>(plan.observed.size());
  const auto sliders = static_cast<double>(slider_count);
  const double columns = static_cast<double>(plan.sweep.names().size()) + 10.0 + 3.0 * sliders +
                         observed * (5.0 + 2.0 * static_cast<double>(plan.request.harmonics.size()));
  double kept = 0.0;
  for (const bool is_kept : plan.waveform_at) kept += is_kept ? 1.0 : 0.0;
  const double waveforms = static_cast<double>(plan.sweep.lines()) * kept * plan.waveform_points;
  AnalysisOutline result;
  result.points = plan.points();
  result.expected_bytes = 36.0 *  // 8 of them in the journal
                          (plan.points() * columns + waveforms * (observed + 2.0 * sliders + 3.0));
  if (plan.sweep.kind() == Sweep::Kind::random) result.memory = 8.0 * plan.points() * observed;
  result.warnings = plan.warnings;
  result.summary = fmt::format("frequency response, {}, {} line{} of {} points", steady::route_name(plan.route.kind),
                               plan.sweep.lines(), plan.sweep.lines() == 1 ? "" : "s", plan.steps.size());
  return result;
}

AnalysisOutline outline(const DamperCurvePlan& plan, Index slider_count) {
  const double columns = static_cast<double>(plan.sweep.names().size()) + 8.0 +
                         static_cast<double>(plan.observed.size()) + 2.0 * static_cast<double>(slider_count);
  AnalysisOutline result;
  result.points = plan.points();
  result.expected_bytes = 36.0 * 2.0 * plan.points() * columns;  // peaks and limits are about as many again
  if (plan.sweep.kind() == Sweep::Kind::random) result.memory = 8.0 * plan.points();
  result.warnings = plan.warnings;
  result.summary = fmt::format("damper curve over {}, {}, {} line{} of {} values", plan.parameter,
                               steady::route_name(plan.route.kind), plan.sweep.lines(),
                               plan.sweep.lines() == 1 ? "" : "s", plan.values.size());
  return result;
}

AnalysisOutline outline(const ModesPlan& plan, const integrate::SystemKind& kind) {
  AnalysisOutline result;
  if (kind.is_constrained()) {
    result = {"modes of a mechanism", 28.0 * 20.0 * static_cast<double>(kind.system().size())};
  } else {
    const double limits = static_cast<double>(plan.limit_count(kind)), width = 7.0 + 2.0 * double(plan.observed.size());
    result = {fmt::format("modes, the lowest {} of {}", plan.count,
                          !plan.contacts.empty() ? fmt::format("each of {} limits", plan.contacts.size())
                          : limits > 1.0         ? "both limits"
                                                 : "the model"),
              limits * static_cast<double>(plan.count) * width * 28.0};
  }
  result.key_bytes = 2.0 * 28.0 * static_cast<double>(plan.count * plan.limit_count(kind));
  result.warnings = warnings_of(plan);
  return result;
}

AnalysisOutline outline(const SamplesPlan& plan) {
  AnalysisOutline result;
  result.summary = plan.summary;
  result.points = static_cast<double>(plan.sweep.lines());
  result.expected_bytes = 1.3 * result.points * plan.bytes_of_one;  // 8 bytes a number in the journal
  if (plan.sweep.kind() == Sweep::Kind::random) result.memory = 8.0 / 28.0 * result.points * plan.bytes_of_one;
  result.warnings = plan.warnings;
  return result;
}

/// Plans an analysis of its own kind.
struct Plan {
  const model::AnalysisDescription& analysis;
  const StudyInput& input;
  StudyTransients& transients;

  PlannedAnalysis operator()(const model::TransientDescription&) const {
    const auto plan = transients.plan(analysis);
    return {outline(*plan), [plan, name = analysis.name](const StudyInput& at, RunContext& context) {
              return run_transient(name, *plan, at.kind, context);
            }};
  }

  PlannedAnalysis operator()(const model::StaticDescription& equilibrium) const {
    std::shared_ptr<const integrate::SystemKind> free;
    if (equilibrium.without_friction)
      free = integrate::assemble_kind(without_friction(input.study.model), input.parameters);
    const integrate::SystemKind& kind = free ? *free : input.kind;
    const auto plan = std::make_shared<const StaticPlan>(plan_static(analysis.name, analysis.where, equilibrium, kind));
    AnalysisOutline result{kind.is_constrained() ? "static equilibrium of a mechanism" : "static equilibrium",
                           100.0 * static_cast<double>(kind.system().size())};
    result.key_bytes = result.expected_bytes;
    result.warnings = warnings_of(*plan);
    return {result, [plan, free, name = analysis.name](const StudyInput& at, RunContext& context) {
              const StopScope scope(context.stop);
              return run_static(name, *plan, free ? *free : at.kind, context);
            }};
  }

  PlannedAnalysis operator()(const model::ModesDescription& modes) const {
    const integrate::SystemKind& kind = input.kind;
    if (is_cyclic(input)) {
      const auto plan =
          std::make_shared<const CyclicModesPlan>(plan_cyclic_modes(analysis.name, analysis.where, modes, input));
      AnalysisOutline result{plan->summary, plan->expected_bytes};
      return {result, [plan, name = analysis.name](const StudyInput& at, RunContext& context) {
                return run_cyclic_modes(name, *plan, at.kind, context);
              }};
    }
    const auto plan = std::make_shared<const ModesPlan>(
        plan_modes(analysis.name, analysis.where, modes, kind, input.parameters, &transients));
    return {outline(*plan, kind), [plan, name = analysis.name](const StudyInput& at, RunContext& context) {
              return run_modes(name, *plan, at.kind, context);
            }};
  }

  PlannedAnalysis operator()(const model::MethodStudyDescription& study) const {
    require_structure();
    const auto plan = std::make_shared<const MethodStudyPlan>(
        plan_method_study(analysis.name, analysis.where, study, input.kind, input.parameters));
    return {{"method study: errors, orders and curves of each method", 1e7},
            [plan, name = analysis.name](const StudyInput& at, RunContext& context) {
              const StopScope scope(context.stop);
              return run_method_study(name, *plan, at.kind, context);
            }};
  }

  PlannedAnalysis operator()(const model::FrequencyResponseDescription& response) const {
    const auto plan = std::make_shared<const FrequencyResponsePlan>(
        plan_frequency_response(analysis.name, analysis.where, response, input));
    const auto& system = plan->system(input);
    at_the_analysis([&] { (void)steady::steady_solvers(plan->route).response(system, plan->request); });
    return {outline(*plan, system.slider_count()),
            [plan, name = analysis.name](const StudyInput& at, RunContext& context) {
              const StopScope scope(context.stop);
              return run_frequency_response(name, *plan, at, steady::steady_solvers(plan->route), context);
            }};
  }

  PlannedAnalysis operator()(const model::DamperCurveDescription& curve) const {
    const auto plan =
        std::make_shared<const DamperCurvePlan>(plan_damper_curve(analysis.name, analysis.where, curve, input));
    const auto& system = plan->system(input);
    at_the_analysis([&] { (void)damper_curve_solvers(*plan).response(system, plan->request); });
    return {outline(*plan, system.slider_count()),
            [plan, name = analysis.name](const StudyInput& at, RunContext& context) {
              const StopScope scope(context.stop);
              return run_damper_curve(name, *plan, at, damper_curve_solvers(*plan), context);
            }};
  }

 private:
  void require_structure() const {
    if (!input.kind.structure())
      throw InvalidInput(
          analysis.where,
          fmt::format("analysis \"{}\": a mechanism (bodies, joints, geometrically exact beams) is analysed "
                      "by type = \"transient\", \"static\", \"modes\" or \"frequency_response\"",
                      analysis.name));
  }

  template <typename Attempt>
  void at_the_analysis(Attempt&& attempt) const {
    try {
      attempt();
    } catch (const InvalidInput& fault) {
      throw InvalidInput(analysis.where, fault.message());
    }
  }
};

/// Analyses whose results are motions of the whole structure; those of a sweep have no shape to draw.
bool is_drawn(const model::AnalysisDescription& analysis) {
  if (swept_of(analysis)) return false;
  return std::holds_alternative<model::TransientDescription>(analysis.task) ||
         std::holds_alternative<model::ModesDescription>(analysis.task) ||
         std::holds_alternative<model::StaticDescription>(analysis.task);
}

/// Draws what was analysed, and concludes the results.
RunReport concluded(const model::AnalysisDescription& analysis, RunReport report, const StudyInput& input,
                    RunContext& context) {
  // Modes have written the configuration about which they are.
  if (!std::holds_alternative<model::ModesDescription>(analysis.task) && !swept_of(analysis))
    results::draw_start(analysis.name, input.kind, context.sink);
  const std::size_t nodes = input.kind.is_constrained() ? 0 : input.study.model.structure.nodes.size();
  if (is_drawn(analysis) && nodes > 0 && nodes <= results::most_drawn_nodes)
    results::write_structure(analysis.name, model::build(input.study.model, input.parameters).structure, context.sink);
  auto notes = report.statistics;
  for (std::size_t i = 0; i < report.warnings.size(); ++i)
    notes.emplace_back(fmt::format("warning{}", i + 1), report.warnings[i]);
  for (std::size_t i = 0; i < report.findings.size(); ++i)
    notes.emplace_back(fmt::format("finding{}", i + 1), report.findings[i]);
  context.sink.conclude(analysis.name, status_name(report.status), report.message, notes);
  return report;
}

/// Plans an analysis that is not repeated, or the sample of one that is.
PlannedAnalysis plan_one(const model::AnalysisDescription& analysis, const StudyInput& input) {
  StudyTransients own(input.study.analyses, input.kind, input.parameters);
  PlannedAnalysis planned =
      std::visit(Plan{analysis, input, input.transients ? *input.transients : own}, analysis.task);
  const bool moves = !std::holds_alternative<model::StaticDescription>(analysis.task);
  if (const auto warning = moves ? warning_of_modal_damping(input) : std::nullopt) {
    planned.outline.warnings.push_back(*warning);
    planned.run = [run = std::move(planned.run), warning = *warning](const StudyInput& at, RunContext& context) {
      RunReport report = run(at, context);
      report.warnings.push_back(warning);
      return report;
    };
  }
  return planned;
}

RunReport stopped() { return {RunStatus::interrupted, "interrupted before it had more to keep", {}}; }

}  // namespace

PlannedAnalysis plan_analysis(const model::AnalysisDescription& analysis, const StudyInput& input) {
  refuse_ambiguous_state(analysis, input.study.analyses);
  refuse_without_cyclic_condition(analysis, input);
  if (!swept_of(analysis)) return plan_one(analysis, input);
  const auto plan = std::make_shared<const SamplesPlan>(plan_samples(analysis, input, plan_one));
  return {outline(*plan), [plan, name = analysis.name](const StudyInput& at, RunContext& context) {
            return run_samples(name, *plan, at, plan_one, context);
          }};
}

RunReport run_analysis(const model::AnalysisDescription& analysis, const PlannedAnalysis& planned,
                       const StudyInput& input, RunContext& context) {
  RunReport report;
  try {
    report = planned.run(input, context);
  } catch (const Stopped&) {
    report = stopped();
  }
  return concluded(analysis, std::move(report), input, context);
}

RunReport run_analysis(const model::AnalysisDescription& analysis, const StudyInput& input, RunContext& context) {
  PlannedAnalysis planned;
  try {
    const StopScope scope(context.stop);
    planned = plan_analysis(analysis, input);
  } catch (const Stopped&) {
    return concluded(analysis, stopped(), input, context);
  }
  return run_analysis(analysis, planned, input, context);
}

}  // namespace rubato::analysis
