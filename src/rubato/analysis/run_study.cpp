#include <rubato/analysis/mechanism_equilibrium.hpp>
#include <rubato/analysis/mechanism_modes.hpp>
#include <rubato/analysis/mechanism_tables.hpp>
#include <rubato/analysis/mechanism_transient.hpp>
#include <rubato/analysis/method_study.hpp>
#include <rubato/analysis/modes.hpp>
#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/static.hpp>
#include <rubato/analysis/steady/damper_curve.hpp>
#include <rubato/analysis/steady/damper_curve_plan.hpp>
#include <rubato/analysis/steady/frequency_response.hpp>
#include <rubato/analysis/steady/frequency_response_plan.hpp>
#include <rubato/analysis/structure_tables.hpp>
#include <rubato/analysis/transient.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/integrate/stepper.hpp>

#include <fmt/format.h>

#include <cmath>

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

AnalysisOutline outline(const TransientPlan& plan, const system::LocallyNonlinear& system) {
  const double columns = 1.0 + 3.0 * static_cast<double>(plan.observed.size()) +
                         2.0 * static_cast<double>(system.contact_count()) + (plan.energy ? 8.0 : 0.0);
  // A number takes 8 bytes in netCDF and about 20 in CSV.
  AnalysisOutline result{"", plan.rows * columns * 28.0};
  if (plan.step > 0.0)
    result.summary = fmt::format("transient, {}, {:.0f} steps of {} s to t = {} s", plan.method.name,
                                 std::ceil(plan.duration / plan.step * (1.0 - 1e-12)), plan.step, plan.duration);
  else
    result.summary = fmt::format("transient, {}, {}to t = {} s", plan.method.name,
                                 plan.automatic ? summary(*plan.automatic) + ", " : "", plan.duration);
  result.warnings = plan.warnings;
  return result;
}

AnalysisOutline outline(const FrequencyResponsePlan& plan, const system::LocallyNonlinear& system) {
  const auto observed = static_cast<double>(plan.observed.size());
  const auto sliders = static_cast<double>(system.slider_count());
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
  result.summary = fmt::format("frequency response, {}, {} line{} of {} points", route_name(plan.route.kind),
                               plan.sweep.lines(), plan.sweep.lines() == 1 ? "" : "s", plan.steps.size());
  return result;
}

AnalysisOutline outline(const DamperCurvePlan& plan, const system::LocallyNonlinear& system) {
  const double columns = static_cast<double>(plan.sweep.names().size()) + 8.0 +
                         static_cast<double>(plan.observed.size()) + 2.0 * static_cast<double>(system.slider_count());
  AnalysisOutline result;
  result.points = plan.points();
  result.expected_bytes = 36.0 * 2.0 * plan.points() * columns;  // peaks and limits are about as many again
  if (plan.sweep.kind() == Sweep::Kind::random) result.memory = 8.0 * plan.points();
  result.warnings = plan.warnings;
  result.summary = fmt::format("damper curve over {}, {} line{} of {} values", plan.parameter, plan.sweep.lines(),
                               plan.sweep.lines() == 1 ? "" : "s", plan.values.size());
  return result;
}

AnalysisOutline outline(const ModesPlan& plan, const system::LocallyNonlinear& system) {
  const double limits = system.slider_count() > 0 ? 2.0 : 1.0, width = 7.0 + 2.0 * double(plan.observed.size());
  return {fmt::format("modes, the lowest {} of {}", plan.count, limits > 1.0 ? "both limits" : "the model"),
          limits * static_cast<double>(plan.count) * width * 28.0};
}

/// Calls with the plan of an analysis's own kind: what checks it, or what runs it.
struct Check {
  const model::AnalysisDescription& analysis;
  const StudyInput& input;

  template <typename Attempt>
  void at_the_analysis(Attempt&& attempt) const {
    try {
      attempt();
    } catch (const InvalidInput& fault) {
      throw InvalidInput(analysis.where, fault.message());
    }
  }

  AnalysisOutline operator()(const model::TransientDescription& transient) const {
    const TransientPlan plan = plan_transient(analysis.name, analysis.where, transient, input.system, input.parameters);
    if (std::holds_alternative<integrate::Exact>(plan.method.formula))
      check_exact_transient(analysis.where, input.system);
    if (std::holds_alternative<integrate::Exponential>(plan.method.formula))
      at_the_analysis([&] { (void)integrate::make_stepper(plan.method, input.system); });
    return outline(plan, input.system);
  }

