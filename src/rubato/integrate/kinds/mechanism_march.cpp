#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_balance.hpp>
#include <rubato/integrate/constrained/constrained_space.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/kinds/mechanism_march.hpp>
#include <rubato/integrate/mechanism/law_events.hpp>
#include <rubato/integrate/mechanism/mechanism_energy.hpp>
#include <rubato/integrate/mechanism/mechanism_events.hpp>
#include <rubato/integrate/mechanism/mechanism_failure.hpp>
#include <rubato/integrate/mechanism/mechanism_law_energy.hpp>
#include <rubato/integrate/mechanism/mechanism_stop_energy.hpp>
#include <rubato/integrate/nearest_approach.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

namespace rubato::integrate {
namespace {

constexpr double resolution = 1e-12;  // of events, over the duration

/// How far the motion drifts from its constraints and how far it goes, at the ends of the steps.
class MotionWatch final : public Observer {
 public:
  MotionWatch(const system::State& start, system::MechanismEquations& equations)
      : equations_(equations),
        mechanism_(equations.mechanism()),
        from_(start.q),
        drift_(mechanism_.constraint_count()),
        way_(mechanism_.size()),
        momentum_(mechanism_.size()),
        locks_(mechanism_.model().locks.size()) {
    note_locks(start);
  }

  bool accepted(const system::State&, const system::State& after) override {
    note_drift(after);
    note_way(after);
    note_locks(after);
    return true;
  }

  /// Largest rate of the constraints [m/s], [rad/s].
  double largest_drift() const { return largest_drift_; }
  /// The longest way from where the run starts, in the mass norm [m sqrt(kg)].
  double largest_way() const { return largest_way_; }
  /// Locks that no step ended at.
  std::vector<std::string> never_reached() const {
    std::vector<std::string> told;
    for (std::size_t i = 0; i < locks_.size(); ++i) {
      const model::Lock& lock = mechanism_.model().locks[i];
      const std::string what = fmt::format("the {}\"{}\"",
                                           lock.is_stop_part ? "stop "
                                           : lock.is_latch   ? "latch of "
                                                             : "stop of ",
                                           lock.name);
      if (std::string line = locks_[i].told(what, lock.s.is_angle()); !line.empty()) told.push_back(std::move(line));
    }
    return told;
  }

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

  void note_locks(const system::State& state) {
    for (std::size_t i = 0; i < locks_.size(); ++i) {
      const model::Lock& lock = mechanism_.model().locks[i];
      if (state.phase[i] != model::lock_open) locks_[i].reach();
      locks_[i].note(state.t, lock.sign * (lock.at - lock.s.value(state.q.data())));
    }
  }

  system::MechanismEquations& equations_;
  const system::Mechanism& mechanism_;
  Vector from_, drift_, way_, momentum_;
  std::vector<NearestApproach> locks_;
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

bool has_equal_steps(const MarchPlan& plan) {
  return std::holds_alternative<FixedStep>(plan.automatic->plan.controller);
}

NewtonPlan newton_of(const MarchPlan& plan) {
  const bool is_per_time = !std::holds_alternative<InertiaJump>(plan.automatic->estimator);
  NewtonPlan newton;
  newton.projects_velocities = plan.project_velocities || (is_per_time && !has_equal_steps(plan)) ||
                               std::holds_alternative<PiControl>(plan.automatic->plan.controller);
  newton.avoids_singular_ends = !has_equal_steps(plan);
  return newton;
}

class MechanismMarch final : public StepMarch {
 public:
  MechanismMarch(const MarchPlan& plan, const system::Mechanism& mechanism)
      : plan_(plan),
        mechanism_(mechanism),
        equations_(mechanism),
        stepper_(integrate::make_stepper(plan.method, equations_, newton_of(plan), plan.allow_unstable)),
        estimator_(make_mechanism_estimator(plan, *plan.automatic, equations_)),
        timeline_(equations_, resolution * plan.duration, plan.automatic->plan.locate_sliders, !has_equal_steps(plan)),
        balance_(equations_),
        watch_(plan.start, equations_),
        law_events_(equations_, plan.start, timeline_.law_guards(), timeline_.contact_guards()),
        listeners_(watch_, law_events_),
        state_(plan.start) {
    if (!has_equal_steps(plan)) return;  // with steps that change it is carried over by the march
    shift_acceleration(equations_, state_, stepper_->shift() * plan.automatic->plan.first);
  }

