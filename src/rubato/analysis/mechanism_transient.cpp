#include <rubato/analysis/mechanism_events.hpp>
#include <rubato/analysis/mechanism_march.hpp>
#include <rubato/analysis/mechanism_transient.hpp>
#include <rubato/analysis/transient_observer.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/mechanism/mechanism_energy.hpp>
#include <rubato/integrate/mechanism/mechanism_space.hpp>
#include <rubato/results/columns/mechanism_columns.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {
namespace {

/// How far the motion drifts from its constraints and how far it goes, at the ends of the steps.
class MotionWatch final : public integrate::Observer {
 public:
  MotionWatch(const system::State& start, system::MechanismEquations& equations)
      : equations_(equations),
        mechanism_(equations.mechanism()),
        from_(start.q),
        drift_(mechanism_.constraint_count()),
        way_(mechanism_.size()),
        momentum_(mechanism_.size()) {}

  bool accepted(const system::State&, const system::State& after) override {
    note_drift(after);
    note_way(after);
    return true;
  }

  /// Largest rate of the constraints [m/s], [rad/s].
  double largest_drift() const { return largest_drift_; }
  /// The longest way from where the run starts, in the mass norm [m sqrt(kg)].
  double largest_way() const { return largest_way_; }

 private:
  void note_drift(const system::State& state) {
    if (drift_.size() == 0) return;
    equations_.go_to(state, model::Side::left);
    equations_.constraints(drift_);
    equations_.constraint_rate(state.v, drift_);
    largest_drift_ = std::max(largest_drift_, drift_.cwiseAbs().maxCoeff());
  }

  void note_way(const system::State& state) {
    mechanism_.difference(from_, state.q, way_);
    mechanism_.times_mass(way_, momentum_);
    largest_way_ = std::max(largest_way_, std::sqrt(way_.dot(momentum_)));
  }

  system::MechanismEquations& equations_;
  const system::Mechanism& mechanism_;
  Vector from_, drift_, way_, momentum_;
  double largest_drift_ = 0.0, largest_way_ = 0.0;
};

/// What to tell of a motion so small beside the size by which its errors are measured that they may be more than ten
/// tolerances and two thousandths of what moves; empty: nothing.
/// @param way, size  [m sqrt(kg)]
std::string warning_of_small_motion(double way, double size, const AutomaticStep& step,
                                    const system::Mechanism& mechanism) {
  constexpr double small = 0.03;  // errors are a third of the tolerance, mostly
  constexpr double advised = 1e-3, told = 2e-3;
  constexpr int enough = 60;  // the logarithm of what is left is halved by each
  // What Newton's method leaves of a mechanism that stands is no motion.
  constexpr double stands = 1e-9;
  const double error = step.tolerance * size / way;
  if (!step.asks_for_tolerance || way <= stands * size || way >= small * size || error < told) return {};
  const double share = std::min(advised, step.tolerance);
  double tolerance = step.tolerance;
  for (int i = 0; i < enough; ++i) tolerance = share * way / std::max(way, integrate::least_size(mechanism, tolerance));
  return fmt::format(
      "the motion is small beside the mechanism: it goes {:.3g} m sqrt(kg) at most, and the tolerance {} is a share of "
      "{:.3g}, so that errors may be {:.2g} of what moves; for {:.1g} of it take tolerance = {:.1g}",
      way, step.tolerance, size, error, share, tolerance);
}

}  // namespace

RunReport run_mechanism(const std::string& name, const MechanismPlan& plan, const system::Mechanism& mechanism,
                        RunContext& context) {
  const TransientPlan& transient = plan.transient;
  if (!plan.failure.empty()) {
    RunReport failed;
    failed.status = RunStatus::failed;
    failed.message = plan.failure;
    failed.warnings = plan.warnings;
    return failed;
  }
  MechanismMarch march(plan, mechanism);
  integrate::MechanismBalance balance(mechanism);
  std::vector<std::unique_ptr<integrate::EnergyPart>> parts;
  parts.push_back(std::make_unique<integrate::MechanismEnergy>(balance, march.timeline()));
  integrate::EnergyLedger energy(std::move(parts));
  integrate::EnergyLedger* const ledger = transient.energy ? &energy : nullptr;
  TransientRecorder recorder(name, transient,
                             results::columns_of_motion(balance.equations(), transient.observed, plan.section_forces),
                             balance, ledger, context.sink);
  MotionWatch watch(transient.start, balance.equations());
  constexpr long steps_a_report = 64;
  TransientObserver observer(transient, recorder, ledger,
                             StepInterpolation(mechanism, balance, integrate::find_method(transient.method.name).order,
                                               march.timeline().breakpoints(transient.start.t, transient.duration)),
                             steps_a_report, context, &watch);
  context.progress.begin(name, transient.duration, "s of motion");
  observer.start(march.state());
  std::unique_ptr<StepRecorder> tries;
  if (!march.has_equal_steps()) tries = std::make_unique<StepRecorder>(name, *transient.automatic, context.sink);
  const integrate::AdaptiveReport report = march.go_to(transient.duration, &observer, tries.get());
  const system::State& state = march.state();
  observer.finish(state);
  context.progress.end();
  write_events(name, transient.start, march.timeline().events(), mechanism, context.sink);
  RunReport run;
  run.statistics = statistics(report, state.t);
  run.statistics.emplace_back("rows", std::to_string(recorder.rows()));
  run.statistics.emplace_back("velocity_drift", fmt::format("{:.3g}", watch.largest_drift()));
  run.warnings = plan.warnings;
  if (const std::string warning = warning_of(report, *transient.automatic); !warning.empty())
    run.warnings.push_back(warning);
  if (const std::string warning =
          warning_of_small_motion(watch.largest_way(), march.error_size(), *transient.automatic, mechanism);
      !warning.empty())
    run.warnings.push_back(warning);
  if (march.has_equal_steps() && report.failed > 0 && report.march.end != integrate::MarchEnd::failed)
    run.warnings.push_back(fmt::format(
        "Newton's method failed in {} of the equal steps, and was given shorter ones from there to the next "
        "event, the shortest of {:.3g} s: {} steps instead of {:.0f}; take a shorter step, or step = {{ "
        "tolerance = 1e-4 }}",
        report.failed, report.smallest_step, report.march.steps, transient.automatic->expected_steps));
  // The share of the run that the tolerance is; of equal steps, which are judged by nothing, a tenth of a step.
  const double known = march.has_equal_steps() ? 0.1 * transient.automatic->plan.first
                                               : transient.automatic->tolerance * transient.duration;
  report_events(march.timeline().events(), mechanism, known, run.findings);
  if (report.march.end == integrate::MarchEnd::failed) {
    run.status = RunStatus::failed;
    run.message = march.failure(report);
  } else if (report.march.end == integrate::MarchEnd::stopped && state.t < transient.duration) {
    run.status = RunStatus::interrupted;
    run.message = fmt::format("interrupted at t = {} s of {} s", state.t, transient.duration);
  }
  return run;
}

}  // namespace rubato::analysis