  AnalysisOutline operator()(const model::MethodStudyDescription& study) const {
    check_method_study(analysis.name, analysis.where, study, input.system, input.parameters);
    return {"method study: errors, orders and curves of each method", 1e7};
  }

  AnalysisOutline operator()(const model::StaticDescription& equilibrium) const {
    (void)equilibrium_of(analysis.name, analysis.where, equilibrium, input.system);
    (void)observed_or_all(equilibrium.observe, input.system);
    return {"static equilibrium", 100.0 * static_cast<double>(input.system.size())};
  }

  AnalysisOutline operator()(const model::ModesDescription& modes) const {
    return outline(plan_modes(analysis.name, analysis.where, modes, input.system, input.parameters), input.system);
  }

  AnalysisOutline operator()(const model::FrequencyResponseDescription& response) const {
    const FrequencyResponsePlan plan = plan_frequency_response(analysis.name, analysis.where, response, input);
    at_the_analysis([&] { (void)steady_solvers(plan.route).response(input.system, plan.request); });
    return outline(plan, input.system);
  }

  AnalysisOutline operator()(const model::DamperCurveDescription& curve) const {
    const DamperCurvePlan plan = plan_damper_curve(analysis.name, analysis.where, curve, input);
    at_the_analysis([&] { (void)damper_curve_solvers().response(input.system, plan.request); });
    return outline(plan, input.system);
  }
};

/// A plan, made so that a request to stop is heard. (Marches hear of it themselves, at the end of each step, and keep
/// what they have: they must not be left in the midst of one.)
template <typename Make>
auto planned(const RunContext& context, Make&& make) {
  const StopScope scope(context.stop);
  return make();
}

struct Run {
  const model::AnalysisDescription& analysis;
  const StudyInput& input;
  RunContext& context;

  RunReport operator()(const model::TransientDescription& transient) const {
    return run_transient(
        analysis.name,
        planned(
            context,
            [&] { return plan_transient(analysis.name, analysis.where, transient, input.system, input.parameters); }),
        input.system, context);
  }

  RunReport operator()(const model::MethodStudyDescription& study) const {
    const StopScope scope(context.stop);
    return run_method_study(analysis.name, study, input.system, input.parameters, context);
  }

  RunReport operator()(const model::StaticDescription& equilibrium) const {
    const StopScope scope(context.stop);
    return run_static(analysis.name, analysis.where, equilibrium, input.system, context);
  }

  RunReport operator()(const model::ModesDescription& modes) const {
    return run_modes(analysis.name, plan_modes(analysis.name, analysis.where, modes, input.system, input.parameters),
                     input.system, context);
  }

  RunReport operator()(const model::FrequencyResponseDescription& response) const {
    const StopScope scope(context.stop);
    const FrequencyResponsePlan plan = plan_frequency_response(analysis.name, analysis.where, response, input);
    return run_frequency_response(analysis.name, plan, input, steady_solvers(plan.route), context);
  }

  RunReport operator()(const model::DamperCurveDescription& curve) const {
    const StopScope scope(context.stop);
    return run_damper_curve(analysis.name, plan_damper_curve(analysis.name, analysis.where, curve, input), input,
                            damper_curve_solvers(), context);
  }
};

/// Analyses whose results are motions of the whole structure; those of a sweep have no shape to draw.
bool is_drawn(const model::AnalysisDescription& analysis) {
  return std::holds_alternative<model::TransientDescription>(analysis.task) ||
         std::holds_alternative<model::ModesDescription>(analysis.task) ||
         std::holds_alternative<model::StaticDescription>(analysis.task);
}

}  // namespace

