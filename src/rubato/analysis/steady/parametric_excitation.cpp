#include <rubato/analysis/steady/parametric_excitation.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/add_load.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::analysis {

system::AssembledModel build_structure(const model::StudyDescription& study, const numerics::Parameters& values) {
  return system::assemble_with_loads(model::build(study.model, values, model::NegativeLoad::zero));
}

ParametricExcitation::ParametricExcitation(const StudyInput& input, const ParameterDependence& dependence,
                                           std::vector<std::size_t> line, std::size_t point)
    : input_(input),
      dependence_(dependence),
      line_(std::move(line)),
      followers_(dependence.followers(point)),
      point_(point),
      named_(input.parameters) {
  for (const auto& [name, value] : input.parameters) {
    names_.push_back(name);
    values_.push_back(value);
  }
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (!dependence.has_formula(i)) continue;
    const std::vector<std::string> before(names_.begin(), names_.begin() + static_cast<std::ptrdiff_t>(i));
    formulas_.emplace_back(i, numerics::Formula(input.study.parameters[i].value.expression, {}, false, before));
  }
  for (const auto& law : model::load_laws(input.study.model)) laws_.push_back(law_of(law));
  for (const auto& slider : input.study.model.sliders)
    if (!slider.is_law() && !input.kind.is_constrained())  // those of a mechanism are laws
      limits_.push_back({value_of(slider.friction_coefficient), value_of(slider.normal_load),
                         fmt::format("slider \"{}\"", slider.name)});
}

ParametricExcitation::Value ParametricExcitation::value_of(const model::Quantity& quantity) {
  Value value;
  value.quantity = &quantity;
  value.now = quantity.value;
  if (quantity.expression.empty()) return value;
  value.formula.emplace(quantity.expression, numerics::Parameters{}, false, names_);
  value.follows_point = dependence_.follows(quantity, point_);
  return value;
}

ParametricExcitation::Law ParametricExcitation::law_of(const model::LoadLaw& description) {
  Law law;
  law.derivative = description.derivative;
  law.part = description.part;
  if (const auto* harmonic = std::get_if<model::HarmonicDescription>(description.law)) {
    law.amplitude = value_of(harmonic->amplitude);
    law.frequency = value_of(harmonic->angular_frequency);
    law.phase = value_of(harmonic->phase);
    law.frequency_factor = harmonic->frequency_in_hertz ? 2.0 * std::numbers::pi : 1.0;
  } else {  // a formula without t: the plan has refused all others
    law.amplitude = value_of(std::get<model::TimeFormulaDescription>(*description.law).formula);
  }
  return law;
}

void ParametricExcitation::take_line(std::span<const double> values, const system::AssembledModel& structure) {
  for (std::size_t i = 0; i < line_.size(); ++i) values_[line_[i]] = values[i];
  structure_ = &structure;
  for (Law& law : laws_) law.scales = law.derivative > 0;
  for (const auto& load : structure.loads)
    if (load.derivative > 0) laws_[static_cast<std::size_t>(load.law)].scales = true;
  is_new_line_ = true;
}

const numerics::Parameters& ParametricExcitation::parameters_at(std::span<const double> line, double point) {
  for (std::size_t i = 0; i < line_.size(); ++i) values_[line_[i]] = line[i];
  values_[point_] = point;
  is_new_line_ = true;
  refresh_parameters();
  for (std::size_t i = 0; i < values_.size(); ++i) named_[i].second = values_[i];
  return named_;
}

void ParametricExcitation::evaluate(Value& value, const std::string& part, const char* key) const {
  if (!value.formula || !(is_new_line_ || value.follows_point)) return;
  value.now = (*value.formula)(0.0, values_);
  if (std::isfinite(value.now)) return;
  throw InvalidInput(value.quantity->where,
                     fmt::format("{}: {} is {} (from \"{}\"); give a finite number", part, key,
                                 std::isnan(value.now) ? std::abs(value.now) : value.now, value.quantity->expression));
}

void ParametricExcitation::refresh_parameters() {
  for (auto& [place, formula] : formulas_) {
    if (!is_new_line_ && !std::binary_search(followers_.begin(), followers_.end(), place)) continue;
    values_[place] = formula(0.0, values_);
    if (std::isfinite(values_[place])) continue;
    const auto& parameter = input_.study.parameters[place];
    throw InvalidInput(parameter.value.where,
                       fmt::format("parameter \"{}\" is {} (from \"{}\"); give a finite number", parameter.name,
                                   std::isnan(values_[place]) ? std::abs(values_[place]) : values_[place],
                                   parameter.value.expression));
  }
}

