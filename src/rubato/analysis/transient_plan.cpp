#include <rubato/analysis/equilibrium_text.hpp>
#include <rubato/analysis/load_swings.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/results/columns/kind_columns.hpp>

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace rubato::analysis {
namespace {

using integrate::MarchPlan;
using integrate::TransientRequest;
using Kind = model::OutputDescription::Kind;

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

double positive(const model::Quantity& quantity, const numerics::Parameters& parameters, const std::string& what,
                const Location& where) {
  const double value = model::evaluate(quantity, parameters, what);
  if (!(value > 0.0))
    throw InvalidInput(place(quantity.where, where), fmt::format("{} must be positive, got {}", what, value));
  return value;
}

/// Where rows are wanted and how many that makes; method, step and duration are planned already.
void plan_output(TransientPlan& plan, const model::OutputDescription& output, const numerics::Parameters& parameters,
                 const Location& where) {
  plan.output = output.kind;
  plan.shows_every_step = output.shows_every_step && output.kind != Kind::every_step;
  const bool is_exact = std::holds_alternative<integrate::Exact>(plan.march.method.formula);
  const double steps = is_exact               ? 0.0
                       : plan.march.automatic ? plan.march.automatic->expected_steps
                                              : std::ceil(plan.march.duration / plan.march.step);
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
      plan.rows = std::floor(plan.march.duration / plan.interval) + 1.0;
      if (plan.rows > 1e12)
        throw InvalidInput(place(output.interval.where, where),
                           fmt::format("an interval of {} s makes {:.3g} rows, more than can be written (1e12)",
                                       plan.interval, plan.rows));
      break;
    case Kind::times:
      for (const auto& quantity : output.times) {
        double t = model::evaluate(quantity, parameters, "times");
        // The end by a formula of its own, 10*0.1 as a sum, may lie beyond it by round-off.
        constexpr double epsilon = std::numeric_limits<double>::epsilon();
        if (t > plan.march.duration && t - plan.march.duration <= 8.0 * epsilon * plan.march.duration)
          t = plan.march.duration;
        const double last = plan.times.empty() ? -1.0 : plan.times.back();
        if (!(t >= 0.0 && t <= plan.march.duration))
          throw InvalidInput(place(quantity.where, where),
                             fmt::format("times: {} s lies outside the run from 0 s to {} s", t, plan.march.duration));
        if (!(t > last))
          throw InvalidInput(place(quantity.where, where), fmt::format("times must rise, got {} after {}", t, last));
        plan.times.push_back(t);
      }
      plan.rows = static_cast<double>(plan.times.size());
      break;
  }
}

/// Sets the start of a plan, what it took among the warnings, and the failure where there is none. Of a system whose
/// equilibrium is found at once that one is missing is refused.
void find_start(const TransientRequest& request, const integrate::SystemKind& kind, MarchPlan& plan) {
  const integrate::MarchKind& marches = kind.marches();
  plan.start = marches.start(request, plan.warnings);
  if (const auto& initial = request.description.initial) {
    const std::string title = request.title();
    const auto held = kind.held_displacements({title, request.where, *initial});
    const integrate::Equilibrium found = kind.find_equilibrium(plan.start, held);
    if (const std::string why = complaint(found); why.empty()) {
      if (const std::string rounding = warning_of_rounding(found); !rounding.empty())
        plan.warnings.push_back("at the start " + rounding);
      if (!found.is_stable)
        plan.warnings.push_back(
            "the equilibrium at the start is not stable: what moves from there begins with round-off");
      plan.start = marches.set_in_motion(request.where, found.state, plan.warnings);
    } else if (is_certain(found) && kind.finds_equilibrium_at_once()) {
      throw InvalidInput(request.where, title + why);
    } else {
      plan.failure = "it has no static start: " + why;
    }
  }
  marches.settle_start(request.where, plan);
}

/// How many columns a row has, roughly.
double expected_columns(const TransientPlan& plan, const integrate::SystemKind& kind) {
  const double observed = 3.0 * static_cast<double>(plan.observed.size());
  if (kind.is_constrained()) return 10.0 + observed;
  return 1.0 + observed + 2.0 * static_cast<double>(kind.nonlinear_parts().size()) + (plan.energy ? 8.0 : 0.0);
}

void plan_steps(const TransientRequest& request, const integrate::SystemKind& kind, MarchPlan& plan) {
  const model::TransientDescription& description = request.description;
  const std::string title = request.title();
  if (description.automatic_step) {
    plan.automatic = plan_automatic_step(request, kind, plan, plan.warnings);
    return;
  }
  if (std::holds_alternative<integrate::Exact>(plan.method.formula)) return;
  if (!description.step) throw InvalidInput(request.where, title + missing_step);
  const Location at = place(description.step->where, request.where);
  plan.step = positive(*description.step, request.parameters, title + "step", request.where);
  if (plan.step > plan.duration)
    throw InvalidInput(
        at, fmt::format("{}the step {} s is longer than the duration {} s", title, plan.step, plan.duration));
  if (plan.duration / plan.step > 1e12)
    throw InvalidInput(at, fmt::format("{}{:.3g} steps of {} s are more than a run can take (1e12)", title,
                                       plan.duration / plan.step, plan.step));
  kind.marches().take_equal_steps(request, plan);
  LoadSwings(kind, plan.duration).warn_of_long_steps(plan.step, plan.warnings);
}

}  // namespace

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

TransientPlan plan_transient(const std::string& name, const Location& where,
                             const model::TransientDescription& description, const integrate::SystemKind& kind,
                             const numerics::Parameters& parameters) {
  const TransientRequest request{name, where, description, parameters};
  TransientPlan plan;
  MarchPlan& march = plan.march;
  march.method = method_of(description.method, parameters);
  march.allow_unstable = description.allow_unstable;
  march.project_velocities = description.project_velocities;
  march.duration = positive(description.duration, parameters, request.title() + "duration", where);
  results::check_section_forces(kind, description.section_forces, request.title());
  kind.marches().check(request, march);
  find_start(request, kind, march);
  plan_steps(request, kind, march);
  plan.energy = description.energy;
  plan.section_forces = description.section_forces;
  plan_output(plan, description.output, parameters, where);
  kind.marches().check_loads(request, march);
  plan.observed = observed_or_all(description.observe, {kind.system(), kind.supports(), Supports::observed});
  plan.columns = expected_columns(plan, kind);
  return plan;
}

std::string summary(const TransientPlan& of) {
  const MarchPlan& plan = of.march;
  if (plan.step > 0.0)
    return fmt::format("transient, {}, {:.0f} steps of {} s to t = {} s", plan.method.name,
                       std::ceil(plan.duration / plan.step * (1.0 - 1e-12)), plan.step, plan.duration);
  return fmt::format("transient, {}, {}to t = {} s", plan.method.name,
                     plan.automatic ? summary(*plan.automatic) + ", " : "", plan.duration);
}

}  // namespace rubato::analysis
