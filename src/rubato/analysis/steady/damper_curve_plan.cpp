#include <rubato/analysis/law_routes.hpp>
#include <rubato/analysis/steady/damper_curve_plan.hpp>
#include <rubato/analysis/steady/damper_curve_tables.hpp>
#include <rubato/analysis/steady/parametric_excitation.hpp>
#include <rubato/analysis/steady/steady_plan.hpp>
#include <rubato/integrate/exact/exact_flow.hpp>

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
  if (const auto reason = refusal(Route::damper_curve, input.kind)) throw InvalidInput(where, title + *reason);
  plan.objective = description.objective;
  if (plan.objective == Description::Objective::dissipated && input.structure().slider_count() == 0)
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
  for (const auto& observed : plan.observed) plan.request.observed.push_back({observed.first, observed.second});
  plan.request.harmonics = {1};
  plan.request.rates = false;
}

/// One end of the curve can be made at least; what else can is judged as it is reached.
void require_ends(const DamperCurvePlan& plan, const StudyInput& input, const std::string& title,
                  const Location& where) {
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
          const system::AssembledModel structure = build_structure(input.study, at.parameters_at(values, point));
          system::Excitation excitation;
          at.take_line(values, structure);
          at.take_point(point, excitation);
        });
  possibility.require();
}

}  // namespace

DamperCurvePlan plan_damper_curve(const std::string& name, const Location& where, const Description& description,
                                  const StudyInput& input) {
  const std::string title = "analysis \"" + name + "\": ";
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
  if (plan.dependence.is_in_hertz(excitation)) plan.excitation_factor = 0.5 / std::numbers::pi;
  const auto columns = damper_curve_columns();
  require_effect(plan.dependence, parameter, {description.parameter, parameter_where}, columns, "parameter", title);
  for (std::size_t i = 0; i < plan.sweep.places().size(); ++i) {
    const std::size_t swept = plan.sweep.places()[i];
    require_effect(plan.dependence, swept, {plan.sweep.names()[i], plan.sweep.where()[i]}, columns, "swept parameter",
                   title);
    plan.is_structural.push_back(plan.dependence.reaches(swept, Role::structure));
  }
  plan.structure_follows_parameter = plan.dependence.reaches(parameter, Role::structure);
  plan.structure_follows_frequency = plan.dependence.reaches(excitation, Role::structure);
  plan.limits_follow_parameter = plan.structure_follows_parameter ||
                                 plan.dependence.reaches(parameter, Role::frequency) ||
                                 plan.dependence.reaches(parameter, Role::load);
  plan_range(plan, description, input, title, where);
  plan_frequencies(plan, description, input, title, where);
  plan_objective(plan, description, input, title, where);
  plan.has_optimum = description.optimum && plan.values.size() > 1;
  if (input.structure().size() > integrate::largest_exact)
    throw InvalidInput(
        where,
        fmt::format("{}damper curves are refined on exact periodic orbits, for up to {} coordinates; the model has "
                    "{}: reduce it, or sweep a frequency_response with solver = \"harmonic_balance\" over \"{}\"",
                    title, integrate::largest_exact, input.structure().size(), plan.parameter));
  require_ends(plan, input, title, where);
  std::vector<std::pair<std::size_t, std::string>> given{{excitation, "the range of frequencies"},
                                                         {parameter, "the range of the curve"}};
  for (const std::size_t swept : plan.sweep.places()) given.emplace_back(swept, "the sweep");
  plan.warnings = warn_of_settings(input, given);
  return plan;
}

}  // namespace rubato::analysis
