#include <rubato/analysis/events_table.hpp>
#include <rubato/analysis/failure_text.hpp>
#include <rubato/analysis/transient_kind.hpp>
#include <rubato/analysis/transient_observer.hpp>
#include <rubato/integrate/catalogue.hpp>

#include <fmt/format.h>

#include <cmath>

namespace rubato::analysis {
namespace {

RunReport failed(const TransientPlan& plan, const std::string& message) {
  RunReport run;
  run.status = RunStatus::failed;
  run.message = message;
  run.warnings = plan.warnings;
  return run;
}

/// Marches, and shows every row. The march can begin.
integrate::AdaptiveReport march_and_record(const std::string& name, const TransientPlan& plan,
                                           const system::System& system, TransientMarch& march,
                                           TransientRecorder& recorder, integrate::EnergyLedger* ledger,
                                           RunContext& context) {
  TransientObserver observer(
      plan, recorder, ledger,
      StepInterpolation(system, march.balance(), integrate::find_method(plan.method.name).order, march.kinks()),
      march.steps_a_report(), context, march.listener());
  observer.start(march.state());
  std::optional<StepRecorder> tries;
  if (plan.automatic && plan.step == 0.0) tries.emplace(name, *plan.automatic, context.sink);
  const integrate::AdaptiveReport report = march.go_to(plan.duration, &observer, tries ? &*tries : nullptr);
  observer.finish(march.state());
  return report;
}

}  // namespace

RunReport TransientKind::run(const std::string& name, const TransientPlan& plan, RunContext& context) const {
  if (!plan.failure.empty()) return failed(plan, plan.failure);
  const auto march = this->march(plan);
  integrate::EnergyLedger energy(march->energy_parts());
  integrate::EnergyLedger* const ledger = plan.energy ? &energy : nullptr;
  TransientRecorder recorder(name, plan, march->columns(), march->balance(), ledger, context.sink);
  if (plan.automatic)
    context.progress.begin(name, plan.duration, "s of motion");
  else
    context.progress.begin(name, std::ceil(plan.duration / plan.step), "steps");
  integrate::AdaptiveReport report;
  report.march.step = march->start_fault();
  const bool has_begun = report.march.step.outcome == integrate::StepOutcome::accepted;
  if (has_begun) {
    report = march_and_record(name, plan, observable().system, *march, recorder, ledger, context);
  } else {
    report.march.end = integrate::MarchEnd::failed;
    report.march.failed_step = plan.step;
  }
  context.progress.end();
  const system::State& state = march->state();
  RunReport run;
  run.warnings = plan.warnings;
  if (has_begun) run.statistics = statistics(report, plan, state.t);
  run.statistics.emplace_back("rows", std::to_string(recorder.rows()));
  if (has_begun && plan.automatic)
    if (const std::string warning = warning_of(report, *plan.automatic); !warning.empty())
      run.warnings.push_back(warning);
  if (has_begun) {
    const integrate::Events events = march->events();
    write_events(name, events, context.sink);
    if (const std::string warning = warning_of(events); !warning.empty()) run.warnings.push_back(warning);
  }
  march->conclude(report, run);
  if (report.march.end == integrate::MarchEnd::failed) {
    run.status = RunStatus::failed;
    const integrate::MarchFailure failure = march->failure(report.march);
    run.message = text_of(failure, advice_on_step(failure, plan));
  } else if (report.march.end == integrate::MarchEnd::stopped && state.t < plan.duration) {
    run.status = RunStatus::interrupted;
    run.message = fmt::format("interrupted at t = {:.6g} s of {} s", state.t, plan.duration);
  }
  return run;
}

}  // namespace rubato::analysis
