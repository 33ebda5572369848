#include <rubato/integrate/contact_events.hpp>
#include <rubato/integrate/kinds/structure_march.hpp>
#include <rubato/integrate/load_jumps.hpp>
#include <rubato/integrate/structure_balance.hpp>
#include <rubato/integrate/structure_energy.hpp>
#include <rubato/integrate/structure_failure.hpp>

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace rubato::integrate {
namespace {

std::string missed_jumps(const LoadJumps& jumps) {
  return fmt::format(
      "{} of a load {} within a step, the first at t = {:.9g} s: it is seen at the end of that step, an error of first "
      "order; give a step that divides the times of jumps, or step = {{ tolerance = 1e-3 }}",
      jumps.missed() == 1 ? "1 jump" : fmt::format("{} jumps", jumps.missed()), jumps.missed() == 1 ? "falls" : "fall",
      jumps.first_missed());
}

class StructureMarch final : public StepMarch {
 public:
  StructureMarch(const MarchPlan& plan, const system::LocallyNonlinear& system)
      : plan_(plan),
        system_(system),
        stepper_(make_stepper(plan.method, system)),
        timeline_(system, relative_resolution * (plan.duration - plan.start.t),
                  !plan.automatic || plan.automatic->plan.locate_sliders),
        balance_(system),
        state_(consistent_start(system, plan.start)),
        contacts_(system, state_, plan.automatic && plan.automatic->plan.locate_events ? &timeline_ : nullptr) {
    if (!plan.automatic)
      jumps_.emplace(system, plan.start.t, plan.duration);
    else
      estimator_ = make_estimator(plan.automatic->estimator, plan.method, system, *stepper_, plan.duration,
                                  plan.automatic->plan.bounds);
  }

  const system::State& state() const override { return state_; }
  Balance& balance() override { return balance_; }
  std::vector<std::unique_ptr<EnergyPart>> energy_parts() override {
    return integrate::energy_parts(system_, balance_);
  }
  void show(MarchVisitor& visitor) override { visitor.structure(system_); }
  Observer* listener() override { return contacts_.events().parts.empty() ? nullptr : &contacts_; }
  long steps_a_report() const override { return system_.size() > 1000 ? 1 : 256; }

  StepReport start_fault() const override {
    if (state_.auxiliary_acceleration.allFinite()) return {};
    StepReport fault{StepOutcome::not_finite};
    for (Index i = system_.size() - 1; i >= 0; --i)
      if (!std::isfinite(state_.auxiliary_acceleration[i])) fault.worst = i;
    return fault;
  }

  AdaptiveReport go_to(double end, Observer* observer, TryLog* log) override {
    if (estimator_)
      return integrate::march(*stepper_, *estimator_, plan_.automatic->plan, timeline_, state_, end, observer, log);
    AdaptiveReport report;
    report.march = integrate::march(*stepper_, state_, plan_.step, end, observer, &*jumps_);
    report.factorisations = stepper_->factorisations();
    return report;
  }

  MarchFailure failure(const MarchReport& report) override { return integrate::failure_of(report, system_); }

  Events events() const override { return contacts_.events(); }

  MarchNotes notes(const AdaptiveReport&) const override {
    MarchNotes notes;
    if (jumps_ && jumps_->missed() > 0) notes.warnings.push_back(missed_jumps(*jumps_));
    notes.findings = contacts_.never_reached();
    return notes;
  }

 private:
  const MarchPlan& plan_;
  const system::LocallyNonlinear& system_;
  std::unique_ptr<Stepper> stepper_;
  std::unique_ptr<Estimator> estimator_;  // null: steps are equal
  StructureTimeline timeline_;            // of steps that choose themselves
  StructureBalance balance_;
  std::optional<LoadJumps> jumps_;  // that equal steps miss
  system::State state_;
  ContactEvents contacts_;
};

}  // namespace

std::unique_ptr<StepMarch> make_structure_march(const MarchPlan& plan, const system::LocallyNonlinear& system) {
  return std::make_unique<StructureMarch>(plan, system);
}

}  // namespace rubato::integrate
