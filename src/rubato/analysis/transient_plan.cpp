#include <rubato/analysis/transient_kind.hpp>
#include <rubato/integrate/catalogue.hpp>

#include <fmt/format.h>

#include <cmath>

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

/// Where rows are wanted and how many that makes; method, step and duration are planned already.
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

void plan_steps(const TransientRequest& request, const TransientKind& kind, TransientPlan& plan) {
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
  kind.take_equal_steps(request, plan);
  kind.swings(plan.duration).warn_of_long_steps(plan.step, plan.warnings);
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
                             const model::TransientDescription& description, const TransientKind& kind,
                             const numerics::Parameters& parameters) {
  const TransientRequest request{name, where, description, parameters};
  TransientPlan plan;
  plan.method = method_of(description.method, parameters);
  plan.energy = description.energy;
  plan.allow_unstable = description.allow_unstable;
  plan.project_velocities = description.project_velocities;
  plan.section_forces = description.section_forces;
  plan.duration = positive(description.duration, parameters, request.title() + "duration", where);
  kind.check(request, plan);
  kind.find_start(request, plan);
  plan_steps(request, kind, plan);
  plan_output(plan, description.output, parameters, where);
  kind.check_loads(request, plan);
  plan.observed = observed_or_all(description.observe, kind.observable());
  plan.columns = kind.expected_columns(plan);
  return plan;
}

std::string summary(const TransientPlan& plan) {
  if (plan.step > 0.0)
    return fmt::format("transient, {}, {:.0f} steps of {} s to t = {} s", plan.method.name,
                       std::ceil(plan.duration / plan.step * (1.0 - 1e-12)), plan.step, plan.duration);
  return fmt::format("transient, {}, {}to t = {} s", plan.method.name,
                     plan.automatic ? summary(*plan.automatic) + ", " : "", plan.duration);
}

}  // namespace rubato::analysis
