#include <rubato/analysis/law_routes.hpp>
#include <rubato/analysis/steady/damper_curve_plan.hpp>
#include <rubato/analysis/steady/damper_curve_tables.hpp>
#include <rubato/analysis/steady/parametric_excitation.hpp>
#include <rubato/analysis/steady/steady_plan.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/steady/linear/linear_limits.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::analysis {
namespace {

using Description = model::DamperCurveDescription;
using Role = ParameterDependence::Role;

Location place_or(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

/// The parameter that the curve is over, before those of the sweep.
std::size_t curve_parameter(const Description& description, const Sweep& sweep, const StudyInput& input,
                            const std::string& title, const Location& where) {
  const Location at = place_or(description.parameter_where, where);
  std::vector<std::string> known;
  for (const auto& parameter : input.parameters) known.push_back(parameter.first);
  const auto found = std::find(known.begin(), known.end(), description.parameter);
  if (found == known.end())
    throw InvalidInput(at, fmt::format("{}parameter names \"{}\", which is no parameter{}", title,
                                       description.parameter, suggestion(description.parameter, known)));
  for (std::size_t i = 0; i < sweep.names().size(); ++i)
    if (sweep.names()[i] == description.parameter)
      throw InvalidInput(sweep.where()[i],
                         fmt::format("{}the curve is over \"{}\", which cannot be swept at once; give "
                                     "its values as range",
                                     title, description.parameter));
  return static_cast<std::size_t>(found - known.begin());
}

void plan_range(DamperCurvePlan& plan, const Description& description, const StudyInput& input,
                const std::string& title, const Location& where) {
  plan.values = values_of(description.range, input.parameters, title + "range", where);
  for (std::size_t i = 1; i < plan.values.size(); ++i)
    if (!(plan.values[i] > plan.values[i - 1])) {
      const auto& list = description.range.list;
      throw InvalidInput(place_or(i < list.size() ? list[i].where : description.range.where, where),
                         fmt::format("{}range must rise, got {} after {}", title, plan.values[i], plan.values[i - 1]));
    }
}

void plan_frequencies(DamperCurvePlan& plan, const Description& description, const StudyInput& input,
                      const std::string& title, const Location& where) {
  const std::string key = title + (description.frequencies_in_hertz ? "frequency" : "angular_frequency");
  const Location at = place_or(description.frequencies.where, where);
  const double from = model::evaluate(description.frequencies.from, input.parameters, key + ": from");
  const double to = model::evaluate(description.frequencies.to, input.parameters, key + ": to");
  if (!(from > 0.0)) throw InvalidInput(at, fmt::format("{}: from must be positive, got {}", key, from));
  if (!(from < to))
    throw InvalidInput(at, fmt::format("{}: the range from {} to {} is {}", key, from, to,
                                       from == to ? "empty; give an end above its begin"
                                                  : fmt::format("reversed; write from = {}, to = {}", to, from)));
  if (description.has_frequency_points) {
    const double points = model::evaluate(description.frequencies.points, input.parameters, key + ": points");
    if (!(points >= 3.0 && points <= 1e6) || points != std::floor(points))
      throw InvalidInput(
          place_or(description.frequencies.points.where, where),
          fmt::format("{}: points, scanned for peaks, must be a whole number from 3 to a million, got {}", key,
                      points));
    plan.samples = static_cast<int>(points);
  }
  const double factor = description.frequencies_in_hertz ? 2.0 * std::numbers::pi : 1.0;
  plan.from = factor * from;
  plan.to = factor * to;
}

void plan_objective(DamperCurvePlan& plan, const Description& description, const StudyInput& input,
                    const std::string& title, const Location& where) {
  plan.objective = description.objective;
  if (plan.objective == Description::Objective::dissipated && input.study.model.sliders.empty() &&
      input.study.model.laws.empty() && input.study.model.contacts.empty())
    throw InvalidInput(place_or(description.objective_where, where),
                       title + "objective = \"dissipated\" needs sliders, and the model has none");
  plan.observed = observed_or_all(description.observe, {input.kind.system(), input.kind.supports()});
  if (!plan.observed.empty() && plan.observed.front().is_rotation != plan.observed.back().is_rotation) {
    if (description.observe)
      throw InvalidInput(where,
                         fmt::format("{}observe has \"{}\" [m] and \"{}\" [rad], and the largest amplitude of both "
                                     "means nothing; keep one kind",
                                     title, plan.observed.front().label, plan.observed.back().label));
    std::erase_if(plan.observed, [](const Observed& one) { return one.is_rotation; });
  }
  if (plan.observed.empty() && plan.objective == Description::Objective::amplitude)
    throw InvalidInput(where, title + "observe is empty: the curve needs an amplitude; name a coordinate");
  if (!input.kind.is_constrained())
    for (const auto& observed : plan.observed) plan.request.observed.push_back({observed.first, observed.second, {}});
  plan.request.harmonics = {1};
  plan.request.rates = false;
}

/// Why periodic orbits are not taken where no solver is named; empty: they are. Their price is that of the exact flow:
/// a piece for each swing of the fastest motion, each with products of the state's matrix.
std::string reason_for_balance(const DamperCurvePlan& plan, const StudyInput& input) {
  const auto& system = plan.system(input);
  if (const auto refused = refusal(Route::periodic, input.kind)) return *refused;
  if (system.has_laws()) return "periodic orbits do not take sliders and laws of mechanisms";
  if (system.size() > integrate::largest_exact)
    return fmt::format("periodic orbits go up to {} coordinates, the model has {}", integrate::largest_exact,
                       system.size());
  const Vector frequencies = steady::natural_frequencies(system);
  const double swings = frequencies.size() > 0 ? frequencies.maxCoeff() / plan.from : 0.0;
  const auto state = static_cast<double>(2 * system.size() + system.slider_count());
  constexpr double most_work = 2e6;
  if (std::max(1.0, swings) * state * state * state <= most_work) return {};
  return fmt::format("periodic orbits of {} coordinates that swing up to {:.0f} times in a period cost more",
                     system.size(), swings);
}

void plan_route(DamperCurvePlan& plan, const Description& description, const StudyInput& input,
                const std::string& title, const Location& where) {
  using Kind = steady::SteadyRoute::Kind;
  const auto& system = plan.system(input);
  const Location at = place_or(description.route_where, where);
  if (const auto of_time = refusal_of_steady_response(input.kind)) throw InvalidInput(where, title + *of_time);
  if (description.route) {
    plan.route.kind = *description.route;
    if (const auto reason = refusal(plan.is_truncated() ? Route::harmonic_balance : Route::periodic, input.kind))
      throw InvalidInput(at, title + *reason);
    if (!plan.is_truncated() && system.has_laws())
      throw InvalidInput(at, title +
                                 "periodic orbits do not take sliders and laws of mechanisms: take solver = "
                                 "\"harmonic_balance\"");
    if (!plan.is_truncated() && system.size() > integrate::largest_exact)
      throw InvalidInput(at, fmt::format("{}periodic orbits go up to {} coordinates, the model has {}: take solver = "
                                         "\"harmonic_balance\", or reduce the model",
                                         title, integrate::largest_exact, system.size()));
  } else {
    if (const auto reason = refusal(Route::damper_curve, input.kind)) throw InvalidInput(where, title + *reason);
    plan.chosen_for = reason_for_balance(plan, input);
    plan.route.kind = plan.chosen_for.empty() ? Kind::periodic : Kind::harmonic_balance;
  }
  if (description.tolerance && !plan.is_truncated())
    throw InvalidInput(place_or(description.tolerance->where, where),
                       title +
                           "\"tolerance\" goes with solver = \"harmonic_balance\", and periodic orbits are solved "
                           "to round-off: add that solver, or leave it out");
  if (!plan.is_truncated()) return;
  const bool has_laws = system.has_laws() || !system.stops().empty();
  plan.route.tolerance = has_laws ? 1e-3 : 1e-4;
  plan.noise = has_laws ? 1e-8 : 1e-11;
  if (!description.tolerance) return;
  plan.route.tolerance = model::evaluate(*description.tolerance, input.parameters, title + "tolerance");
  if (!(plan.route.tolerance > 0.0 && plan.route.tolerance < 1.0))
    throw InvalidInput(place_or(description.tolerance->where, where),
                       fmt::format("{}tolerance must lie between 0 and 1, got {}", title, plan.route.tolerance));
}

/// One end of the curve can be made at least; what else can is judged as it is reached.
void require_ends(DamperCurvePlan& plan, const StudyInput& input, const std::string& title, const Location& where) {
  std::vector<std::size_t> places = plan.sweep.places();
  places.push_back(plan.place);
  ParametricExcitation at(input, plan.dependence, places, plan.excitation);
  std::vector<double> values(places.size());
  Possibility possibility(title, where);
  for (const long line : {0L, plan.sweep.lines() - 1})
    for (const double value : {plan.values.front(), plan.values.back()})
      for (const double frequency : {plan.from, plan.to})
        possibility.attempt([&] {
          plan.sweep.values(line, {values.data(), values.size() - 1});
          values.back() = value;
          const double point = plan.excitation_factor * frequency;
          auto model =
              std::make_shared<const SteadyModel>(build_steady_model(input.study, at.parameters_at(values, point)));
          system::Excitation excitation;
          at.take_line(values, model->assembled);
          at.take_point(point, excitation);
          if (!excitation.harmonics.empty())
            plan.highest = std::max(plan.highest, excitation.harmonics.back().order * excitation.angular_frequency);
          if (!model->about)
            plan.negative_stiffness.look_at(model->system().stuck_stiffness(),
                                            fmt::format("{} = {:.6g}", plan.parameter, value));
          if (model->about && !plan.about) plan.about = std::move(model);
        });
  possibility.require();
}

}  // namespace

DamperCurvePlan plan_damper_curve(const std::string& name, const Location& where, const Description& description,
                                  const StudyInput& input) {
  const std::string title = "analysis \"" + name + "\": ";
  require_about(description.about_equilibrium, input, where, title);
  require_harmonic_loads(input, where, title);
  Sweep sweep(description.sweep, place_or(description.sweep_where, where), input, title);
  const std::size_t parameter = curve_parameter(description, sweep, input, title, where);
  const Location parameter_where = place_or(description.parameter_where, where);
  VariedParameters varied{sweep.places(), sweep.where()};
  varied.places.push_back(parameter);
  varied.where.push_back(parameter_where);
  const std::size_t excitation =
      excitation_parameter({description.excitation, description.excitation_where}, varied, input, title, where);
  varied.places.push_back(excitation);

  DamperCurvePlan plan{description.parameter,
                       parameter,
                       {},
                       0.0,
                       0.0,
                       17,
                       excitation,
                       1.0,
                       std::move(sweep),
                       dependence_of(input, varied.places)};
  plan.is_in_hertz = description.frequencies_in_hertz;
  if (plan.dependence.is_in_hertz(excitation)) plan.excitation_factor = 0.5 / std::numbers::pi;
  const auto columns = damper_curve_columns();
  const auto reaches_model = model_dependence(input, plan.dependence, varied.places);
  require_effect(plan.dependence, parameter, {description.parameter, parameter_where}, columns, "parameter", title);
  for (std::size_t i = 0; i < plan.sweep.places().size(); ++i) {
    const std::size_t swept = plan.sweep.places()[i];
    require_effect(plan.dependence, swept, {plan.sweep.names()[i], plan.sweep.where()[i]}, columns, "swept parameter",
                   title);
    plan.is_structural.push_back(reaches_model(swept));
  }
  plan.structure_follows_parameter = reaches_model(parameter);
  plan.structure_follows_frequency = reaches_model(excitation);
  plan.limits_follow_parameter = plan.structure_follows_parameter ||
                                 plan.dependence.reaches(parameter, Role::frequency) ||
                                 plan.dependence.reaches(parameter, Role::load);
  plan_range(plan, description, input, title, where);
  plan_frequencies(plan, description, input, title, where);
  plan_objective(plan, description, input, title, where);
  plan.has_optimum = description.optimum && plan.values.size() > 1;
  require_ends(plan, input, title, where);
  plan_route(plan, description, input, title, where);
  std::vector<std::pair<std::size_t, std::string>> given{{excitation, "the range of frequencies"},
                                                         {parameter, "the range of the curve"}};
  for (const std::size_t swept : plan.sweep.places()) given.emplace_back(swept, "the sweep");
  plan.warnings = warn_of_settings(input, given);
  warn_of_reduction(input, plan.highest, plan.warnings);
  if (std::string told = plan.negative_stiffness.warning(); !told.empty()) plan.warnings.push_back(std::move(told));
  if (plan.about) {
    plan.request = plan.about->request(plan.observed, plan.request);
    const auto& told = plan.about->about->warnings();
    plan.warnings.insert(plan.warnings.end(), told.begin(), told.end());
  }
  plan.route.linear.points = static_cast<Index>(plan.samples) * static_cast<Index>(plan.values.size());
  plan.route.linear.highest = plan.highest;
  return plan;
}

}  // namespace rubato::analysis
