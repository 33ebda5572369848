#include <rubato/analysis/transient.hpp>
#include <rubato/analysis/transient_observer.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/load_jumps.hpp>
#include <rubato/integrate/structure_balance.hpp>
#include <rubato/integrate/structure_energy.hpp>
#include <rubato/results/columns/structure_columns.hpp>

#include <fmt/format.h>

#include <cmath>

namespace rubato::analysis {
namespace {

std::string missed_jumps(const integrate::LoadJumps& jumps) {
  return fmt::format(
      "{} of a load {} within a step, the first at t = {:.9g} s: it is seen at the end of that step, an error of first "
      "order; give a step that divides the times of jumps, or step = {{ tolerance = 1e-3 }}",
      jumps.missed() == 1 ? "1 jump" : fmt::format("{} jumps", jumps.missed()), jumps.missed() == 1 ? "falls" : "fall",
      jumps.first_missed());
}

std::string contact_name(Index contact, const system::LocallyNonlinear& system) {
  if (contact < 0) return "";
  const Index stop = contact - system.slider_count(), law = contact - system.first_law();
  if (law >= 0) return system.laws()[static_cast<std::size_t>(law)].name;
  return stop < 0 ? system.sliders()[static_cast<std::size_t>(contact)].name
                  : system.stops()[static_cast<std::size_t>(stop)].name;
}

std::string reason(const integrate::MarchReport& report, const TransientPlan& plan,
                   const system::LocallyNonlinear& system) {
  const auto coordinate = [&](Index i) {
    return i >= 0 ? fmt::format(" at coordinate \"{}\"", system.coordinates()[static_cast<std::size_t>(i)]) : "";
  };
  std::string what, remedy;
  switch (report.step.outcome) {
    case integrate::StepOutcome::not_finite:
      what = "a number that is not finite appeared" + coordinate(report.step.worst);
      remedy =
          "look at the loads at that time, and whether the response grew before it (a smaller step, or an "
          "unconditionally stable method)";
      break;
    case integrate::StepOutcome::not_converged:
      what = fmt::format("the {} found no consistent state (worst: \"{}\")",
                         system.law_count() > 0    ? "laws"
                         : system.stop_count() > 0 ? "sliders and stops"
                                                   : "sliders",
                         contact_name(report.step.worst, system));
      remedy = "take a smaller step";
      break;
    case integrate::StepOutcome::singular:
      what = "the effective matrix of the step cannot be factorised";
      remedy = "look for a negative stiffness or damping, or take a smaller step";
      break;
    case integrate::StepOutcome::overdetermined:  // of mechanisms only
      break;
    case integrate::StepOutcome::too_small:
      what = "the error asked for a step below the smallest";
      remedy = plan.automatic ? advice_on_smallest(plan.automatic->plan, plan.duration) : "take a smaller step";
      break;
    case integrate::StepOutcome::crawls:
      what = "the run crawled: the last 2,000 steps were shorter than 1e-8 of the run";
      remedy =
          "look for a contact far stiffer than the rest (a smaller stiffness) and for contacts that change without end "
          "(a damper beside them, a slope in place of a jump), take a larger tolerance, a shorter run, or a fixed step";
      break;
    case integrate::StepOutcome::no_way_on:
    case integrate::StepOutcome::accepted:
      break;
  }
  return fmt::format("at t = {:.9g} s with the step {:.6g} s {}; {}", report.failed_at, report.failed_step, what,
                     remedy);
}

}  // namespace

RunReport run_transient(const std::string& name, const TransientPlan& plan, const system::LocallyNonlinear& system,
                        RunContext& context) {
  if (std::holds_alternative<integrate::Exact>(plan.method.formula))
    return run_exact_transient(name, plan, system, context);
  const auto stepper = integrate::make_stepper(plan.method, system);
  integrate::StructureBalance balance(system);
  integrate::EnergyLedger energy(integrate::energy_parts(system, balance));
  integrate::EnergyLedger* const ledger = plan.energy ? &energy : nullptr;
  TransientRecorder recorder(name, plan, results::columns_of_motion(system, plan.observed), balance, ledger,
                             context.sink);
  const long steps_a_report = system.size() > 1000 ? 1 : 256;
  TransientObserver observer(plan, recorder, ledger,
                             StepInterpolation(system, balance, integrate::find_method(plan.method.name).order),
                             steps_a_report, context);
  system::State state = integrate::consistent_start(system, plan.start);
  RunReport run;
  run.warnings = plan.warnings;
  integrate::MarchReport report;
  if (plan.automatic)
    context.progress.begin(name, plan.duration, "s of motion");
  else
    context.progress.begin(name, std::ceil(plan.duration / plan.step), "steps");
  if (!state.auxiliary_acceleration.allFinite()) {
    report.end = integrate::MarchEnd::failed;
    report.step.outcome = integrate::StepOutcome::not_finite;
    report.failed_step = plan.step;
    for (Index i = system.size() - 1; i >= 0; --i)
      if (!std::isfinite(state.auxiliary_acceleration[i])) report.step.worst = i;
  } else {
    observer.start(state);
    if (plan.automatic) {
      const auto estimator = integrate::make_estimator(plan.automatic->estimator, plan.method, system, *stepper,
                                                       plan.duration, plan.automatic->plan.bounds);
      StepRecorder tries(name, *plan.automatic, context.sink);
      const integrate::AdaptiveReport adaptive =
          integrate::march(*stepper, *estimator, plan.automatic->plan, system, state, plan.duration, &observer, &tries);
      report = adaptive.march;
      run.statistics = statistics(adaptive, state.t);
      if (const std::string warning = warning_of(adaptive, *plan.automatic); !warning.empty())
        run.warnings.push_back(warning);
    } else {
      integrate::LoadJumps jumps(system, state.t, plan.duration);
      report = integrate::march(*stepper, state, plan.step, plan.duration, &observer, &jumps);
      if (jumps.missed() > 0) run.warnings.push_back(missed_jumps(jumps));
      run.statistics = {{"steps", std::to_string(report.steps)},
                        {"factorisations", std::to_string(stepper->factorisations())}};
    }
    observer.finish(state);
  }
  context.progress.end();
  if (report.end == integrate::MarchEnd::failed) {
    run.status = RunStatus::failed;
    run.message = reason(report, plan, system);
  } else if (report.end == integrate::MarchEnd::stopped && state.t < plan.duration) {
    run.status = RunStatus::interrupted;
    run.message = fmt::format("interrupted at t = {:.6g} s of {} s", state.t, plan.duration);
  }
  run.statistics.emplace_back("rows", std::to_string(recorder.rows()));
  return run;
}

}  // namespace rubato::analysis
