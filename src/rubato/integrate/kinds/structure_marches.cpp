#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/integrate/kinds/load_checks.hpp>
#include <rubato/integrate/kinds/structure_flow.hpp>
#include <rubato/integrate/kinds/structure_march.hpp>
#include <rubato/integrate/kinds/structure_marches.hpp>

#include <fmt/format.h>

namespace rubato::integrate {
namespace {

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

/// Of the stable step. At the limit itself the two eigenvalues of an undamped mode meet at -1, and its velocity grows
/// with the number of steps: a frame under linear acceleration, whose displacements kept to their tolerance, moved 20
/// times as fast as it should. At nine tenths what a step puts into the mode grows by 2.3 at most.
constexpr double stable_share = 0.9;

}  // namespace

void StructureMarches::check(const TransientRequest& request, const MarchPlan& plan) const {
  const model::TransientDescription& description = request.description;
  if (description.project_velocities)
    throw InvalidInput(
        description.project_velocities_where,
        request.title() + "project_velocities is for mechanisms: this model has no joints; leave it out");
  if (!std::holds_alternative<Exact>(plan.method.formula)) return;
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

system::State StructureMarches::start(const TransientRequest& request, std::vector<std::string>& /*warnings*/) const {
  const Vector& given = system_.start().q;
  for (Index i = 0; request.description.initial && i < given.size(); ++i)
    if (given[i] != 0.0)
      throw InvalidInput(request.where,
                         fmt::format("{}initial = \"static\" finds the positions, and coordinate \"{}\" is given one; "
                                     "remove it, or hold it by a [[displacement]]",
                                     request.title(), system_.coordinates()[static_cast<std::size_t>(i)]));
  return system_.start();
}

void StructureMarches::take_equal_steps(const TransientRequest& request, MarchPlan& plan) const {
  if (plan.allow_unstable) return;
  const Location where = place(request.description.step->where, request.where);
  const ModelStability limit = integrate::stability_of(plan.method, system_);
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

void StructureMarches::plan_events(const std::string& title, const model::StepDescription& description,
                                   const MarchPlan& plan, StepPlan& step) const {
  // A pair is of so high an order that a transition within a step is all of its error, and its estimate does not see
  // it; nor does it see what the memory of a law loses in a step.
  const bool is_pair = std::holds_alternative<RungeKutta>(plan.method.formula);
  bool has_memory = false;
  for (const model::LawBetween& law : system_.laws()) {
    has_memory = has_memory || law.law->memory_size() > 0;
    if (is_pair && !law.law->is_exact_between_guards())
      throw InvalidInput(description.where,
                         fmt::format("{}{} with steps that choose themselves does not see what the memory of \"{}\" "
                                     "loses within a step, nor does its error estimate; take \"generalized_alpha\", or "
                                     "equal steps",
                                     title, plan.method.name, law.name));
    if (is_pair && law.law->memory_size() > 0 && !description.locate_events.value_or(true))
      throw InvalidInput(
          description.where,
          fmt::format("{}events = \"pass\" lets the steps of {} pass over the turns of \"{}\", which its "
                      "error estimate does not see; leave it out",
                      title, plan.method.name, law.name));
  }
  if (is_pair && system_.block_count() > 0)
    throw InvalidInput(description.where,
                       fmt::format("{}{} with steps that choose themselves does not see where \"{}\" slips, opens and "
                                   "closes within a step, nor does its error estimate; take \"generalized_alpha\", or "
                                   "equal steps",
                                   title, plan.method.name, system_.blocks().front().name));
  step.locate_sliders = is_pair || description.locate_events.has_value();
  step.locate_events = description.locate_events.value_or(system_.stop_count() > 0 || system_.block_count() > 0 ||
                                                          (is_pair && (system_.slider_count() > 0 || has_memory)));
}

double StructureMarches::largest_step(const std::string& title, const model::StepDescription& description,
                                      const MarchPlan& plan, double wanted) const {
  if (plan.allow_unstable) return wanted;
  const ModelStability limit = integrate::stability_of(plan.method, system_);
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

EstimatorKind StructureMarches::default_estimator(const MarchPlan& plan, double tolerance) const {
  return integrate::default_estimator(plan.method, tolerance, system_.stop_count() > 0 || system_.block_count() > 0);
}

void StructureMarches::try_estimator(const MarchPlan& plan, const AutomaticStep& step) const {
  const auto stepper = make_stepper(plan.method, system_);
  make_estimator(step.estimator, plan.method, system_, *stepper, plan.duration, step.plan.bounds)
      ->start(consistent_start(system_, plan.start));
}

void StructureMarches::check_loads(const TransientRequest& request, const MarchPlan& plan) const {
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
    if (std::holds_alternative<Exact>(plan.method.formula)) (void)ExactFlow(system_);
    if (std::holds_alternative<Exponential>(plan.method.formula)) (void)make_stepper(plan.method, system_);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(request.where, fault.message());
  }
}

ModelStability StructureMarches::stability_of(const Method& method) const {
  return integrate::stability_of(method, system_);
}

std::unique_ptr<StepMarch> StructureMarches::march(const MarchPlan& plan) const {
  return make_structure_march(plan, system_);
}

std::unique_ptr<FlowMarch> StructureMarches::flow(const MarchPlan& plan) const {
  return make_structure_flow(plan, system_);
}

}  // namespace rubato::integrate
