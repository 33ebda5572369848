#include <rubato/analysis/equilibrium_text.hpp>
#include <rubato/analysis/exact_transient.hpp>
#include <rubato/analysis/load_checks.hpp>
#include <rubato/analysis/mechanism_transient.hpp>
#include <rubato/analysis/static.hpp>
#include <rubato/analysis/structure_transient.hpp>
#include <rubato/integrate/contact_events.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/integrate/kinds/structure_kind.hpp>
#include <rubato/integrate/load_jumps.hpp>
#include <rubato/integrate/stability.hpp>
#include <rubato/integrate/structure_balance.hpp>
#include <rubato/integrate/structure_energy.hpp>
#include <rubato/integrate/structure_failure.hpp>
#include <rubato/results/columns/structure_columns.hpp>

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace rubato::analysis {
namespace {

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

/// Of the stable step. At the limit itself the two eigenvalues of an undamped mode meet at -1, and its velocity grows
/// with the number of steps: a frame under linear acceleration, whose displacements kept to their tolerance, moved 20
/// times as fast as it should. At nine tenths what a step puts into the mode grows by 2.3 at most.
constexpr double stable_share = 0.9;

system::State static_start(const std::string& name, const Location& where, const model::StaticDescription& description,
                           const system::LocallyNonlinear& system, std::vector<std::string>& warnings) {
  const Vector& given = system.start().q;
  for (Index i = 0; i < given.size(); ++i)
    if (given[i] != 0.0)
      throw InvalidInput(where, fmt::format("analysis \"{}\": initial = \"static\" finds the positions, and coordinate "
                                            "\"{}\" is given one; remove it, or hold it by a [[displacement]]",
                                            name, system.coordinates()[static_cast<std::size_t>(i)]));
  const std::string title = "analysis \"" + name + "\": ";
  const integrate::Equilibrium found = equilibrium_of({title, where, description}, integrate::StructureKind(system));
  if (std::string rounding = warning_of_rounding(found); !rounding.empty())
    warnings.push_back("at the start " + rounding);
  return found.state;
}

std::string missed_jumps(const integrate::LoadJumps& jumps) {
  return fmt::format(
      "{} of a load {} within a step, the first at t = {:.9g} s: it is seen at the end of that step, an error of first "
      "order; give a step that divides the times of jumps, or step = {{ tolerance = 1e-3 }}",
      jumps.missed() == 1 ? "1 jump" : fmt::format("{} jumps", jumps.missed()), jumps.missed() == 1 ? "falls" : "fall",
      jumps.first_missed());
}

class StructureMarch final : public TransientMarch {
 public:
  StructureMarch(const TransientPlan& plan, const system::LocallyNonlinear& system)
      : plan_(plan),
        system_(system),
        stepper_(integrate::make_stepper(plan.method, system)),
        timeline_(system, integrate::relative_resolution * (plan.duration - plan.start.t),
                  !plan.automatic || plan.automatic->plan.locate_sliders),
        balance_(system),
        state_(integrate::consistent_start(system, plan.start)),
        contacts_(system, state_, plan.automatic && plan.automatic->plan.locate_events ? &timeline_ : nullptr) {
    if (!plan.automatic)
      jumps_.emplace(system, plan.start.t, plan.duration);
    else
      estimator_ = integrate::make_estimator(plan.automatic->estimator, plan.method, system, *stepper_, plan.duration,
                                             plan.automatic->plan.bounds);
  }

  const system::State& state() const override { return state_; }
  integrate::Balance& balance() override { return balance_; }
  std::vector<std::unique_ptr<integrate::EnergyPart>> energy_parts() override {
    return integrate::energy_parts(system_, balance_);
  }
  results::ColumnGroups columns() override { return results::columns_of_motion(system_, plan_.observed); }
  integrate::Observer* listener() override { return contacts_.events().parts.empty() ? nullptr : &contacts_; }
  long steps_a_report() const override { return system_.size() > 1000 ? 1 : 256; }

  integrate::StepReport start_fault() const override {
    if (state_.auxiliary_acceleration.allFinite()) return {};
    integrate::StepReport fault{integrate::StepOutcome::not_finite};
    for (Index i = system_.size() - 1; i >= 0; --i)
      if (!std::isfinite(state_.auxiliary_acceleration[i])) fault.worst = i;
    return fault;
  }

  integrate::AdaptiveReport go_to(double end, integrate::Observer* observer, integrate::TryLog* log) override {
    if (estimator_)
      return integrate::march(*stepper_, *estimator_, plan_.automatic->plan, timeline_, state_, end, observer, log);
    integrate::AdaptiveReport report;
    report.march = integrate::march(*stepper_, state_, plan_.step, end, observer, &*jumps_);
    report.factorisations = stepper_->factorisations();
    return report;
  }

  integrate::MarchFailure failure(const integrate::MarchReport& report) override {
    return integrate::failure_of(report, system_);
  }

  integrate::Events events() const override { return contacts_.events(); }

  void conclude(const integrate::AdaptiveReport&, RunReport& run) const override {
    if (jumps_ && jumps_->missed() > 0) run.warnings.push_back(missed_jumps(*jumps_));
  }

 private:
  const TransientPlan& plan_;
  const system::LocallyNonlinear& system_;
  std::unique_ptr<integrate::Stepper> stepper_;
  std::unique_ptr<integrate::Estimator> estimator_;  // null: steps are equal
  integrate::StructureTimeline timeline_;            // of steps that choose themselves
  integrate::StructureBalance balance_;
  std::optional<integrate::LoadJumps> jumps_;  // that equal steps miss
  system::State state_;
  integrate::ContactEvents contacts_;
};

}  // namespace

void StructureTransient::check(const TransientRequest& request, const TransientPlan& plan) const {
  const model::TransientDescription& description = request.description;
  if (description.section_forces.is_wanted())
    throw InvalidInput(
        description.section_forces.where,
        request.title() + "section_forces are kept of geometrically exact beams, in mechanisms; leave it out");
  if (description.project_velocities)
    throw InvalidInput(
        description.project_velocities_where,
        request.title() + "project_velocities is for mechanisms: this model has no joints; leave it out");
  if (!std::holds_alternative<integrate::Exact>(plan.method.formula)) return;
  if (description.step || description.automatic_step)
    throw InvalidInput(
        place(description.step ? description.step->where : description.automatic_step->where, request.where),
        request.title() + "the method exact takes no step; remove the key, or choose another method");
  if (system_.supports())
    throw InvalidInput(
        place(description.method.where, request.where),
        fmt::format("{}the method exact knows forces, and \"{}\" moves as its [[displacement]] says; take "
                    "\"generalized_alpha\"",
                    request.title(), system_.supports()->names().front()));
}

void StructureTransient::find_start(const TransientRequest& request, TransientPlan& plan) const {
  plan.start = request.description.initial
                   ? static_start(request.name, request.where, *request.description.initial, system_, plan.warnings)
                   : system_.start();
}

void StructureTransient::take_equal_steps(const TransientRequest& request, TransientPlan& plan) const {
  if (plan.allow_unstable) return;
  const Location where = place(request.description.step->where, request.where);
  const integrate::ModelStability limit = integrate::stability_of(plan.method, system_);
  if (plan.step <= limit.step) return;
  const std::string mode = fmt::format(
      "mode {} of the model with all sliders stuck ({:.6g} rad/s, damping ratio {:.3g}, "
      "largest at \"{}\")",
      limit.mode, limit.angular_frequency, limit.damping_ratio, limit.largest_coordinate);
  if (limit.step == 0.0)
    throw InvalidInput(where, fmt::format("{} has no stable step for {}: every step makes it grow; take "
                                          "\"generalized_alpha\", or set allow_unstable = true",
                                          plan.method.name, mode));
  throw InvalidInput(where, fmt::format("the step {} s is beyond the stability limit of {}, {:.6g} s, which {} sets; "
                                        "take a smaller step, an unconditionally stable method such as "
                                        "\"generalized_alpha\", or set allow_unstable = true",
                                        plan.step, plan.method.name, limit.step, mode));
}

void StructureTransient::plan_events(const std::string& title, const model::StepDescription& description,
                                     const TransientPlan& plan, integrate::StepPlan& step) const {
  // Stages of such a step follow a law with a memory without a turn, and both solutions of the pair err alike.
  if (std::holds_alternative<integrate::RungeKutta>(plan.method.formula))
    for (const model::LawBetween& law : system_.laws())
      if (law.law->memory_size() > 0)
        throw InvalidInput(
            description.where,
            fmt::format("{}{} with steps that choose themselves does not see where the motion of \"{}\" turns within "
                        "a step, nor does its error estimate; take \"generalized_alpha\", or equal steps",
                        title, plan.method.name, law.name));
  // A pair is of so high an order that a transition within a step is all of its error, and its estimate does not see
  // it.
  const bool is_pair = std::holds_alternative<integrate::RungeKutta>(plan.method.formula);
  step.locate_sliders = is_pair || description.locate_events.has_value();
  step.locate_events =
      description.locate_events.value_or(system_.stop_count() > 0 || (is_pair && system_.slider_count() > 0));
}

double StructureTransient::largest_step(const std::string& title, const model::StepDescription& description,
                                        const TransientPlan& plan, double wanted) const {
  if (plan.allow_unstable) return wanted;
  const integrate::ModelStability limit = integrate::stability_of(plan.method, system_);
  if (stable_share * limit.step >= wanted) return wanted;
  if (limit.step == 0.0)
    throw InvalidInput(description.where,
                       fmt::format("{}{} has no stable step for mode {} of the model; take \"generalized_alpha\", or "
                                   "set allow_unstable = true",
                                   title, plan.method.name, limit.mode));
  if (!description.largest) return stable_share * limit.step;
  if (wanted <= limit.step) return wanted;
  throw InvalidInput(description.largest->where,
                     fmt::format("{}largest = {} s is beyond the stability limit of {}, {:.6g} s, which mode {} of the "
                                 "model sets; leave it out, or set allow_unstable = true",
                                 title, wanted, plan.method.name, limit.step, limit.mode));
}

integrate::EstimatorKind StructureTransient::default_estimator(const TransientPlan& plan, double tolerance) const {
  return integrate::default_estimator(plan.method, tolerance, system_.stop_count() > 0);
}

void StructureTransient::try_estimator(const TransientPlan& plan, const AutomaticStep& step) const {
  const auto stepper = integrate::make_stepper(plan.method, system_);
  integrate::make_estimator(step.estimator, plan.method, system_, *stepper, plan.duration, step.plan.bounds)
      ->start(integrate::consistent_start(system_, plan.start));
}

void StructureTransient::check_loads(const TransientRequest& request, const TransientPlan& plan) const {
  for (const auto& term : system_.loads().terms()) {
    const auto* table = std::get_if<model::TableLaw>(&term.law);
    const auto* spline = std::get_if<model::SplineLaw>(&term.law);
    if (table && table->beyond == model::TableLaw::Beyond::error)
      require_rows_to_reach(table->times, table->source, plan.duration, "\"zero\" or \"hold\"", request.where);
    if (spline && !spline->holds_beyond)
      require_rows_to_reach(spline->times, spline->source, plan.duration, "\"hold\"", request.where);
  }
  for (const auto& term : system_.loads().terms())
    if (const auto* motion = std::get_if<model::FormulaDerivative>(&term.law); motion && motion->order == 0)
      refuse_jump("the displacement", motion->formula, plan.duration, request.where);
  // The flow takes no large systems and no loads by formulas of t; exponentials are for small ones.
  try {
    if (std::holds_alternative<integrate::Exact>(plan.method.formula)) (void)integrate::ExactFlow(system_);
    if (std::holds_alternative<integrate::Exponential>(plan.method.formula))
      (void)integrate::make_stepper(plan.method, system_);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(request.where, fault.message());
  }
}

double StructureTransient::expected_columns(const TransientPlan& plan) const {
  return 1.0 + 3.0 * static_cast<double>(plan.observed.size()) + 2.0 * static_cast<double>(system_.contact_count()) +
         (plan.energy ? 8.0 : 0.0);
}

std::unique_ptr<TransientMarch> StructureTransient::march(const TransientPlan& plan) const {
  return std::make_unique<StructureMarch>(plan, system_);
}

RunReport StructureTransient::run(const std::string& name, const TransientPlan& plan, RunContext& context) const {
  if (std::holds_alternative<integrate::Exact>(plan.method.formula))
    return run_exact_transient(name, plan, system_, context);
  return TransientKind::run(name, plan, context);
}

std::unique_ptr<TransientKind> transient_kind(const integrate::SystemKind& kind) {
  struct Maker final : integrate::KindVisitor {
    std::unique_ptr<TransientKind> made;
    void structure(const system::LocallyNonlinear& system) override {
      made = std::make_unique<StructureTransient>(system);
    }
    void mechanism(const system::Mechanism& mechanism) override {
      made = std::make_unique<MechanismTransient>(mechanism);
    }
  };
  Maker maker;
  kind.show(maker);
  return std::move(maker.made);
}

}  // namespace rubato::analysis
