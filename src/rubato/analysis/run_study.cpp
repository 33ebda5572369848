#include <rubato/analysis/method_study.hpp>
#include <rubato/analysis/run_study.hpp>
#include <rubato/analysis/static.hpp>
#include <rubato/analysis/transient.hpp>
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
                         2.0 * static_cast<double>(system.slider_count()) + (plan.energy ? 8.0 : 0.0);
  // A number takes 8 bytes in netCDF and about 20 in CSV.
  AnalysisOutline result{"", plan.rows * columns * 28.0};
  if (plan.step > 0.0)
    result.summary = fmt::format("transient, {}, {:.0f} steps of {} s to t = {} s", plan.method.name,
                                 std::ceil(plan.duration / plan.step * (1.0 - 1e-12)), plan.step, plan.duration);
  else
    result.summary = fmt::format("transient, {}, to t = {} s", plan.method.name, plan.duration);
  return result;
}

}  // namespace

AnalysisOutline check_analysis(const model::AnalysisDescription& analysis, const system::LocallyNonlinear& system,
                               const numerics::Parameters& parameters) {
  if (const auto* transient = std::get_if<model::TransientDescription>(&analysis.task)) {
    const TransientPlan plan = plan_transient(analysis.name, analysis.where, *transient, system, parameters);
    if (std::holds_alternative<integrate::Exact>(plan.method.formula)) check_exact_transient(analysis.where, system);
    if (std::holds_alternative<integrate::Exponential>(plan.method.formula)) {
      try {
        (void)integrate::make_stepper(plan.method, system);
      } catch (const InvalidInput& fault) {
        throw InvalidInput(analysis.where, fault.message());
      }
    }
    return outline(plan, system);
  }
  if (const auto* equilibrium = std::get_if<model::StaticDescription>(&analysis.task)) {
    (void)equilibrium_of(analysis.name, analysis.where, *equilibrium, system);
    (void)observed_or_all(equilibrium->observe, system);
    return {"static equilibrium", 100.0 * static_cast<double>(system.size())};
  }
  const auto& study = std::get<model::MethodStudyDescription>(analysis.task);
  check_method_study(analysis.name, analysis.where, study, system, parameters);
  return {"method study: errors, orders and curves of each method", 1e7};
}

RunReport run_analysis(const model::AnalysisDescription& analysis, const system::LocallyNonlinear& system,
                       const numerics::Parameters& parameters, RunContext& context) {
  RunReport report;
  if (const auto* transient = std::get_if<model::TransientDescription>(&analysis.task))
    report = run_transient(analysis.name, plan_transient(analysis.name, analysis.where, *transient, system, parameters),
                           system, context);
  else if (const auto* equilibrium = std::get_if<model::StaticDescription>(&analysis.task))
    report = run_static(analysis.name, analysis.where, *equilibrium, system, context);
  else
    report = run_method_study(analysis.name, std::get<model::MethodStudyDescription>(analysis.task), system, parameters,
                              context);
  context.sink.conclude(analysis.name, status_name(report.status), report.message, report.statistics);
  return report;
}

}  // namespace rubato::analysis
