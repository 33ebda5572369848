#include <rubato/analysis/load_swings.hpp>
#include <rubato/analysis/static.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/stability.hpp>
#include <rubato/numerics/formula_jump.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::analysis {
namespace {

using Kind = model::OutputDescription::Kind;

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

double positive(const model::Quantity& quantity, const numerics::Parameters& parameters, const std::string& what,
                const Location& where) {
  const double value = model::evaluate(quantity, parameters, what);
  if (!(value > 0.0))
    throw InvalidInput(place(quantity.where, where), fmt::format("{} must be positive, got {}", what, value));
  return value;
}

void require_tables_to_reach(const system::LocallyNonlinear& system, double end, const Location& where) {
  for (const auto& term : system.loads().terms()) {
    const auto* table = std::get_if<model::TableLaw>(&term.law);
    const auto* spline = std::get_if<model::SplineLaw>(&term.law);
    if (!(table && table->beyond == model::TableLaw::Beyond::error) && !(spline && !spline->holds_beyond)) continue;
    const std::vector<double>& times = table ? table->times : spline->times;
    const std::string& source = table ? table->source : spline->source;
    if (times.front() <= 0.0 && times.back() >= end * (1.0 - 1e-12)) continue;
    throw InvalidInput(
        where, fmt::format("the table {} reaches from {} s to {} s, the analysis from 0 s to {} s; extend "
                           "it, or say beyond = {}\"hold\" where it is used",
                           source.empty() ? "of a load" : "\"" + source + "\"", times.front(), times.back(), end,
                           table ? "\"zero\" or " : ""));
  }
}

void require_continuous_supports(const system::LocallyNonlinear& system, double end, const Location& where) {
  for (const auto& term : system.loads().terms()) {
    const auto* motion = std::get_if<model::FormulaDerivative>(&term.law);
    if (!motion || motion->order > 0) continue;
    if (const auto jump = numerics::first_jump(motion->formula, 0, 0.0, end))
      throw InvalidInput(where,
                         fmt::format("the displacement \"{}\" jumps at t = {} s, and nothing moves from one place "
                                     "to another at once; give it a time between",
                                     motion->formula.text(), *jump));
  }
}

void require_stable(const TransientPlan& plan, const system::LocallyNonlinear& system, const Location& where) {
  const integrate::ModelStability limit = integrate::stability_of(plan.method, system);
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

system::State static_start(const std::string& name, const Location& where, const model::StaticDescription& description,
                           const system::LocallyNonlinear& system) {
  const Vector& given = system.start().q;
  for (Index i = 0; i < given.size(); ++i)
    if (given[i] != 0.0)
      throw InvalidInput(where, fmt::format("analysis \"{}\": initial = \"static\" finds the positions, and coordinate "
                                            "\"{}\" is given one; remove it, or hold it by a [[displacement]]",
                                            name, system.coordinates()[static_cast<std::size_t>(i)]));
  return equilibrium_of(name, where, description, system).state;
}

}  // namespace

void plan_output(TransientPlan& plan, const model::OutputDescription& output, const numerics::Parameters& parameters,
                 const Location& where) {
  plan.output = output.kind;
  const bool is_exact = std::holds_alternative<integrate::Exact>(plan.method.formula);
  const double steps = is_exact         ? 0.0
                       : plan.automatic ? plan.automatic->expected_steps
                                        : std::ceil(plan.duration / plan.step);
  switch (output.kind) {
    case Kind::every_step:
      plan.rows = steps + 1.0;
      break;
    case Kind::every:
      if (is_exact)
        throw InvalidInput(place(output.where, where),
                           "output = { every = ... } counts steps, and the method exact takes none; say "
                           "output = { interval = ... } or { times = [...] }");
      if (output.every < 1)
        throw InvalidInput(place(output.where, where), fmt::format("every must be at least 1, got {}", output.every));
      plan.every = output.every;
      plan.rows = std::floor(steps / output.every) + 2.0;
      break;
    case Kind::interval:
      plan.interval = positive(output.interval, parameters, "interval", where);
      plan.rows = std::floor(plan.duration / plan.interval) + 1.0;
      if (plan.rows > 1e12)
        throw InvalidInput(place(output.interval.where, where),
                           fmt::format("an interval of {} s makes {:.3g} rows, more than can be written (1e12)",
                                       plan.interval, plan.rows));
      break;
    case Kind::times:
      for (const auto& quantity : output.times) {
        const double t = model::evaluate(quantity, parameters, "times");
        const double last = plan.times.empty() ? -1.0 : plan.times.back();
        if (!(t >= 0.0 && t <= plan.duration))
          throw InvalidInput(place(quantity.where, where),
                             fmt::format("times: {} s lies outside the run from 0 s to {} s", t, plan.duration));
        if (!(t > last))
          throw InvalidInput(place(quantity.where, where), fmt::format("times must rise, got {} after {}", t, last));
        plan.times.push_back(t);
      }
      plan.rows = static_cast<double>(plan.times.size());
      break;
  }
}

integrate::Method method_of(const model::MethodDescription& description, const numerics::Parameters& parameters) {
  std::vector<std::pair<std::string, double>> values;
  for (const auto& [key, quantity] : description.parameters)
    values.emplace_back(key, model::evaluate(quantity, parameters, key));
  try {
    return integrate::make_method(description.name, values);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(description.where, fault.message());
  }
}

Observed observed_of(const model::ObservationDescription& description, const system::LocallyNonlinear& system,
                     Supports supports) {
  const bool has_supports = supports == Supports::observed && system.supports();
  const auto index_of = [&](const std::string& name) {
    std::vector<std::string> known = system.coordinates();
    if (has_supports) known.insert(known.end(), system.supports()->names().begin(), system.supports()->names().end());
    const auto found = std::find(known.begin(), known.end(), name);
    if (found != known.end()) return static_cast<Index>(found - known.begin());
    if (system.supports() && std::count(system.supports()->names().begin(), system.supports()->names().end(), name) > 0)
      throw InvalidInput(description.where, fmt::format("observe names \"{}\", which moves as its [[displacement]] "
                                                        "says; only transients show it",
                                                        name));
    const bool lacks_spaces = name.find('-') != std::string::npos && nearest_name(name, known).empty();
    throw InvalidInput(description.where,
                       fmt::format("observe names \"{}\", which is no coordinate{}{}", name, suggestion(name, known),
                                   lacks_spaces ? "; a difference is written with spaces, \"a - b\"" : ""));
  };
  const auto turns = [&](Index i) {
    return i < system.size() ? system.is_rotation(i) : system.supports()->is_rotation(i - system.size());
  };
  const Index first = index_of(description.first);
  if (description.second.empty()) return {description.first, first, ground, turns(first)};
  const Index second = index_of(description.second);
  if (turns(first) != turns(second))
    throw InvalidInput(description.where,
                       fmt::format("observe: \"{} - {}\" is the difference of a displacement [m] and "
                                   "a rotation [rad]",
                                   description.first, description.second));
  return {description.first + " - " + description.second, first, second, turns(first)};
}

std::vector<Observed> every_coordinate(const system::System& system) {
  std::vector<Observed> observed;
  for (Index i = 0; i < system.size(); ++i)
    observed.push_back({system.coordinates()[static_cast<std::size_t>(i)], i, ground, system.is_rotation(i)});
  return observed;
}

std::vector<Observed> observed_or_all(const std::optional<std::vector<model::ObservationDescription>>& wanted,
                                      const system::LocallyNonlinear& system, Supports supports) {
  std::vector<Observed> observed;
  if (wanted) {
    for (const auto& observation : *wanted) observed.push_back(observed_of(observation, system, supports));
  } else {
    observed = every_coordinate(system);
    for (Index i = 0; supports == Supports::observed && system.supports() && i < system.supports()->size(); ++i)
      observed.push_back({system.supports()->names()[static_cast<std::size_t>(i)], system.size() + i, ground,
                          system.supports()->is_rotation(i)});
  }
  std::stable_partition(observed.begin(), observed.end(), [](const Observed& one) { return !one.is_rotation; });
  return observed;
}

TransientPlan plan_transient(const std::string& name, const Location& where,
                             const model::TransientDescription& description, const system::LocallyNonlinear& system,
                             const numerics::Parameters& parameters) {
  const std::string title = "analysis \"" + name + "\": ";
  TransientPlan plan;
  plan.method = method_of(description.method, parameters);
  plan.duration = positive(description.duration, parameters, title + "duration", where);
  plan.energy = description.energy;
  if (description.section_forces.is_wanted())
    throw InvalidInput(description.section_forces.where,
                       title + "section_forces are kept of geometrically exact beams, in mechanisms; leave it out");
  if (description.project_velocities)
    throw InvalidInput(description.project_velocities_where,
                       title + "project_velocities is for mechanisms: this model has no joints; leave it out");
  plan.start = system.start();
  if (description.initial) plan.start = static_start(name, where, *description.initial, system);
  const bool is_exact = std::holds_alternative<integrate::Exact>(plan.method.formula);
  if (is_exact && (description.step || description.automatic_step))
    throw InvalidInput(place(description.step ? description.step->where : description.automatic_step->where, where),
                       title + "the method exact takes no step; remove the key, or choose another method");
  if (is_exact && system.supports())
    throw InvalidInput(
        place(description.method.where, where),
        fmt::format("{}the method exact knows forces, and \"{}\" moves as its [[displacement]] says; take "
                    "\"generalized_alpha\"",
                    title, system.supports()->names().front()));
  if (description.automatic_step) {
    plan.automatic = plan_automatic_step(title, *description.automatic_step, plan.method, system, plan.start,
                                         parameters, plan.duration, description.allow_unstable, plan.warnings);
  } else if (!is_exact) {
    if (!description.step) throw InvalidInput(where, title + missing_step);
    plan.step = positive(*description.step, parameters, title + "step", where);
    if (plan.step > plan.duration)
      throw InvalidInput(
          place(description.step->where, where),
          fmt::format("{}the step {} s is longer than the duration {} s", title, plan.step, plan.duration));
    if (plan.duration / plan.step > 1e12)
      throw InvalidInput(place(description.step->where, where),
                         fmt::format("{}{:.3g} steps of {} s are more than a run can take (1e12)", title,
                                     plan.duration / plan.step, plan.step));
    if (!description.allow_unstable) require_stable(plan, system, place(description.step->where, where));
    LoadSwings(system, plan.duration).warn_of_long_steps(plan.step, plan.warnings);
  }
  plan_output(plan, description.output, parameters, where);
  require_tables_to_reach(system, plan.duration, where);
  require_continuous_supports(system, plan.duration, where);
  plan.observed = observed_or_all(description.observe, system, Supports::observed);
  return plan;
}

}  // namespace rubato::analysis
