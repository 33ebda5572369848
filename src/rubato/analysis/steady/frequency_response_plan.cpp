#include <rubato/analysis/law_routes.hpp>
#include <rubato/analysis/steady/frequency_response_plan.hpp>
#include <rubato/analysis/steady/frequency_response_tables.hpp>
#include <rubato/analysis/steady/parametric_excitation.hpp>
#include <rubato/analysis/steady/steady_plan.hpp>
#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

namespace rubato::analysis {
namespace {

using Description = model::FrequencyResponseDescription;
using Role = ParameterDependence::Role;

Location place(const Location& wanted, const Location& otherwise) { return wanted.line > 0 ? wanted : otherwise; }

long whole_number(const model::Quantity& quantity, long least, const numerics::Parameters& parameters,
                  const std::string& what, const Location& otherwise) {
  const double value = model::evaluate(quantity, parameters, what);
  if (!(value >= static_cast<double>(least) && value <= 1e9) || value != std::floor(value))
    throw InvalidInput(place(quantity.where, otherwise),
                       fmt::format("{} must be a whole number of at least {}, got {}", what, least, value));
  return static_cast<long>(value);
}

std::vector<double> frequencies_of(const Description& description, const numerics::Parameters& parameters,
                                   const std::string& title, const Location& where) {
  const std::string key = title + (description.frequencies_in_hertz ? "frequency" : "angular_frequency");
  std::vector<double> values = values_of(description.frequencies, parameters, key, where);
  const auto place_of = [&](std::size_t i) {
    const auto& list = description.frequencies.list;
    return place(i < list.size() ? list[i].where : description.frequencies.where, where);
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] > 0.0)) throw InvalidInput(place_of(i), fmt::format("{} must be positive, got {}", key, values[i]));
    if (i > 0 && !(values[i] > values[i - 1]))
      throw InvalidInput(place_of(i), fmt::format("{} must rise, got {} after {}", key, values[i], values[i - 1]));
  }
  if (description.frequencies_in_hertz)
    for (double& value : values) value *= 2.0 * std::numbers::pi;
  return values;
}

/// @param reaches_model  whether what is assembled depends on a parameter
void plan_sweep(FrequencyResponsePlan& plan, const std::function<bool(std::size_t)>& reaches_model,
                const std::string& title) {
  const auto& dependence = plan.dependence;
  const auto taken = reserved_columns();
  for (std::size_t i = 0; i < plan.sweep.places().size(); ++i) {
    const std::size_t parameter = plan.sweep.places()[i];
    require_effect(dependence, parameter, {plan.sweep.names()[i], plan.sweep.where()[i]}, taken, "swept parameter",
                   title);
    plan.is_structural.push_back(reaches_model(parameter));
    plan.divides_lanes.push_back(plan.is_structural.back() || dependence.reaches(parameter, Role::frequency));
    plan.is_linear.push_back(plan.divides_lanes.back() || dependence.reaches(parameter, Role::load));
  }
  plan.structure_follows_point = reaches_model(plan.excitation);
}

void plan_memory(FrequencyResponsePlan& plan, const Description& description, const StudyInput& input,
                 const std::string& title, const Location& where) {
  using Start = Description::Start;
  using Direction = Description::Direction;
  plan.start = description.start == Start::unloaded   ? steady::SteadyStart::unloaded
               : description.start == Start::previous ? steady::SteadyStart::previous
                                                      : steady::SteadyStart::rest;
  if (description.start == Start::previous && plan.structure_follows_point)
    throw InvalidInput(
        place(description.start_where, where),
        fmt::format("{}start = \"previous\" needs a structure, gravity and directions of loads that stay; here "
                    "they change with \"{}\"",
                    title, input.parameters[plan.excitation].first));
  if (description.start == Start::rest && description.route == Description::Route::harmonic_balance)
    throw InvalidInput(place(description.start_where, where),
                       title +
                           "start = \"rest\" is what a march from the start ends with, which harmonic balance does not "
                           "know; take another solver, or start = \"unloaded\"");
  if (description.direction != Direction::up && description.start != Start::previous)
    throw InvalidInput(place(description.direction_where, where),
                       title +
                           "a direction matters only where a point remembers the one before; say start = "
                           "\"previous\", or leave direction out");
  plan.has_both_directions = description.direction == Direction::both;
  if (description.direction != Direction::down)
    for (std::size_t i = 0; i < plan.frequencies.size(); ++i) plan.steps.push_back({i, false});
  if (description.direction != Direction::up)
    for (std::size_t i = plan.frequencies.size(); i-- > 0;) plan.steps.push_back({i, true});
}

Route route_of(steady::SteadyRoute::Kind kind) {
  return kind == steady::SteadyRoute::Kind::periodic           ? Route::periodic
         : kind == steady::SteadyRoute::Kind::harmonic_balance ? Route::harmonic_balance
                                                               : Route::time_marching;
}

