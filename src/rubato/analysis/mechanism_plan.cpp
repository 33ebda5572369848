#include <rubato/analysis/load_swings.hpp>
#include <rubato/analysis/mechanism_equilibrium.hpp>
#include <rubato/analysis/mechanism_plan.hpp>
#include <rubato/integrate/mechanism/friction_phases.hpp>
#include <rubato/integrate/mechanism/mechanism_space.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>
#include <rubato/integrate/mechanism/mechanism_stepper.hpp>
#include <rubato/numerics/formula_jump.hpp>
#include <rubato/results/columns/beam_section_forces.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {
namespace {

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

Index find(const std::string& name, const Location& where, const system::Mechanism& mechanism) {
  const auto& known = mechanism.coordinates();
  const auto found = std::find(known.begin(), known.end(), name);
  if (found != known.end()) return static_cast<Index>(found - known.begin());
  throw InvalidInput(where,
                     fmt::format("observe names \"{}\", which is no coordinate{}", name, suggestion(name, known)));
}

/// @param remedies  what else than more rows helps
void refuse_short_table(const model::TableLaw& table, double duration, const Location& where, const char* remedies) {
  if (table.beyond != model::TableLaw::Beyond::error) return;
  if (table.times.front() <= 0.0 && table.times.back() >= duration * (1.0 - 1e-12)) return;
  throw InvalidInput(where,
                     fmt::format("the table \"{}\" reaches from {} s to {} s, the analysis from 0 s to {} s; extend "
                                 "it, or say beyond = {} where it is used",
                                 table.source, table.times.front(), table.times.back(), duration, remedies));
}

void refuse_short_tables(const model::Mechanism& model, double duration, const Location& where) {
  const auto check = [&](const auto& law, const char* remedies) {
    if (const auto* table = std::get_if<model::TableLaw>(&law)) refuse_short_table(*table, duration, where, remedies);
  };
  constexpr const char* of_force = "\"zero\" or \"hold\"";
  for (const auto& force : model.forces) check(force.law, of_force);
  for (const auto& law : model.following_laws) check(law, of_force);
  for (const auto& drive : model.drives) check(drive.law, "\"hold\"");
}

AutomaticStep fixed_step(double step, double duration) {
  AutomaticStep automatic;
  automatic.asks_for_tolerance = false;
  automatic.plan.controller = integrate::FixedStep{};
  automatic.plan.first = automatic.plan.largest = step;
  automatic.plan.smallest = 1e-12 * duration;
  automatic.plan.locate_events = true;
  automatic.estimator = integrate::LocalError{automatic.tolerance};
  automatic.expected_steps = std::ceil(duration / step * (1.0 - 1e-12));
  return automatic;
}

AutomaticStep automatic_step(const std::string& title, const model::StepDescription& description,
                             const integrate::Method& method, const system::Mechanism& mechanism,
                             const system::State& start, const numerics::Parameters& parameters, double duration,
                             std::vector<std::string>& warnings) {
  AutomaticStep step;
  step.tolerance = model::evaluate(description.tolerance, parameters, title + "tolerance");
  const double reference = positive_or(description.reference, 0.0, title + "reference", parameters);
  integrate::StepPlan& plan = step.plan;
  const bool is_paper = description.controller == "cardona_cassano";
  if (is_paper) plan.controller = integrate::CardonaCassano{};
  if (description.controller == "fixed") plan.controller = integrate::FixedStep{};
  if (description.locate_events && !*description.locate_events)
    throw InvalidInput(description.where,
                       title +
                           "events = \"pass\" is for structures: a lock or a joint that sticks changes what the step "
                           "solves, so that steps of mechanisms always end there; remove it");
  plan.locate_events = true;
  plan.rebuild = description.rebuild;
  const LoadSwings swings(mechanism.model(), duration);
  const double largest = std::min(duration / 50.0, swings.harmonic_limit());
  plan_step_range(title, description, parameters, duration,
                  std::min(duration, positive_or(description.largest, largest, title + "largest", parameters)), plan);
  plan_swings(description, swings, plan, warnings);
  const bool is_jump = description.estimator == "inertia_jump" ||
                       (description.estimator.empty() && is_paper && integrate::is_of_second_order(method));
  if (description.reference_is_initial)
    throw InvalidInput(description.where, title +
                                              "reference = \"initial\" measures displacements, and configurations "
                                              "of mechanisms have none; give a number, or leave it out");
  if (is_jump)
    step.estimator = integrate::InertiaJump{step.tolerance, reference > 0.0 ? reference : mechanism.reference(),
                                            description.as_printed};
  else if (description.estimator == "embedded")
    step.estimator = integrate::Embedded{step.tolerance};
  else
    step.estimator = integrate::LocalError{step.tolerance};
  if (!is_jump && (description.reference || description.as_printed))
    throw InvalidInput(description.where,
                       title + "\"reference\" and \"as_printed\" belong to the estimator inertia_jump");
  try {
    (void)integrate::make_estimator(step.estimator, std::get<integrate::GeneralizedAlpha>(method.formula),
                                    integrate::make_error_space(mechanism, start, step.tolerance), start, duration);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(description.tolerance.where, title + fault.message());
  }
  step.expected_steps = description.controller == "fixed" ? std::ceil(duration / plan.first) : swings.least_steps(plan);
  return step;
}

}  // namespace

