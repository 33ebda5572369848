#include <rubato/analysis/mechanism_equilibrium.hpp>
#include <rubato/analysis/mechanism_load_swings.hpp>
#include <rubato/analysis/mechanism_plan.hpp>
#include <rubato/integrate/mechanism/friction_phases.hpp>
#include <rubato/integrate/mechanism/mechanism_space.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>
#include <rubato/integrate/mechanism/mechanism_stepper.hpp>
#include <rubato/numerics/formula_jump.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace rubato::analysis {
namespace {

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

std::string row_names(const std::vector<Index>& rows, const system::Mechanism& mechanism) {
  std::vector<std::string> names;
  for (const Index row : rows) names.push_back(fmt::format("\"{}\"", mechanism.rows()[static_cast<std::size_t>(row)]));
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Of a row of constraints, "JOINT.lock_moment", by the name that its force gives it.
const char* unit_of_row(const std::string& row) {
  const std::size_t dot = row.rfind('.');
  return dot != std::string::npos && row.find("moment", dot) != std::string::npos ? "rad" : "m";
}

const char* unit_of_coordinate(Index coordinate, const system::Mechanism& mechanism) {
  return mechanism.model().is_rotation[static_cast<std::size_t>(coordinate)] != 0 ? "rad" : "m";
}

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
                             const system::State& start, const numerics::Parameters& parameters, double duration) {
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
  const double largest = std::min(duration / 50.0, period_limit(mechanism.model(), duration));
  plan_step_range(title, description, parameters, duration,
                  std::min(duration, positive_or(description.largest, largest, title + "largest", parameters)), plan);
  const bool is_jump = description.estimator == "inertia_jump" || (description.estimator.empty() && is_paper);
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
                                    integrate::make_error_space(mechanism), start, duration);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(description.tolerance.where, title + fault.message());
  }
  step.expected_steps = std::ceil(duration / (description.controller == "fixed" ? plan.first : plan.largest));
  return step;
}

void warn_of_velocities(const integrate::ConsistentStart& start, const system::Mechanism& mechanism,
                        std::vector<std::string>& warnings) {
  if (start.most_changed < 0) return;
  warnings.push_back(fmt::format(
      "the velocities given do not satisfy the joints; they were changed, \"{}\" most, by "
      "{:.4g} {}/s, which {} {:.4g} J",
      mechanism.coordinates()[static_cast<std::size_t>(start.most_changed)], start.velocity_changed,
      unit_of_coordinate(start.most_changed, mechanism), start.energy_lost >= start.drive_work ? "took" : "gave",
      std::abs(start.energy_lost - start.drive_work)));
}

/// From an equilibrium at rest: with the velocities that are given, and the velocities and accelerations that the
/// drives have at t = 0.
system::State set_in_motion(const Location& where, const system::Mechanism& mechanism, system::State at_rest,
                            std::vector<std::string>& warnings) {
  at_rest.v = mechanism.start().v;
  if (mechanism.model().drives.empty() && at_rest.v.isZero(0.0)) return at_rest;
  system::MechanismEquations equations(mechanism);
  const auto start = integrate::make_consistent(equations, std::move(at_rest));
  if (!start.is_consistent)
    throw InvalidInput(
        where,
        "no velocities and accelerations were found at the equilibrium that the drives and joints allow; "
        "look for a drive that the joints hinder there");
  if (!mechanism.start().v.isZero(0.0)) warn_of_velocities(start, mechanism, warnings);
  return start.state;
}