  const system::State& state() const override { return state_; }
  Balance& balance() override { return balance_; }
  std::vector<std::unique_ptr<EnergyPart>> energy_parts() override {
    std::vector<std::unique_ptr<EnergyPart>> parts;
    parts.push_back(std::make_unique<MechanismEnergy>(balance_, equations_, timeline_));
    auto of_stops = std::make_unique<MechanismStopEnergy>(mechanism_);
    if (of_stops->has_stops()) parts.push_back(std::move(of_stops));
    auto of_laws = std::make_unique<MechanismLawEnergy>(equations_);
    if (of_laws->has_laws()) parts.push_back(std::move(of_laws));
    return parts;
  }
  void show(MarchVisitor& visitor) override { visitor.mechanism(equations_); }
  std::vector<double> kinks() const override { return timeline_.breakpoints(plan_.start.t, plan_.duration); }
  Observer* listener() override { return &listeners_; }
  long steps_a_report() const override { return 64; }

  AdaptiveReport go_to(double end, Observer* observer, TryLog* log) override {
    return integrate::march(*stepper_, *estimator_, plan_.automatic->plan, timeline_, state_, end, observer, log);
  }

  MarchFailure failure(const MarchReport& report) override {
    return integrate::failure_of(report, equations_, state_, {timeline_.chattering(), timeline_.events()});
  }

  Events events() const override {
    Events events = integrate::events_of(timeline_.events(), mechanism_, &plan_.start);
    law_events_.add_to(events);
    return events;
  }

  /// The work of the forces at the start along what Newton's method may leave of a step.
  double energy_round_off() override {
    constexpr double left = 1e-10;  // of the mechanism's size
    Vector force(mechanism_.size()), constraint(mechanism_.constraint_count());
    equations_.begin_step(plan_.start);
    equations_.go_to_end(plan_.start, model::Side::right);
    equations_.residual(force, constraint);
    double squared = 0.0;
    for (Index i = 0; i < force.size(); ++i)
      if (const double mass = mechanism_.mass().coeff(i, i); mass > 0.0) squared += force[i] * force[i] / mass;
    return left * integrate::extent(mechanism_) * std::sqrt(squared);
  }

  MarchNotes notes(const AdaptiveReport& report) const override {
    MarchNotes notes;
    notes.statistics.emplace_back("velocity_drift", fmt::format("{:.3g}", watch_.largest_drift()));
    const std::string small =
        warning_of_small_motion(watch_.largest_way(), estimator_->size(), *plan_.automatic, mechanism_);
    if (!small.empty()) notes.warnings.push_back(small);
    notes.findings = watch_.never_reached();
    if (has_equal_steps(plan_) && report.failed > 0 && report.march.end != MarchEnd::failed)
      notes.warnings.push_back(fmt::format(
          "Newton's method failed in {} of the equal steps, and was given shorter ones from there to the next "
          "event, the shortest of {:.3g} s: {} steps instead of {:.0f}; take a shorter step, or step = {{ "
          "tolerance = 1e-4 }}",
          report.failed, report.smallest_step, report.march.steps, plan_.automatic->expected_steps));
    // The share of the run that the tolerance is; of equal steps, which are judged by nothing, a tenth of a step.
    notes.known =
        has_equal_steps(plan_) ? 0.1 * plan_.automatic->plan.first : plan_.automatic->tolerance * plan_.duration;
    return notes;
  }

 private:
  const MarchPlan& plan_;
  const system::Mechanism& mechanism_;
  system::MechanismEquations equations_;  // of all that follows
  std::unique_ptr<Stepper> stepper_;
  std::unique_ptr<Estimator> estimator_;
  MechanismTimeline timeline_;
  ConstrainedBalance balance_;
  MotionWatch watch_;
  MechanismLawEvents law_events_;
  struct Listeners final : Observer {
    MotionWatch& watch;
    MechanismLawEvents& law_events;

    Listeners(MotionWatch& watch_, MechanismLawEvents& law_events_) : watch(watch_), law_events(law_events_) {}
    bool accepted(const system::State& before, const system::State& after) override {
      return watch.accepted(before, after) && law_events.accepted(before, after);
    }
  } listeners_;
  system::State state_;
};

}  // namespace

std::unique_ptr<Estimator> make_mechanism_estimator(const MarchPlan& plan, const AutomaticStep& step,
                                                    system::MechanismEquations& equations) {
  return make_estimator(step.estimator, std::get<GeneralizedAlpha>(plan.method.formula),
                        make_error_space(equations, plan.start, step.tolerance), plan.start, plan.duration);
}

std::unique_ptr<StepMarch> make_mechanism_march(const MarchPlan& plan, const system::Mechanism& mechanism) {
  return std::make_unique<MechanismMarch>(plan, mechanism);
}

}  // namespace rubato::integrate
