#include <rubato/analysis/equilibrium_text.hpp>
#include <rubato/analysis/events_table.hpp>
#include <rubato/analysis/load_checks.hpp>
#include <rubato/analysis/mechanism_transient.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_balance.hpp>
#include <rubato/integrate/constrained/constrained_space.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/kinds/mechanism_kind.hpp>
#include <rubato/integrate/kinds/mechanism_start_state.hpp>
#include <rubato/integrate/mechanism/mechanism_energy.hpp>
#include <rubato/integrate/mechanism/mechanism_events.hpp>
#include <rubato/integrate/mechanism/mechanism_failure.hpp>
#include <rubato/integrate/mechanism/mechanism_law_energy.hpp>
#include <rubato/results/columns/beam_section_forces.hpp>
#include <rubato/results/columns/mechanism_columns.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

namespace rubato::analysis {
namespace {

constexpr double resolution = 1e-12;  // of events, over the duration

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

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

bool has_equal_steps(const TransientPlan& plan) {
  return std::holds_alternative<integrate::FixedStep>(plan.automatic->plan.controller);
}

std::unique_ptr<integrate::Estimator> estimator_of(const TransientPlan& plan, const AutomaticStep& step,
                                                   const system::Mechanism& mechanism) {
  return integrate::make_estimator(step.estimator, std::get<integrate::GeneralizedAlpha>(plan.method.formula),
                                   integrate::make_error_space(mechanism, plan.start, step.tolerance), plan.start,
                                   plan.duration);
}

integrate::NewtonPlan newton_of(const TransientPlan& plan) {
  const bool is_per_time = !std::holds_alternative<integrate::InertiaJump>(plan.automatic->estimator);
  integrate::NewtonPlan newton;
  newton.projects_velocities = plan.project_velocities || (is_per_time && !has_equal_steps(plan)) ||
                               std::holds_alternative<integrate::PiControl>(plan.automatic->plan.controller);
  newton.avoids_singular_ends = !has_equal_steps(plan);
  return newton;
}

class MechanismMarch final : public TransientMarch {
 public:
  MechanismMarch(const TransientPlan& plan, const system::Mechanism& mechanism)
      : plan_(plan),
        mechanism_(mechanism),
        stepper_(integrate::make_stepper(plan.method, mechanism, newton_of(plan), plan.allow_unstable)),
        estimator_(estimator_of(plan, *plan.automatic, mechanism)),
        timeline_(mechanism, resolution * plan.duration),
        equations_(mechanism),
        balance_(equations_),
        watch_(plan.start, equations_),
        state_(plan.start) {
    if (!has_equal_steps(plan)) return;  // with steps that change it is carried over by the march
    integrate::shift_acceleration(equations_, state_, stepper_->shift() * plan.automatic->plan.first);
  }

  const system::State& state() const override { return state_; }
  integrate::Balance& balance() override { return balance_; }
  std::vector<std::unique_ptr<integrate::EnergyPart>> energy_parts() override {
    std::vector<std::unique_ptr<integrate::EnergyPart>> parts;
    parts.push_back(std::make_unique<integrate::MechanismEnergy>(balance_, equations_, timeline_));
    if (!mechanism_.model().laws.empty()) parts.push_back(std::make_unique<integrate::MechanismLawEnergy>(equations_));
    return parts;
  }
  results::ColumnGroups columns() override {
    return results::columns_of_motion(equations_, plan_.observed, plan_.section_forces);
  }
  std::vector<double> kinks() const override { return timeline_.breakpoints(plan_.start.t, plan_.duration); }
  integrate::Observer* listener() override { return &watch_; }
  long steps_a_report() const override { return 64; }

  integrate::AdaptiveReport go_to(double end, integrate::Observer* observer, integrate::TryLog* log) override {
    return integrate::march(*stepper_, *estimator_, plan_.automatic->plan, timeline_, state_, end, observer, log);
  }

  integrate::MarchFailure failure(const integrate::MarchReport& report) override {
    return integrate::failure_of(report, equations_, state_, {timeline_.chattering(), timeline_.events()});
  }

  integrate::Events events() const override {
    return integrate::events_of(timeline_.events(), mechanism_, &plan_.start);
  }

  void conclude(const integrate::AdaptiveReport& report, RunReport& run) const override {
    run.statistics.emplace_back("velocity_drift", fmt::format("{:.3g}", watch_.largest_drift()));
    const std::string small =
        warning_of_small_motion(watch_.largest_way(), estimator_->size(), *plan_.automatic, mechanism_);
    if (!small.empty()) run.warnings.push_back(small);
    if (has_equal_steps(plan_) && report.failed > 0 && report.march.end != integrate::MarchEnd::failed)
      run.warnings.push_back(fmt::format(
          "Newton's method failed in {} of the equal steps, and was given shorter ones from there to the next "
          "event, the shortest of {:.3g} s: {} steps instead of {:.0f}; take a shorter step, or step = {{ "
          "tolerance = 1e-4 }}",
          report.failed, report.smallest_step, report.march.steps, plan_.automatic->expected_steps));
    // The share of the run that the tolerance is; of equal steps, which are judged by nothing, a tenth of a step.
    const double known =
        has_equal_steps(plan_) ? 0.1 * plan_.automatic->plan.first : plan_.automatic->tolerance * plan_.duration;
    report_events(events(), known, run.findings);
  }

