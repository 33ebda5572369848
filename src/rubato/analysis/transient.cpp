#include <rubato/analysis/events_table.hpp>
#include <rubato/analysis/failure_text.hpp>
#include <rubato/analysis/flow_transient.hpp>
#include <rubato/analysis/transient.hpp>
#include <rubato/analysis/transient_observer.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/results/columns/kind_columns.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {
namespace {

RunReport failed(const TransientPlan& plan, const std::string& message) {
  RunReport run;
  run.status = RunStatus::failed;
  run.message = message;
  run.warnings = plan.march.warnings;
  return run;
}

/// Marches, and shows every row. The march can begin.
integrate::AdaptiveReport march_and_record(const std::string& name, const TransientPlan& plan,
                                           const system::System& system, integrate::StepMarch& march,
                                           TransientRecorder& recorder, integrate::EnergyLedger* ledger,
                                           RunContext& context) {
  TransientObserver observer(
      plan, recorder, ledger,
      StepInterpolation(system, march.balance(), integrate::find_method(plan.march.method.name).order, march.kinks()),
      march.steps_a_report(), context, march.listener());
  observer.start(march.state());
  std::optional<StepRecorder> tries;
  if (plan.march.automatic && plan.march.step == 0.0) tries.emplace(name, *plan.march.automatic, context.sink);
  const integrate::AdaptiveReport report = march.go_to(plan.march.duration, &observer, tries ? &*tries : nullptr);
  observer.finish(march.state());
  return report;
}

/// Of a residue beyond ten tolerances, or of equal steps beyond a thousandth of the largest energy. Works are summed by
/// trapezoids, so that the residue of a method of higher order is theirs, where there are any.
std::string warning_of_residue(const TransientRecorder& recorder, const TransientPlan& plan, double round_off,
                               const integrate::Events& events) {
  const bool sums_well = integrate::find_method(plan.march.method.name).order <= 2;
  if (!recorder.residue() || !(sums_well || recorder.residue()->is_closed())) return "";
  constexpr double least = 1e-5;  // of the largest energy; less is nothing to worry about
  if (plan.march.automatic && plan.march.step == 0.0)
    return recorder.residue()->warning(
        std::max(least, 10.0 * plan.march.automatic->tolerance), round_off, events,
        fmt::format("take a smaller tolerance than {}", plan.march.automatic->tolerance));
  return recorder.residue()->warning(
      1e-3, round_off, events,
      fmt::format("take a shorter step than {:.6g} s, or step = {{ tolerance = 1e-3 }}, which watches its error",
                  plan.march.step));
}

}  // namespace

RunReport run_transient(const std::string& name, const TransientPlan& plan, const integrate::SystemKind& kind,
                        RunContext& context) {
  if (!plan.march.failure.empty()) return failed(plan, plan.march.failure);
  if (std::holds_alternative<integrate::Exact>(plan.march.method.formula))
    return run_flow(name, plan, *kind.marches().flow(plan.march), context);
  const auto march = kind.marches().march(plan.march);
  integrate::EnergyLedger energy(march->energy_parts());
  integrate::EnergyLedger* const ledger = plan.energy ? &energy : nullptr;
  TransientRecorder recorder(name, plan, results::columns_of_motion(*march, plan.observed, plan.section_forces),
                             march->balance(), ledger, context.sink);
  if (plan.march.automatic)
    context.progress.begin(name, plan.march.duration, "s of motion");
  else
    context.progress.begin(name, std::ceil(plan.march.duration / plan.march.step), "steps");
  integrate::AdaptiveReport report;
  report.march.step = march->start_fault();
  const bool has_begun = report.march.step.outcome == integrate::StepOutcome::accepted;
  if (has_begun) {
    report = march_and_record(name, plan, kind.system(), *march, recorder, ledger, context);
  } else {
    report.march.end = integrate::MarchEnd::failed;
    report.march.failed_step = plan.march.step;
  }
  context.progress.end();
  const system::State& state = march->state();
  RunReport run;
  run.warnings = plan.march.warnings;
  if (has_begun) run.statistics = statistics(report, plan.march, state.t);
  run.statistics.emplace_back("rows", std::to_string(recorder.rows()));
  if (has_begun && plan.march.automatic)
    if (const std::string warning = warning_of(report, *plan.march.automatic); !warning.empty())
      run.warnings.push_back(warning);
  if (has_begun) {
    const integrate::Events events = march->events();
    write_events(name, events, context.sink);
    recorder.write_extremes(context.sink);
    if (const std::string warning = warning_of(events); !warning.empty()) run.warnings.push_back(warning);
  }
  const integrate::MarchNotes notes = march->notes(report);
  run.statistics.insert(run.statistics.end(), notes.statistics.begin(), notes.statistics.end());
  run.warnings.insert(run.warnings.end(), notes.warnings.begin(), notes.warnings.end());
  if (has_begun)
    if (const std::string warning = warning_of_residue(recorder, plan, march->energy_round_off(), march->events());
        !warning.empty())
      run.warnings.push_back(warning);
  run.findings.insert(run.findings.end(), notes.findings.begin(), notes.findings.end());
  if (notes.known > 0.0) report_events(march->events(), notes.known, run.findings);
  if (report.march.end == integrate::MarchEnd::failed) {
    run.status = RunStatus::failed;
    const integrate::MarchFailure failure = march->failure(report.march);
    run.message = text_of(failure, advice_on_step(failure, plan.march));
  } else if (report.march.end == integrate::MarchEnd::stopped && state.t < plan.march.duration) {
    run.status = RunStatus::interrupted;
    run.message = fmt::format("interrupted at t = {:.6g} s of {} s", state.t, plan.march.duration);
  }
  return run;
}

}  // namespace rubato::analysis
