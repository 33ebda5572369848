#include <rubato/analysis/as_printed.hpp>
#include <rubato/analysis/law_routes.hpp>
#include <rubato/analysis/method_study_plan.hpp>
#include <rubato/integrate/catalogue.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace rubato::analysis {
namespace {

using integrate::Method;

constexpr double most_ladder_steps = 1e6;  // a run of the finest step takes a tenth of a second

double positive(const model::Quantity& quantity, const numerics::Parameters& parameters, const std::string& what) {
  const double value = model::evaluate(quantity, parameters, what);
  if (!(value > 0.0)) throw InvalidInput(quantity.where, fmt::format("{} must be positive, got {}", what, value));
  return value;
}

/// The order of a formula with its numbers: the alpha family has order 2 for one gamma only.
int order_of(const Method& method, int order_by_name) {
  const auto* alpha = std::get_if<integrate::GeneralizedAlpha>(&method.formula);
  if (!alpha) return order_by_name;
  return std::abs(alpha->gamma - (0.5 - alpha->alpha_m + alpha->alpha_f)) < 1e-12 ? 2 : 1;
}

/// NAME, or NAME(parameter=value,...) where the study compares a method with itself.
std::string label_of(const model::MethodDescription& description, const numerics::Parameters& parameters) {
  std::string values;
  for (const auto& [key, quantity] : description.parameters)
    values += fmt::format("{}{}={:.6g}", values.empty() ? "" : ";", key, model::evaluate(quantity, parameters, key));
  return values.empty() ? description.name : fmt::format("{}({})", description.name, values);
}

void take_listed_methods(MethodStudyPlan& plan, const std::string& title, const model::MethodStudyDescription& study,
                         const integrate::SystemKind& kind, const numerics::Parameters& parameters) {
  for (const auto& description : study.methods) {
    Method method = method_of(description, parameters);
    if (std::holds_alternative<integrate::Exact>(method.formula))
      throw InvalidInput(description.where,
                         title + "the method exact takes no step; it is what the others are compared with");
    const double limit = kind.marches().stability_of(method).step;
    if (limit == 0.0)
      throw InvalidInput(description.where, fmt::format("{}{} has no stable step on this model", title, method.name));
    if (plan.step > limit)
      throw InvalidInput(description.where, fmt::format("{}{} is stable up to the step {:.6g} s on this model, the "
                                                        "study takes {} s",
                                                        title, method.name, limit, plan.step));
    const auto repeats = std::count_if(study.methods.begin(), study.methods.end(),
                                       [&](const auto& other) { return other.name == description.name; });
    if (repeats > 1) method.name = label_of(description, parameters);
    const auto names = plan.names();
    if (std::find(names.begin(), names.end(), method.name) != names.end())
      throw InvalidInput(description.where, fmt::format("{}the method {} is listed twice", title, method.name));
    plan.orders.push_back(order_of(method, integrate::find_method(description.name).order));
    plan.methods.push_back(std::move(method));
  }
}

void take_all_methods(MethodStudyPlan& plan, const integrate::SystemKind& kind) {
  for (const auto& info : integrate::catalogue()) {
    const bool needs_values = std::any_of(info.parameters.begin(), info.parameters.end(),
                                          [](const auto& parameter) { return std::isnan(parameter.default_value); });
    if (needs_values || info.name == "exact" || (info.name == "exponential" && kind.system().size() > 500)) continue;
    Method method = integrate::make_method(info.name);
    if (plan.step > kind.marches().stability_of(method).step) {
      plan.left_out.push_back(info.name);
      continue;
    }
    plan.methods.push_back(std::move(method));
    plan.orders.push_back(info.order);
  }
}

bool has_harmonic_loads(const integrate::SystemKind& kind) {
  bool are_harmonic = true;
  kind.for_each_time_law([&](const model::TimeLaw& law) {
    are_harmonic = are_harmonic && std::holds_alternative<model::HarmonicLaw>(law);
  });
  return are_harmonic;
}

}  // namespace

integrate::MarchPlan march_plan_of(const integrate::Method& method, const integrate::SystemKind& kind, double step,
                                   double duration) {
  integrate::MarchPlan plan;
  plan.method = method;
  plan.start = kind.start();
  plan.step = step;
  plan.duration = duration;
  return plan;
}

MethodStudyPlan plan_method_study(const std::string& name, const Location& where,
                                  const model::MethodStudyDescription& study, const integrate::SystemKind& kind,
                                  const numerics::Parameters& parameters) {
  const std::string title = "analysis \"" + name + "\": ";
  if (const auto reason = refusal(Route::method_study, kind)) throw InvalidInput(where, title + *reason);
  if (!has_harmonic_loads(kind))
    throw InvalidInput(where, title + "a method study needs harmonic loads, whose response has a closed form");
  try {
    (void)kind.marches().flow(march_plan_of(integrate::make_method("exact"), kind, 0.0, 0.0));
    if (study.as_printed) require_model_as_printed(kind);
  } catch (const InvalidInput& fault) {
    throw InvalidInput(where, title + fault.message());
  }
  MethodStudyPlan plan;
  plan.as_printed = study.as_printed;
  plan.step = positive(study.step, parameters, title + "step");
  plan.duration = positive(study.duration, parameters, title + "duration");
  const double count = plan.duration / plan.step;
  if (!(count >= 1.0 && count <= most_ladder_steps))
    throw InvalidInput(study.step.where, fmt::format("{}{} steps; take from 1 to 1e6", title, count));
  if (std::abs(count - std::round(count)) > 1e-9 * count)
    throw InvalidInput(study.step.where, fmt::format("{}the duration {} s must be a multiple of the step {} s", title,
                                                     plan.duration, plan.step));
  plan.observed = study.observe ? observed_of(*study.observe, {kind.system(), kind.supports()})
                                : every_coordinate(kind.system()).front();
  if (study.methods.empty())
    take_all_methods(plan, kind);
  else
    take_listed_methods(plan, title, study, kind, parameters);
  for (const auto& quantity : study.ladder) {
    const double h = positive(quantity, parameters, title + "ladder");
    if (h > plan.duration || plan.duration / h > 1e7)
      throw InvalidInput(quantity.where,
                         fmt::format("{}ladder: {} s makes {} steps; take from 1 to 1e7", title, h, plan.duration / h));
    plan.ladder.push_back(h);
  }
  std::sort(plan.ladder.begin(), plan.ladder.end(), std::greater<>());
  if (plan.ladder.empty())
    for (int k = 5; k >= -8; --k) {
      const double h = plan.step * std::pow(2.0, k);
      if (plan.duration / h >= 8.0 && plan.duration / h <= most_ladder_steps) plan.ladder.push_back(h);
    }
  return plan;
}

}  // namespace rubato::analysis
