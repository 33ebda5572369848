#include <rubato/analysis/events_table.hpp>
#include <rubato/analysis/exact_transient.hpp>
#include <rubato/analysis/transient_recorder.hpp>
#include <rubato/core/stopping.hpp>
#include <rubato/integrate/contact_events.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/integrate/structure_balance.hpp>
#include <rubato/integrate/structure_energy.hpp>
#include <rubato/results/columns/structure_columns.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::analysis {
namespace {

using Kind = model::OutputDescription::Kind;

constexpr int samples_a_period = 64;
constexpr std::size_t samples_a_chunk = 4096;  // between reports of progress; memory does not grow with the duration

/// The energy of a structure with the works that the flow itself finds, of which steps know nothing.
class ExactEnergy final : public integrate::EnergyPart {
 public:
  explicit ExactEnergy(const system::LocallyNonlinear& system) : structure_(system) {}

  /// What is done since the last step that was booked.
  void set(const integrate::ExactWork& work) { work_ = work; }

  std::vector<integrate::Account> accounts() const override { return structure_.accounts(); }
  void add_stored(const system::State& state, integrate::Entries row) override { structure_.add_stored(state, row); }
  void add_flow(const system::State&, const system::State&, integrate::Entries row) override {
    row[integrate::StructureEnergy::damper_dissipated] += work_.damper;
    row[integrate::StructureEnergy::slider_dissipated] += work_.slider;
    row[integrate::StructureEnergy::load_work] += work_.load;
  }

 private:
  integrate::StructureEnergy structure_;
  integrate::ExactWork work_;
};

/// Records samples, and transitions where no times are asked for.
class ExactRecorder final : public integrate::ExactVisitor {
 public:
  ExactRecorder(const TransientPlan& plan, TransientRecorder& recorder, ExactEnergy& energy,
                integrate::EnergyLedger& ledger, const system::LocallyNonlinear& system, RunContext& context)
      : start_(plan.start),
        contacts_(system, plan.start),
        recorder_(recorder),
        energy_(energy),
        ledger_(ledger),
        context_(context),
        with_transitions_(plan.output == Kind::every_step) {
    ledger.start(start_);
  }

  bool sample(const system::State& state, const integrate::ExactWork& work) override {
    record(state, work);
    return !context_.stop.load(std::memory_order_relaxed);
  }
  bool transition(const system::State& state, const integrate::Transition& transition,
                  const integrate::ExactWork& work) override {
    contacts_.note_slider(transition.t, transition.slider, transition.state == integrate::SliderState::stick);
    if (with_transitions_ && state.t != last_) record(state, work);
    return !context_.stop.load(std::memory_order_relaxed);
  }
  /// Sums of work begin anew with each advance: books those of the last row.
  void keep() { ledger_.add_step(start_, start_); }
  const integrate::Events& events() const { return contacts_.events(); }

 private:
  void record(const system::State& state, const integrate::ExactWork& work) {
    last_ = state.t;
    energy_.set(work);
    recorder_.record(start_, state);
  }

  const system::State& start_;
  integrate::ContactEvents contacts_;
  TransientRecorder& recorder_;
  ExactEnergy& energy_;
  integrate::EnergyLedger& ledger_;
  RunContext& context_;
  bool with_transitions_;
  double last_ = -1.0;
};

// 64 a period of the fastest harmonic load; of the fastest mode where there is none.
double default_interval(const system::LocallyNonlinear& system) {
  double omega = 0.0;
  for (const auto& term : system.loads().terms())
    if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&term.law))
      omega = std::max(omega, harmonic->angular_frequency);
  if (omega == 0.0) {
    integrate::TaylorPiece piece(system);
    const std::vector<integrate::SliderState> stuck(static_cast<std::size_t>(system.slider_count()),
                                                    integrate::SliderState::stick);
    piece.start(system.start(), stuck, 0.0);
    omega = integrate::TaylorPiece::reach / piece.max_length();
  }
  return 2.0 * std::numbers::pi / omega / samples_a_period;
}

}  // namespace

RunReport run_exact_transient(const std::string& name, const TransientPlan& plan,
                              const system::LocallyNonlinear& system, RunContext& context) {
  integrate::ExactFlow flow(system);
  integrate::StructureBalance balance(system);
  std::vector<std::unique_ptr<integrate::EnergyPart>> parts;
  parts.push_back(std::make_unique<ExactEnergy>(system));
  auto& energy = static_cast<ExactEnergy&>(*parts.front());
  integrate::EnergyLedger ledger(std::move(parts));
  TransientRecorder recorder(name, plan, results::columns_of_motion(system, plan.observed), balance,
                             plan.energy ? &ledger : nullptr, context.sink);
  ExactRecorder visitor(plan, recorder, energy, ledger, system, context);
  const double interval = plan.output == Kind::interval ? plan.interval : default_interval(system);
  const double round_off = 1e-12 * plan.duration;
  system::State state = plan.start;
  RunReport run;
  long transitions = 0;
  std::size_t next = 0;
  std::vector<double> times;
  context.progress.begin(name, plan.duration, "s of motion");
  while (state.t < plan.duration) {
    times.clear();
    while (times.size() < samples_a_chunk) {
      if (plan.output == Kind::times) {
        if (next == plan.times.size()) break;
        times.push_back(plan.times[next++]);
      } else {
        const double t = static_cast<double>(next) * interval;
        if (t > plan.duration + round_off) break;
        times.push_back(std::min(t, plan.duration));
        ++next;
      }
    }
    const bool is_last = times.size() < samples_a_chunk;
    if (is_last && plan.output == Kind::every_step && (times.empty() || times.back() < plan.duration - round_off))
      times.push_back(plan.duration);
    const double end = is_last ? plan.duration : times.back();
    integrate::ExactReport report;
    try {
      const StopScope scope(context.stop);
      report = flow.advance(state, end, times, visitor, plan.energy);
    } catch (const Stopped&) {  // between two rows
      report.end = integrate::ExactEnd::stopped;
    }
    visitor.keep();
    transitions += report.transitions;
    context.progress.advance(state.t);
    if (report.end == integrate::ExactEnd::stopped && state.t < plan.duration) {
      run.status = RunStatus::interrupted;
      run.message = fmt::format("interrupted at t = {} s of {} s", state.t, plan.duration);
    } else if (report.end == integrate::ExactEnd::not_finite) {
      run.status = RunStatus::failed;
      run.message = fmt::format(
          "at t = {} s a number that is not finite appeared: the response grew beyond all bounds; look "
          "for a negative damping or stiffness",
          state.t);
    } else if (report.end == integrate::ExactEnd::chattering) {
      run.status = RunStatus::failed;
      run.message = fmt::format(
          "at t = {} s the slider \"{}\" changes between stick and slip without time passing; take a "
          "step method such as \"generalized_alpha\"",
          state.t, system.sliders()[static_cast<std::size_t>(report.worst)].name);
    }
    if (run.status != RunStatus::done || report.end == integrate::ExactEnd::stopped) break;
  }
  context.progress.end();
  write_events(name, visitor.events(), context.sink);
  if (const std::string warning = warning_of(visitor.events()); !warning.empty()) run.warnings.push_back(warning);
  run.statistics = {{"transitions", std::to_string(transitions)}, {"rows", std::to_string(recorder.rows())}};
  return run;
}

}  // namespace rubato::analysis
