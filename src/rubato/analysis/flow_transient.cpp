#include <rubato/analysis/events_table.hpp>
#include <rubato/analysis/flow_transient.hpp>
#include <rubato/analysis/transient_recorder.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/results/columns/kind_columns.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::analysis {
namespace {

using Kind = model::OutputDescription::Kind;

constexpr std::size_t samples_a_chunk = 4096;  // between reports of progress; memory does not grow with the duration

/// Records samples, and transitions where no times are asked for.
class FlowRecorder final : public integrate::ExactVisitor {
 public:
  FlowRecorder(const TransientPlan& plan, TransientRecorder& recorder, RunContext& context)
      : start_(plan.march.start),
        recorder_(recorder),
        context_(context),
        with_transitions_(plan.output == Kind::every_step) {}

  bool sample(const system::State& state, const integrate::ExactWork&) override {
    record(state);
    return !context_.stop.load(std::memory_order_relaxed);
  }
  bool transition(const system::State& state, const integrate::Transition&, const integrate::ExactWork&) override {
    if (with_transitions_ && state.t != last_) record(state);
    return !context_.stop.load(std::memory_order_relaxed);
  }

 private:
  void record(const system::State& state) {
    last_ = state.t;
    recorder_.record(start_, state);
  }

  const system::State& start_;
  TransientRecorder& recorder_;
  RunContext& context_;
  bool with_transitions_;
  double last_ = -1.0;
};

/// The times of rows, some at a time.
class RowTimes {
 public:
  RowTimes(const TransientPlan& plan, double interval)
      : plan_(plan), interval_(interval), round_off_(1e-12 * plan.march.duration) {}

  /// Sets the next of them. Returns whether these are the last.
  bool next(std::vector<double>& times) {
    const double duration = plan_.march.duration;
    times.clear();
    while (times.size() < samples_a_chunk && has_more()) times.push_back(take());
    const bool are_last = times.size() < samples_a_chunk;
    if (are_last && plan_.output == Kind::every_step && (times.empty() || times.back() < duration - round_off_))
      times.push_back(duration);
    return are_last;
  }

 private:
  bool has_more() const {
    if (plan_.output == Kind::times) return taken_ < plan_.times.size();
    return static_cast<double>(taken_) * interval_ <= plan_.march.duration + round_off_;
  }
  double take() {
    const std::size_t i = taken_++;
    if (plan_.output == Kind::times) return plan_.times[i];
    return std::min(static_cast<double>(i) * interval_, plan_.march.duration);
  }

  const TransientPlan& plan_;
  double interval_, round_off_;
  std::size_t taken_ = 0;
};

/// What becomes of a run by the end of a piece of it.
void conclude(const integrate::FlowReport& report, double t, double duration, RunReport& run) {
  if (report.end == integrate::ExactEnd::stopped && t < duration) {
    run.status = RunStatus::interrupted;
    run.message = fmt::format("interrupted at t = {} s of {} s", t, duration);
  } else if (report.end == integrate::ExactEnd::not_finite) {
    run.status = RunStatus::failed;
    run.message = fmt::format(
        "at t = {} s a number that is not finite appeared: the response grew beyond all bounds; look "
        "for a negative damping or stiffness",
        t);
  } else if (report.end == integrate::ExactEnd::chattering) {
    run.status = RunStatus::failed;
    run.message = fmt::format(
        "at t = {} s the slider \"{}\" changes between stick and slip without time passing; take a "
        "step method such as \"generalized_alpha\"",
        t, report.worst);
  }
}

}  // namespace

RunReport run_flow(const std::string& name, const TransientPlan& plan, integrate::FlowMarch& march,
                   RunContext& context) {
  const double duration = plan.march.duration;
  integrate::EnergyLedger energy(march.energy_parts());
  integrate::EnergyLedger* const ledger = plan.energy ? &energy : nullptr;
  TransientRecorder recorder(name, plan, results::columns_of_motion(march, plan.observed, plan.section_forces),
                             march.balance(), ledger, context.sink);
  if (ledger) ledger->start(plan.march.start);
  FlowRecorder visitor(plan, recorder, context);
  RowTimes rows(plan, plan.output == Kind::interval ? plan.interval : march.sample_interval());
  RunReport run;
  run.warnings = plan.march.warnings;
  long transitions = 0;
  std::vector<double> times;
  context.progress.begin(name, duration, "s of motion");
  while (march.state().t < duration) {
    const bool are_last = rows.next(times);
    integrate::FlowReport report;
    try {
      const StopScope scope(context.stop);
      report = march.go_to(are_last ? duration : times.back(), times, visitor, plan.energy);
    } catch (const Stopped&) {  // between two rows
      report.end = integrate::ExactEnd::stopped;
    }
    recorder.book(plan.march.start, plan.march.start);  // sums of work begin anew with each piece
    transitions += report.transitions;
    context.progress.advance(march.state().t);
    conclude(report, march.state().t, duration, run);
    if (run.status != RunStatus::done || report.end == integrate::ExactEnd::stopped) break;
  }
  context.progress.end();
  const integrate::Events events = march.events();
  write_events(name, events, context.sink);
  if (const std::string warning = warning_of(events); !warning.empty()) run.warnings.push_back(warning);
  run.statistics = {{"transitions", std::to_string(transitions)}, {"rows", std::to_string(recorder.rows())}};
  return run;
}

}  // namespace rubato::analysis