/// What is described, with the solver that is taken where none is named.
Description with_route(Description description, const StudyInput& input) {
  const bool is_named = description.route_where.line > 0;
  const auto parts = input.kind.nonlinear_parts();
  using Family = integrate::NonlinearPart::Family;
  const bool has_laws = input.kind.structure()
                            ? input.structure().has_laws()
                            : std::any_of(parts.begin(), parts.end(), [](const auto& part) {
                                return part.is_spring || (part.family != Family::stop && part.family != Family::lock);
                              });
  if (!is_named && description.route == Description::Route::periodic && has_laws)
    description.route = refusal(Route::harmonic_balance, input.kind) ? Description::Route::time_marching
                                                                     : Description::Route::harmonic_balance;
  return description;
}

void plan_route(FrequencyResponsePlan& plan, const Description& description, const StudyInput& input,
                const std::string& title, const Location& where) {
  const Route route = route_of(description.route);
  const auto reason = refusal(route, input.kind);
  if (reason) throw InvalidInput(place(description.route_where, where), title + *reason);
  if (const auto of_time = refusal_of_steady_response(input.kind)) throw InvalidInput(where, title + *of_time);
  plan.route.kind = description.route;
  if (description.tolerance) {
    plan.route.tolerance = model::evaluate(*description.tolerance, input.parameters, title + "tolerance");
    if (!(plan.route.tolerance > 0.0 && plan.route.tolerance < 1.0))
      throw InvalidInput(place(description.tolerance->where, where),
                         fmt::format("{}tolerance must lie between 0 and 1, got {}", title, plan.route.tolerance));
  }
  if (description.orders) {
    constexpr int most = steady::HarmonicBalanceOptions{}.most_harmonics;
    const Location& at = place(description.orders->where, where);
    if (description.route != Description::Route::harmonic_balance)
      throw InvalidInput(at, title + "\"orders\" goes with solver = \"harmonic_balance\" only");
    const long orders = whole_number(*description.orders, 1, input.parameters, title + "orders", where);
    if (orders > most) throw InvalidInput(at, fmt::format("{}orders reach to {}, got {}", title, most, orders));
    plan.route.orders = static_cast<int>(orders);
  }
  const auto refuse = [&](const Location& at, const char* key) {
    throw InvalidInput(place(at, where), fmt::format("{}\"{}\" goes with solver = \"time_marching\" only", title, key));
  };
  if (description.route != Description::Route::time_marching) {
    if (description.method) refuse(description.method->where, "method");
    if (description.steps_per_period) refuse(description.steps_per_period->where, "steps_per_period");
    if (description.max_periods) refuse(description.max_periods->where, "max_periods");
    return;
  }
  plan.route.method = method_of(description.method.value_or(model::MethodDescription{}), input.parameters);
  if (description.steps_per_period)
    plan.route.steps_per_period =
        whole_number(*description.steps_per_period, 4, input.parameters, title + "steps_per_period", where);
  if (description.max_periods)
    plan.route.max_periods = whole_number(*description.max_periods, 1, input.parameters, title + "max_periods", where);
}

void plan_request(FrequencyResponsePlan& plan, const Description& description, const StudyInput& input,
                  const std::string& title, const Location& where) {
  plan.observed = observed_or_all(description.observe, {input.kind.system(), input.kind.supports()});
  for (const auto& observed : plan.observed)
    if (!input.kind.is_constrained()) plan.request.observed.push_back({observed.first, observed.second, {}});
  plan.request.harmonics = {1};
  for (const auto& quantity : description.harmonics) {
    const long order = whole_number(quantity, 1, input.parameters, title + "harmonics", where);
    if (order > 1000)
      throw InvalidInput(place(quantity.where, where), fmt::format("{}harmonics reach to 1000, got {}", title, order));
    if (order == 1) plan.shows_first_parts = true;
    if (plan.route.orders > 0 && order > plan.route.orders)
      throw InvalidInput(place(quantity.where, where), fmt::format("{}harmonics names order {}, and orders = {} leaves "
                                                                   "it out",
                                                                   title, order, plan.route.orders));
    auto& orders = plan.request.harmonics;
    if (std::find(orders.begin(), orders.end(), order) == orders.end()) orders.push_back(static_cast<int>(order));
  }
}