// Returns whether amplitudes have changed.
bool ParametricExcitation::refresh_laws() {
  bool has_changed = is_new_line_;
  for (Law& law : laws_) {
    evaluate(law.amplitude, law.part, "amplitude");
    evaluate(law.phase, law.part, "phase");
    evaluate(law.frequency, law.part, law.frequency_factor == 1.0 ? "angular_frequency" : "frequency");
    law.now = {law.amplitude.now, law.frequency_factor * law.frequency.now, law.phase.now};
    if (!(law.now.angular_frequency >= 0.0))
      throw InvalidInput(law.frequency.quantity->where,
                         fmt::format("{}: its frequency must not be negative, got {}", law.part, law.frequency.now));
    has_changed = has_changed || law.amplitude.follows_point || law.phase.follows_point || law.scales;
  }
  return has_changed;
}

// Whether every frequency is the multiple of one fundamental that it was at the point before.
bool ParametricExcitation::orders_hold() const {
  const auto moving = std::find_if(laws_.begin(), laws_.end(), [](const Law& law) { return law.order > 0; });
  if (moving == laws_.end()) return false;
  const double fundamental = moving->now.angular_frequency / moving->order;
  return fundamental > 0.0 && std::all_of(laws_.begin(), laws_.end(), [&](const Law& law) {
           const double w = law.now.angular_frequency;
           return law.order == (w > 0.0 ? system::order_over(w, fundamental) : 0);
         });
}

void ParametricExcitation::find_orders() {
  std::vector<double> frequencies;
  for (const Law& law : laws_)
    if (law.now.angular_frequency > 0.0) frequencies.push_back(law.now.angular_frequency);
  if (frequencies.empty()) throw InvalidInput("no load has a frequency above zero: nothing repeats");
  has_period_ = needs_period_ || system::common_fundamental(frequencies).has_value();
  if (!has_period_) {
    for (Law& law : laws_) law.order = 0;
    return;
  }
  const double fundamental = system::fundamental_of(frequencies);
  for (Law& law : laws_) {
    const double w = law.now.angular_frequency;
    law.order = w > 0.0 ? system::order_over(w, fundamental) : 0;
  }
}

double ParametricExcitation::window() const {
  constexpr double beats = 4.0, periods = 30.0;
  double slowest = HUGE_VAL, nearest = HUGE_VAL;
  for (const Law& law : laws_) {
    const double w = law.now.angular_frequency;
    if (!(w > 0.0)) continue;
    slowest = std::min(slowest, w);
    for (const Law& other : laws_) {
      const double beat = std::abs(w - other.now.angular_frequency);
      if (other.now.angular_frequency > 0.0 && beat > 1e-10 * w) nearest = std::min(nearest, beat);
    }
  }
  return 2.0 * std::numbers::pi * std::max(beats / nearest, periods / slowest);
}

void ParametricExcitation::fill(system::Excitation& out) const {
  out.constant.setZero(structure_->system.size());
  out.harmonics.clear();
  for (const auto& load : structure_->loads) {
    if (load.law < 0) {
      system::add_load(load.term, std::get<model::HarmonicLaw>(load.term.law), 0, out);
      continue;
    }
    const Law& law = laws_[static_cast<std::size_t>(load.law)];
    system::add_load(load.term, model::derivative(law.now, law.derivative + load.derivative), law.order, out);
  }
}

void ParametricExcitation::refresh_limits(system::Excitation& out) {
  if (is_new_line_) out.limits.setZero(static_cast<Index>(limits_.size()));
  negative_loads_.clear();
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    Limit& limit = limits_[i];
    evaluate(limit.coefficient, limit.part, "friction_coefficient");
    evaluate(limit.load, limit.part, "normal_load");
    if (!(limit.coefficient.now >= 0.0))
      throw InvalidInput(
          limit.coefficient.quantity->where,
          fmt::format("{}: friction_coefficient must not be negative, got {}", limit.part, limit.coefficient.now));
    if (limit.load.now < 0.0) negative_loads_.push_back({i, limit.load.now});
    out.limits[static_cast<Index>(i)] = limit.coefficient.now * std::max(limit.load.now, 0.0);
  }
}

void ParametricExcitation::take_point(double value, system::Excitation& out) {
  values_[point_] = value;
  refresh_parameters();
  const bool amplitudes_have_changed = refresh_laws();
  const bool same_orders = !is_new_line_ && orders_hold();
  if (!same_orders) find_orders();
  refresh_limits(out);
  if (!has_period_) {
    out.angular_frequency = HUGE_VAL;
    for (const Law& law : laws_)
      if (law.now.angular_frequency > 0.0)
        out.angular_frequency = std::min(out.angular_frequency, law.now.angular_frequency);
    return;
  }
  if (amplitudes_have_changed || !same_orders) fill(out);
  const auto moving = std::find_if(laws_.begin(), laws_.end(), [](const Law& law) { return law.order > 0; });
  out.angular_frequency = moving->now.angular_frequency / moving->order;
  is_new_line_ = false;
}

}  // namespace rubato::analysis