 private:
  const TransientPlan& plan_;
  const system::Mechanism& mechanism_;
  std::unique_ptr<integrate::Stepper> stepper_;
  std::unique_ptr<integrate::Estimator> estimator_;
  integrate::MechanismTimeline timeline_;
  system::MechanismEquations equations_;
  integrate::ConstrainedBalance balance_;
  MotionWatch watch_;
  system::State state_;
};

}  // namespace

void MechanismTransient::check(const TransientRequest& request, const TransientPlan& plan) const {
  (void)results::BeamSectionForces(mechanism_, request.description.section_forces, request.title());
  try {
    integrate::NewtonPlan newton;
    newton.projects_velocities = plan.project_velocities;
    (void)integrate::make_stepper(plan.method, mechanism_, newton, plan.allow_unstable);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(place(request.description.method.where, request.where), request.title() + fault.message());
  }
}

void MechanismTransient::find_start(const TransientRequest& request, TransientPlan& plan) const {
  const auto& initial = request.description.initial;
  plan.start = integrate::assembled_start(request.where, mechanism_, plan.warnings, !initial);
  if (initial) {
    const std::string title = request.title();
    const integrate::MechanismKind kind(mechanism_);
    const auto held = kind.held_displacements({title, request.where, *initial});
    const integrate::Equilibrium found = kind.find_equilibrium(plan.start, held);
    plan.failure = complaint(found);
    if (plan.failure.empty()) {
      if (!found.is_stable)
        plan.warnings.push_back(
            "the equilibrium at the start is not stable: what moves from there begins with round-off");
      plan.start = integrate::set_in_motion(request.where, mechanism_, found.state, plan.warnings);
    } else {
      plan.failure = "it has no static start: " + plan.failure;
    }
  }
  if (plan.failure.empty()) integrate::settle_start(request.where, mechanism_, plan.duration, plan.start);
  integrate::warn_of_locks_behind(mechanism_, plan.start, plan.warnings);
}

void MechanismTransient::take_equal_steps(const TransientRequest& /*request*/, TransientPlan& plan) const {
  AutomaticStep step;
  step.asks_for_tolerance = false;
  step.plan.controller = integrate::FixedStep{};
  step.plan.first = step.plan.largest = plan.step;
  step.plan.smallest = 1e-12 * plan.duration;
  step.plan.locate_events = true;
  step.estimator = integrate::LocalError{step.tolerance};
  step.expected_steps = std::ceil(plan.duration / plan.step * (1.0 - 1e-12));
  plan.automatic = step;
}

void MechanismTransient::plan_events(const std::string& title, const model::StepDescription& description,
                                     const TransientPlan& /*plan*/, integrate::StepPlan& step) const {
  if (description.locate_events && !*description.locate_events)
    throw InvalidInput(description.where,
                       title +
                           "events = \"pass\" is for structures: a lock or a joint that sticks changes what the step "
                           "solves, so that steps of mechanisms always end there; remove it");
  if (description.reference_is_initial)
    throw InvalidInput(description.where, title +
                                              "reference = \"initial\" measures displacements, and configurations "
                                              "of mechanisms have none; give a number, or leave it out");
  step.locate_events = true;
}

void MechanismTransient::try_estimator(const TransientPlan& plan, const AutomaticStep& step) const {
  (void)estimator_of(plan, step, mechanism_);
}

void MechanismTransient::check_loads(const TransientRequest& request, const TransientPlan& plan) const {
  const auto check = [&](const auto& law, const char* remedies) {
    const auto* table = std::get_if<model::TableLaw>(&law);
    if (table && table->beyond == model::TableLaw::Beyond::error)
      require_rows_to_reach(table->times, table->source, plan.duration, remedies, request.where);
  };
  const model::Mechanism& model = mechanism_.model();
  constexpr const char* of_force = "\"zero\" or \"hold\"";
  for (const auto& force : model.forces) check(force.law, of_force);
  for (const auto& law : model.following_laws) check(law, of_force);
  for (const auto& drive : model.drives) check(drive.law, "\"hold\"");
  for (const auto& drive : model.drives)
    if (const auto* formula = std::get_if<numerics::Formula>(&drive.law))
      refuse_jump(fmt::format("joint \"{}\": the drive", drive.name), *formula, plan.duration, request.where);
}

std::unique_ptr<TransientMarch> MechanismTransient::march(const TransientPlan& plan) const {
  return std::make_unique<MechanismMarch>(plan, mechanism_);
}

}  // namespace rubato::analysis
