#include <rubato/analysis/mechanism_march.hpp>
#include <rubato/analysis/mechanism_recorder.hpp>
#include <rubato/analysis/mechanism_transient.hpp>
#include <rubato/analysis/transient_observer.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/mechanism/mechanism_space.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {
namespace {

class MechanismBooks final : public TransientBooks {
 public:
  MechanismBooks(const TransientPlan& plan, integrate::MechanismBalance& balance, MechanismRecorder& recorder,
                 const integrate::MechanismTimeline& timeline)
      : keeps_energy_(plan.energy),
        mechanism_(balance.equations().mechanism()),
        recorder_(recorder),
        timeline_(timeline),
        ledger_(balance),
        equations_(balance.equations()),
        drift_(mechanism_.constraint_count()),
        way_(mechanism_.size()),
        momentum_(mechanism_.size()) {}

  void start(const system::State& state) override {
    ledger_.start(state);
    from_ = state.q;
  }

  void book(const system::State& before, const system::State& after) override {
    if (keeps_energy_) ledger_.add_step(before, after, timeline_.impulsive_work());
    note_drift(after);
    note_way(after);
  }

  void record(const system::State& before, const system::State& now, bool is_balanced) override {
    if (!keeps_energy_) return recorder_.record(now, nullptr, is_balanced);
    const MechanismEnergy energy = ledger_.at(before, now, timeline_.impulsive_work());
    recorder_.record(now, &energy, is_balanced);
  }

  /// Largest rate of the constraints at the ends of the steps [m/s], [rad/s].
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

  bool keeps_energy_;
  const system::Mechanism& mechanism_;
  MechanismRecorder& recorder_;
  const integrate::MechanismTimeline& timeline_;
  MechanismLedger ledger_;
  system::MechanismEquations& equations_;
  Vector drift_;
  double largest_drift_ = 0.0;
  Vector from_, way_, momentum_;
  double largest_way_ = 0.0;
};

/// What the impact of a rigid lock took, or the spring of a damped stop still held as it let go.
std::string energy_told(const integrate::LockEvent& event) {
  if (!(event.energy_lost > 0.0)) return {};
  if (event.has_engaged) return fmt::format(", taking {:.4g} J", event.energy_lost);
  return fmt::format(", with {:.4g} J still in its spring, which its damper takes", event.energy_lost);
}

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

/// The locks on which a run starts at rest, as if they had engaged then.
std::vector<integrate::LockEvent> locks_at_start(const system::State& start) {
  std::vector<integrate::LockEvent> events;
  for (std::size_t i = 0; i < start.phase.size(); ++i)
    if (start.phase[i] != model::lock_open) events.push_back({start.t, static_cast<int>(i)});
  return events;
}

/// A time to one digit more than is known of it. What happens soon has three digits at least.
std::string told_time(double t, double known) {
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(known))), 0, 12);
  if (std::abs(t) < 100.0 * std::pow(10.0, -decimals)) return fmt::format("{:.3g}", t);
  std::string text = fmt::format("{:.{}f}", t, decimals);
  if (decimals > 0) text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

/// Locks one by one; friction, which may stick and slip often, by its first changes and their number.
/// @param known  of their times [s]
void report_events(const std::vector<integrate::LockEvent>& events, const system::Mechanism& mechanism, double known,
                   std::vector<std::string>& findings) {
  constexpr long most_told = 6;
  std::vector<long> changes(mechanism.model().frictions.size(), 0);
  for (const auto& event : events) {
    if (event.friction < 0) {
      findings.push_back(
          fmt::format("\"{}\" {} at t = {} s{}", mechanism.model().locks[static_cast<std::size_t>(event.lock)].name,
                      event.has_engaged ? "locks" : "lets go", told_time(event.t, known), energy_told(event)));
    } else if (++changes[static_cast<std::size_t>(event.friction)] <= most_told) {
      findings.push_back(fmt::format("\"{}\" {} at t = {} s",
                                     mechanism.model().frictions[static_cast<std::size_t>(event.friction)].label(),
                                     event.has_engaged ? "sticks" : "slips", told_time(event.t, known)));
    }
  }
  for (std::size_t i = 0; i < changes.size(); ++i)
    if (changes[i] > most_told)
      findings.push_back(
          fmt::format("\"{}\" sticks and slips {} times in all", mechanism.model().frictions[i].label(), changes[i]));
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
  MechanismRecorder recorder(name, plan, balance, context.sink);
  MechanismBooks books(transient, balance, recorder, march.timeline());
  constexpr long steps_a_report = 64;
  TransientObserver observer(transient, books,
                             StepInterpolation(mechanism, balance, integrate::find_method(transient.method.name).order,
                                               march.timeline().breakpoints(transient.start.t, transient.duration)),
                             steps_a_report, context);
  context.progress.begin(name, transient.duration, "s of motion");
  observer.start(march.state());
  std::unique_ptr<StepRecorder> tries;
  if (!march.has_equal_steps()) tries = std::make_unique<StepRecorder>(name, *transient.automatic, context.sink);
  const integrate::AdaptiveReport report = march.go_to(transient.duration, &observer, tries.get());
  const system::State& state = march.state();
  observer.finish(state);
  context.progress.end();
  std::vector<integrate::LockEvent> events = locks_at_start(transient.start);
  events.insert(events.end(), march.timeline().events().begin(), march.timeline().events().end());
  write_events(name, events, mechanism, context.sink);
  RunReport run;
  run.statistics = statistics(report, state.t);
  run.statistics.emplace_back("rows", std::to_string(recorder.rows()));
  run.statistics.emplace_back("velocity_drift", fmt::format("{:.3g}", books.largest_drift()));
  run.warnings = plan.warnings;
  if (const std::string warning = warning_of(report, *transient.automatic); !warning.empty())
    run.warnings.push_back(warning);
  if (const std::string warning =
          warning_of_small_motion(books.largest_way(), march.error_size(), *transient.automatic, mechanism);
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