/// Refuses friction that follows a reaction which joints share in a way that nothing determines: what they share is
/// known to the share of the matrix that lets them repeat each other, and steps that end at an event carry round-off
/// over that share and the square of their length into it.
void refuse_unknown_reactions(const Location& where, system::MechanismEquations& equations,
                              const system::State& state) {
  const auto& mechanism = equations.mechanism();
  Vector motion(mechanism.size()), row(mechanism.constraint_count()), rate(row.size());
  equations.go_to(state, model::Side::right);
  equations.linearise({}, state.multiplier, motion, row);
  if (!equations.factorise() || equations.redundant_rows().empty()) return;
  for (const auto& friction : mechanism.model().frictions)
    for (Index i = 0; i < friction.pressing_rows; ++i) {
      // A row that can be moved alone is held by its joint alone.
      const Index moved = mechanism.first_row(friction.joint) + friction.first_pressing_row + i;
      motion.setZero();
      row.setZero();
      row[moved] = 1.0;
      equations.solve(motion, row);
      equations.constraint_rate(motion, rate);
      if (rate[moved] > 0.999) continue;
      throw InvalidInput(
          where,
          fmt::format("the friction of \"{}\" follows a reaction that is not determined: what \"{}\" holds is held by "
                      "other joints too, in shares that nothing tells; give the friction a \"preload\", or let one of "
                      "the joints hold less (spherical or cylindrical for revolute)",
                      friction.name, mechanism.rows()[static_cast<std::size_t>(moved)]));
    }
}

/// Decides which joints with friction stick at the start.
void settle_start(const Location& where, const system::Mechanism& mechanism, double duration, system::State& state) {
  if (mechanism.model().frictions.empty()) return;
  system::MechanismEquations equations(mechanism);
  equations.set_duration(duration);
  refuse_unknown_reactions(where, equations, state);
  if (!integrate::settle_new_velocities(equations, state, 1e-6 * duration))
    throw InvalidInput(
        where,
        "no accelerations were found at the start that go with the friction of the joints: with "
        "so large a coefficient their reactions grow without bound; take a smaller one, or a preload for "
        "some of them");
}

/// A drive, or joints that had to move, may put a coordinate beyond its lock, which was meant to be reached.
void warn_of_locks_behind(const system::Mechanism& mechanism, const system::State& start,
                          std::vector<std::string>& warnings) {
  const auto& locks = mechanism.model().locks;
  for (std::size_t i = 0; i < locks.size(); ++i) {
    const model::Lock& lock = locks[i];
    const double beyond = lock.sign * (lock.s.value(start.q.data()) - lock.at);
    if (start.phase[i] != model::lock_open || !(beyond > 1e-9 * (1.0 + std::abs(lock.at)))) continue;
    warnings.push_back(
        fmt::format("\"{0}\" starts {1:.4g} {2} beyond its lock at {3:.6g} {2}, which does not hold it there: it would "
                    "have to come back and reach the lock from the other side",
                    lock.name, beyond, lock.s.is_angle() ? "rad" : "m", lock.at));
  }
}

/// Of masses and places that double precision cannot hold beside each other.
std::string immense_numbers(const system::Mechanism& mechanism) {
  const Vector inertia = mechanism.mass().diagonal(), place = mechanism.start().q.cwiseAbs();
  Index least = 0, most = 0;
  const double low = inertia.minCoeff(&least), high = inertia.maxCoeff(&most);
  const auto told = [&](double value, Index at) {
    return fmt::format("{:.4g} {} at \"{}\"", value,
                       mechanism.model().is_rotation[static_cast<std::size_t>(at)] != 0 ? "kg m2" : "kg",
                       mechanism.coordinates()[static_cast<std::size_t>(at)]);
  };
  return fmt::format(
      "the numbers of the model are too large or too small to compute with: masses and inertias reach "
      "from {} to {}, places to {:.4g} m; look at their units",
      told(low, least), told(high, most), place.maxCoeff());
}

}  // namespace