void plan_waveforms(FrequencyResponsePlan& plan, const Description& description, const StudyInput& input,
                    const std::string& title, const Location& where) {
  plan.waveform_at.resize(plan.frequencies.size());
  if (!description.waveforms) return;
  const auto& waveforms = *description.waveforms;
  plan.waveform_points =
      static_cast<int>(whole_number(waveforms.points, 8, input.parameters, title + "waveforms: points", where));
  const double factor = description.frequencies_in_hertz ? 2.0 * std::numbers::pi : 1.0;
  const double low = plan.frequencies.front(), high = plan.frequencies.back();
  for (const double wanted : values_of(waveforms.at, input.parameters, title + "waveforms: at", waveforms.where)) {
    const double frequency = factor * wanted;
    if (!(frequency >= low * (1.0 - 1e-9) && frequency <= high * (1.0 + 1e-9)))
      throw InvalidInput(place(waveforms.at.where, where),
                         fmt::format("{}waveforms: at = {} lies outside the response from {} to {}", title, wanted,
                                     low / factor, high / factor));
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < plan.frequencies.size(); ++i)
      if (std::abs(plan.frequencies[i] - frequency) < std::abs(plan.frequencies[nearest] - frequency)) nearest = i;
    plan.waveform_at[nearest] = true;
  }
}

/// One of the first and last points can be made at least; which others can is judged as they are reached.
void require_ends(FrequencyResponsePlan& plan, const StudyInput& input, const std::string& title,
                  const Location& where) {
  ParametricExcitation at(input, plan.dependence, plan.sweep.places(), plan.excitation);
  if (plan.may_lack_period(input)) at.allow_no_period();
  std::vector<double> values(plan.sweep.names().size());
  Possibility possibility(title, where);
  for (const long line : {0L, plan.sweep.lines() - 1})
    for (const double frequency : {plan.frequencies.front(), plan.frequencies.back()})
      possibility.attempt([&] {
        plan.sweep.values(line, values);
        const double point = plan.excitation_factor * frequency;
        const auto model =
            std::make_shared<const SteadyModel>(build_steady_model(input.study, at.parameters_at(values, point)));
        system::Excitation excitation;
        at.take_line(values, model->assembled);
        at.take_point(point, excitation);
        if (std::abs(excitation.angular_frequency - frequency) > 1e-9 * frequency) plan.has_other_fundamental = true;
        if (at.has_period() && !excitation.harmonics.empty())
          plan.route.linear.highest =
              std::max(plan.route.linear.highest, excitation.harmonics.back().order * excitation.angular_frequency);
        if (!model->about)
          plan.negative_stiffness.look_at(model->system().stuck_stiffness(),
                                          fmt::format("{} = {:.6g}", input.parameters[plan.excitation].first, point));
        if (model->about && !plan.about) plan.about = model;
      });
  possibility.require();
}

}  // namespace

std::size_t FrequencyResponsePlan::steps_a_piece() const {
  constexpr std::size_t piece = 256;
  return start == steady::SteadyStart::previous ? steps.size() : std::min(piece, steps.size());
}

FrequencyResponsePlan plan_frequency_response(const std::string& name, const Location& where,
                                              const Description& described, const StudyInput& input) {
  const std::string title = "analysis \"" + name + "\": ";
  require_about(described.about_equilibrium, input, where, title);
  const Description description = with_route(described, input);
  require_harmonic_loads(input, where, title);
  Sweep sweep(description.sweep, place(description.sweep_where, where), input, title);
  const std::size_t excitation = excitation_parameter({description.excitation, description.excitation_where},
                                                      {sweep.places(), sweep.where()}, input, title, where);
  std::vector<std::size_t> varied = sweep.places();
  varied.push_back(excitation);
  FrequencyResponsePlan plan{frequencies_of(description, input.parameters, title, where), excitation, 1.0,
                             std::move(sweep), dependence_of(input, std::move(varied))};
  plan.is_in_hertz = description.frequencies_in_hertz;
  if (plan.dependence.is_in_hertz(excitation)) plan.excitation_factor = 0.5 / std::numbers::pi;
  std::vector<std::size_t> all = plan.sweep.places();
  all.push_back(excitation);
  plan_sweep(plan, model_dependence(input, plan.dependence, std::move(all)), title);
  plan_memory(plan, description, input, title, where);
  plan_route(plan, description, input, title, where);
  plan_request(plan, description, input, title, where);
  plan_waveforms(plan, description, input, title, where);
  require_ends(plan, input, title, where);
  std::vector<std::pair<std::size_t, std::string>> given{{excitation, "the list of frequencies"}};
  for (const std::size_t place : plan.sweep.places()) given.emplace_back(place, "the sweep");
  plan.warnings = warn_of_settings(input, given);
  warn_of_reduction(input, plan.frequencies.back(), plan.warnings);
  if (std::string told = plan.negative_stiffness.warning(); !told.empty()) plan.warnings.push_back(std::move(told));
  if (plan.about) {
    plan.request = plan.about->request(plan.observed, plan.request);
    const auto& told = plan.about->about->warnings();
    plan.warnings.insert(plan.warnings.end(), told.begin(), told.end());
  }
  plan.route.linear.points = static_cast<Index>(plan.frequencies.size());
  return plan;
}

}  // namespace rubato::analysis