std::vector<Observed> observed_or_all(const std::optional<std::vector<model::ObservationDescription>>& wanted,
                                      const system::Mechanism& mechanism) {
  std::vector<Observed> observed;
  if (!wanted)
    observed = every_coordinate(mechanism);
  else
    for (const auto& one : *wanted) {
      const Index first = find(one.first, one.where, mechanism);
      if (one.second.empty()) {
        observed.push_back({one.first, first, ground, mechanism.is_rotation(first)});
        continue;
      }
      const Index second = find(one.second, one.where, mechanism);
      if (mechanism.is_rotation(first) != mechanism.is_rotation(second))
        throw InvalidInput(one.where, fmt::format("observe: \"{} - {}\" is the difference of a position [m] and a "
                                                  "rotation [rad]",
                                                  one.first, one.second));
      observed.push_back({one.first + " - " + one.second, first, second, mechanism.is_rotation(first)});
    }
  std::stable_partition(observed.begin(), observed.end(), [](const Observed& one) { return !one.is_rotation; });
  return observed;
}

std::string MechanismPlan::summary() const {
  if (std::holds_alternative<integrate::FixedStep>(transient.automatic->plan.controller))
    return fmt::format("transient, {}, {:.0f} steps of {} s to t = {} s", transient.method.name,
                       transient.automatic->expected_steps, transient.automatic->plan.first, transient.duration);
  return fmt::format("transient, {}, {}, to t = {} s", transient.method.name, analysis::summary(*transient.automatic),
                     transient.duration);
}

MechanismPlan plan_mechanism(const std::string& name, const Location& where,
                             const model::TransientDescription& description, const system::Mechanism& mechanism,
                             const numerics::Parameters& parameters) {
  const std::string title = "analysis \"" + name + "\": ";
  MechanismPlan plan;
  TransientPlan& transient = plan.transient;
  plan.allow_unstable = description.allow_unstable;
  plan.project_velocities = description.project_velocities;
  plan.section_forces = description.section_forces;
  (void)results::BeamSectionForces(mechanism, description.section_forces, title);
  transient.method = method_of(description.method, parameters);
  try {
    (void)integrate::make_mechanism_stepper(transient.method, mechanism, {}, plan.allow_unstable);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(place(description.method.where, where), title + fault.message());
  }
  transient.duration = positive_or(description.duration, 0.0, title + "duration", parameters);
  transient.energy = description.energy;
  transient.start = assembled_start(where, mechanism, plan.warnings, !description.initial);
  if (description.initial) {
    refuse_displacements(title, *description.initial);
    const MechanismStatic found = equilibrium_near(transient.start, mechanism);
    plan.failure = with_friction_told(found.complaint(mechanism), mechanism);
    if (plan.failure.empty()) {
      if (!found.is_stable)
        plan.warnings.push_back(
            "the equilibrium at the start is not stable: what moves from there begins with round-off");
      transient.start = set_in_motion(where, mechanism, found.state, plan.warnings);
    } else {
      plan.failure = "it has no static start: " + plan.failure;
    }
  }
  if (plan.failure.empty()) settle_start(where, mechanism, transient.duration, transient.start);
  warn_of_locks_behind(mechanism, transient.start, plan.warnings);
  if (description.automatic_step) {
    transient.automatic = automatic_step(title + "step: ", *description.automatic_step, transient.method, mechanism,
                                         transient.start, parameters, transient.duration, plan.warnings);
  } else {
    if (!description.step) throw InvalidInput(where, title + missing_step);
    const double step = positive_or(description.step, 0.0, title + "step", parameters);
    if (step > transient.duration)
      throw InvalidInput(
          place(description.step->where, where),
          fmt::format("{}the step {} s is longer than the duration {} s", title, step, transient.duration));
    if (transient.duration / step > 1e12)
      throw InvalidInput(place(description.step->where, where),
                         fmt::format("{}{:.3g} steps of {} s are more than a run can take (1e12)", title,
                                     transient.duration / step, step));
    transient.automatic = fixed_step(step, transient.duration);
    LoadSwings(mechanism.model(), transient.duration).warn_of_long_steps(step, plan.warnings);
  }
  refuse_short_tables(mechanism.model(), transient.duration, where);
  for (const auto& drive : mechanism.model().drives)
    if (const auto* formula = std::get_if<numerics::Formula>(&drive.law))
      if (const auto jump = numerics::first_jump(*formula, 0, 0.0, transient.duration))
        throw InvalidInput(where,
                           fmt::format("joint \"{}\": the drive \"{}\" jumps at t = {} s, and nothing moves from "
                                       "one place to another at once; give it a time between",
                                       drive.name, formula->text(), *jump));
  plan_output(transient, description.output, parameters, where);
  transient.observed = observed_or_all(description.observe, mechanism);
  return plan;
}

}  // namespace rubato::analysis