namespace {

[[noreturn]] void refuse_of_mechanism(const model::AnalysisDescription& analysis) {
  throw InvalidInput(analysis.where,
                     fmt::format("analysis \"{}\": a mechanism (bodies, joints, geometrically exact beams) is analysed "
                                 "by type = \"transient\", \"static\" or \"modes\"",
                                 analysis.name));
}

/// What the plan of an analysis of a mechanism warns of, and that it will fail.
template <typename Plan>
std::vector<std::string> warnings_of(const Plan& plan) {
  std::vector<std::string> warnings = plan.warnings;
  if (!plan.failure.empty()) warnings.push_back("it will fail: " + plan.failure);
  return warnings;
}

AnalysisOutline check_mechanism(const model::AnalysisDescription& analysis, const StudyInput& input) {
  const system::Mechanism& mechanism = *input.mechanism;
  if (const auto* transient = std::get_if<model::TransientDescription>(&analysis.task)) {
    const MechanismPlan plan = plan_mechanism(analysis.name, analysis.where, *transient, mechanism, input.parameters);
    AnalysisOutline outline{
        plan.summary(),
        plan.transient.rows * (10.0 + 3.0 * static_cast<double>(plan.transient.observed.size())) * 28.0};
    outline.warnings = warnings_of(plan);
    return outline;
  }
  if (const auto* equilibrium = std::get_if<model::StaticDescription>(&analysis.task)) {
    AnalysisOutline outline{"static equilibrium of a mechanism", 100.0 * static_cast<double>(mechanism.size())};
    outline.warnings = check_mechanism_static(analysis.name, analysis.where, *equilibrium, mechanism);
    return outline;
  }
  if (const auto* modes = std::get_if<model::ModesDescription>(&analysis.task)) {
    AnalysisOutline outline{"modes of a mechanism", 28.0 * 20.0 * static_cast<double>(mechanism.size())};
    outline.warnings = warnings_of(plan_mechanism_modes(analysis.name, analysis.where, *modes, mechanism, input));
    return outline;
  }
  refuse_of_mechanism(analysis);
}

RunReport told_of_friction(RunReport report, const system::Mechanism& mechanism) {
  report.message = with_friction_told(report.message, mechanism);
  return report;
}

RunReport run_mechanism_analysis(const model::AnalysisDescription& analysis, const StudyInput& input,
                                 RunContext& context) {
  const system::Mechanism& mechanism = *input.mechanism;
  if (const auto* transient = std::get_if<model::TransientDescription>(&analysis.task))
    return run_mechanism(
        analysis.name,
        planned(context,
                [&] { return plan_mechanism(analysis.name, analysis.where, *transient, mechanism, input.parameters); }),
        mechanism, context);
  if (const auto* equilibrium = std::get_if<model::StaticDescription>(&analysis.task)) {
    const StopScope scope(context.stop);
    return told_of_friction(run_mechanism_static(analysis.name, analysis.where, *equilibrium, mechanism, context),
                            mechanism);
  }
  if (const auto* modes = std::get_if<model::ModesDescription>(&analysis.task))
    return run_mechanism_modes(
        analysis.name,
        planned(context, [&] { return plan_mechanism_modes(analysis.name, analysis.where, *modes, mechanism, input); }),
        mechanism, context);
  refuse_of_mechanism(analysis);
}

}  // namespace

AnalysisOutline check_analysis(const model::AnalysisDescription& analysis, const StudyInput& input) {
  return input.mechanism ? check_mechanism(analysis, input) : std::visit(Check{analysis, input}, analysis.task);
}

RunReport run_analysis(const model::AnalysisDescription& analysis, const StudyInput& input, RunContext& context) {
  RunReport report;
  try {
    report = input.mechanism ? run_mechanism_analysis(analysis, input, context)
                             : std::visit(Run{analysis, input, context}, analysis.task);
  } catch (const Stopped&) {
    report = {RunStatus::interrupted, "interrupted before it had more to keep", {}};
  }
  // Modes have written the configuration about which they are.
  if (input.mechanism && !std::holds_alternative<model::ModesDescription>(analysis.task))
    write_structure(analysis.name, input.mechanism->model(), context.sink);
  const std::size_t nodes = input.mechanism ? 0 : input.study.model.structure.nodes.size();
  if (is_drawn(analysis) && nodes > 0 && nodes <= most_drawn_nodes)
    write_structure(analysis.name, model::build(input.study.model, input.parameters).structure, context.sink);
  auto notes = report.statistics;
  for (std::size_t i = 0; i < report.warnings.size(); ++i)
    notes.emplace_back(fmt::format("warning{}", i + 1), report.warnings[i]);
  for (std::size_t i = 0; i < report.findings.size(); ++i)
    notes.emplace_back(fmt::format("finding{}", i + 1), report.findings[i]);
  context.sink.conclude(analysis.name, status_name(report.status), report.message, notes);
  return report;
}

}  // namespace rubato::analysis
