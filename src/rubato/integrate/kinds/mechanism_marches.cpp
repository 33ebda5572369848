#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/kinds/load_checks.hpp>
#include <rubato/integrate/kinds/mechanism_march.hpp>
#include <rubato/integrate/kinds/mechanism_marches.hpp>
#include <rubato/integrate/kinds/mechanism_start_state.hpp>

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <variant>

namespace rubato::integrate {

void MechanismMarches::check(const TransientRequest& request, const MarchPlan& plan) const {
  try {
    NewtonPlan newton;
    newton.projects_velocities = plan.project_velocities;
    check_stepper(plan.method, mechanism_, newton, plan.allow_unstable);
  } catch (const InvalidInput& fault) {
    const Location& named = request.description.method.where;
    throw InvalidInput(named.line > 0 ? named : request.where, request.title() + fault.message());
  }
}

system::State MechanismMarches::start(const TransientRequest& request, std::vector<std::string>& warnings) const {
  return assembled_start(request.where, mechanism_, warnings, !request.description.initial);
}

system::State MechanismMarches::set_in_motion(const Location& where, const system::State& at_rest,
                                              std::vector<std::string>& warnings) const {
  return integrate::set_in_motion(where, mechanism_, at_rest, warnings);
}

void MechanismMarches::settle_start(const Location& where, MarchPlan& plan) const {
  if (plan.failure.empty()) integrate::settle_start(where, mechanism_, plan.duration, plan.start);
  warn_of_locks_behind(mechanism_, plan.start, plan.warnings);
}

void MechanismMarches::take_equal_steps(const TransientRequest& /*request*/, MarchPlan& plan) const {
  AutomaticStep step;
  step.asks_for_tolerance = false;
  step.plan.controller = FixedStep{};
  step.plan.first = step.plan.largest = plan.step;
  step.plan.smallest = 1e-12 * plan.duration;
  step.plan.locate_events = true;
  step.plan.locate_sliders = false;
  step.estimator = LocalError{step.tolerance};
  step.expected_steps = std::ceil(plan.duration / plan.step * (1.0 - 1e-12));
  plan.automatic = step;
}

void MechanismMarches::plan_events(const std::string& title, const model::StepDescription& description,
                                   const MarchPlan& /*plan*/, StepPlan& step) const {
  if (description.locate_events && !*description.locate_events)
    throw InvalidInput(description.where,
                       title +
                           "events = \"pass\" is for structures: a lock or a joint that sticks changes what the step "
                           "solves, so that steps of mechanisms always end there; remove it");
  if (description.reference_is_initial)
    throw InvalidInput(description.where, title +
                                              "reference = \"initial\" measures displacements, and configurations "
                                              "of mechanisms have none; give a number, or leave it out");
  if (description.locate_events)
    for (const model::MechanismLaw& law : mechanism_.model().laws)
      if (law.reaction.presses())
        throw InvalidInput(
            description.where,
            fmt::format("{}events = \"locate\" does not go with the {} \"{}\", which a reaction presses: over steps "
                        "as short as those between its transitions reactions are round-off, and it would open in "
                        "between; remove it, and the error chooses the steps",
                        title, law.kind, law.name));
  step.locate_events = true;
  step.locate_sliders = description.locate_events.has_value();
}

void MechanismMarches::try_estimator(const MarchPlan& plan, const AutomaticStep& step) const {
  system::MechanismEquations equations(mechanism_);
  (void)make_mechanism_estimator(plan, step, equations);
}

void MechanismMarches::check_loads(const TransientRequest& request, const MarchPlan& plan) const {
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

ModelStability MechanismMarches::stability_of(const Method& /*method*/) const {
  ModelStability unlimited;
  unlimited.step = std::numeric_limits<double>::infinity();
  return unlimited;
}

std::unique_ptr<StepMarch> MechanismMarches::march(const MarchPlan& plan) const {
  return make_mechanism_march(plan, mechanism_);
}

}  // namespace rubato::integrate