system::State assembled_start(const Location& where, const system::Mechanism& mechanism,
                              std::vector<std::string>& warnings, bool moves) {
  system::MechanismEquations equations(mechanism);
  const auto start = integrate::make_consistent(equations, mechanism.start());
  const auto coordinate = [&](Index i) { return mechanism.coordinates()[static_cast<std::size_t>(i)]; };
  if (start.is_assembled && start.worst_rate >= 0) {
    std::vector<std::string> drives;
    for (const auto& drive : mechanism.model().drives) drives.push_back(fmt::format("\"{}\"", drive.name));
    throw InvalidInput(
        where, fmt::format(
                   "drives contradict each other or the joints: all hold at the start, but at once \"{}\" would "
                   "come apart at {:.4g} {}/s; leave one of the drives of {} out, or let it say what the "
                   "others make of it",
                   mechanism.rows()[static_cast<std::size_t>(start.worst_rate)], start.gap_rate,
                   unit_of_row(mechanism.rows()[static_cast<std::size_t>(start.worst_rate)]), fmt::join(drives, ", ")));
  }
  if (!start.is_consistent) {
    equations.go_to(start.state, model::Side::right);
    const std::string part = equations.non_finite_part();
    if (start.is_assembled || !part.empty())
      throw InvalidInput(where, fmt::format("there are no finite accelerations at the start{}",
                                            part.empty() ? "" : ": " + part + " is not finite there"));
  }
  if (!start.is_consistent) {
    if (start.worst_row < 0 || !std::isfinite(start.gap)) throw InvalidInput(where, immense_numbers(mechanism));
    const std::string row = mechanism.rows()[static_cast<std::size_t>(start.worst_row)];
    if (!start.redundant.empty())
      throw InvalidInput(where, fmt::format("the joints cannot be assembled: they contradict each other; \"{}\" stays "
                                            "apart by {:.4g} {}, and {} can only repeat what other joints say",
                                            row, start.gap, unit_of_row(row), row_names(start.redundant, mechanism)));
    throw InvalidInput(where,
                       fmt::format("the joints cannot be assembled: \"{}\" stays apart by {:.4g} {}; look at the "
                                   "places and lengths around it",
                                   row, start.gap, unit_of_row(row)));
  }
  if (start.most_moved >= 0)
    warnings.push_back(fmt::format(
        "the positions given do not satisfy the joints; they were moved, \"{}\" most, by "
        "{:.4g} {}",
        coordinate(start.most_moved), start.position_moved, unit_of_coordinate(start.most_moved, mechanism)));
  if (moves) warn_of_velocities(start, mechanism, warnings);
  if (!start.redundant.empty())
    warnings.push_back(
        fmt::format("{} repeat{} what other joints say; of the reactions that make the same motion the "
                    "least ones are given",
                    row_names(start.redundant, mechanism), start.redundant.size() == 1 ? "s" : ""));
  return start.state;
}

std::string with_friction_told(const std::string& complaint, const system::Mechanism& mechanism) {
  if (complaint.empty() || mechanism.model().frictions.empty()) return complaint;
  return complaint +
         "; equilibria leave out the friction of joints, which this model has: let a transient come to rest";
}

std::vector<Observed> observed_or_all(const std::optional<std::vector<model::ObservationDescription>>& wanted,
                                      const system::Mechanism& mechanism) {
  const auto is_rotation = [&](Index i) { return mechanism.model().is_rotation[static_cast<std::size_t>(i)] != 0; };
  std::vector<Observed> observed;
  if (!wanted)
    for (Index i = 0; i < mechanism.size(); ++i)
      observed.push_back({mechanism.coordinates()[static_cast<std::size_t>(i)], i, ground, is_rotation(i)});
  else
    for (const auto& one : *wanted) {
      const Index first = find(one.first, one.where, mechanism);
      if (one.second.empty()) {
        observed.push_back({one.first, first, ground, is_rotation(first)});
        continue;
      }
      const Index second = find(one.second, one.where, mechanism);
      if (is_rotation(first) != is_rotation(second))
        throw InvalidInput(one.where, fmt::format("observe: \"{} - {}\" is the difference of a position [m] and a "
                                                  "rotation [rad]",
                                                  one.first, one.second));
      observed.push_back({one.first + " - " + one.second, first, second, is_rotation(first)});
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
    if (!description.automatic_step->largest) warn_of_fast_swings(mechanism.model(), transient.duration, plan.warnings);
    transient.automatic = automatic_step(title + "step: ", *description.automatic_step, transient.method, mechanism,
                                         transient.start, parameters, transient.duration);
  } else {
    if (!description.step) throw InvalidInput(where, title + "the key \"step\" [s] is missing");
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
  }
  refuse_short_tables(mechanism.model(), transient.duration, where);
  for (const auto& drive : mechanism.model().drives)
    if (const auto* formula = std::get_if<numerics::TimeFormula>(&drive.law))
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
