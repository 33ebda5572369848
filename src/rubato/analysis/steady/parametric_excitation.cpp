#include <rubato/analysis/steady/parametric_excitation.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::analysis {

ParametricStructure build_structure(const model::StudyDescription& study, const numerics::Parameters& values) {
  const model::Model model = model::build(study.model, values, model::NegativeLoad::zero);
  ParametricStructure structure{system::assemble(model), {}, {}};
  for (const auto& force : model.forces) structure.force_rows.push_back(force.coordinate);
  if (model.base_motion) structure.inertia = structure.system.mass() * model.base_motion->direction;
  return structure;
}

ParametricExcitation::ParametricExcitation(const StudyInput& input, const ParameterDependence& dependence,
                                           std::vector<std::size_t> line, std::size_t point)
    : input_(input),
      dependence_(dependence),
      line_(std::move(line)),
      followers_(dependence.followers(point)),
      point_(point),
      named_(input.parameters) {
  for (const auto& [name, value] : input.parameters) values_.push_back(value);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (!dependence.has_formula(i)) continue;
    const numerics::Parameters before(input.parameters.begin(),
                                      input.parameters.begin() + static_cast<std::ptrdiff_t>(i));
    formulas_.emplace_back(i,
                           numerics::BoundFormula(input.study.parameters[i].value.expression, before, values_.data()));
  }
  const auto& model = input.study.model;
  for (std::size_t i = 0; i < model.forces.size(); ++i) {
    const std::string part = fmt::format("the force on \"{}\"", model.forces[i].on);
    loads_.push_back(load_of(std::get<model::HarmonicDescription>(model.forces[i].law), part));
    loads_.back().force = i;
  }
  if (model.base_motion) {
    loads_.push_back(load_of(std::get<model::HarmonicDescription>(model.base_motion->law), "[base_motion]"));
    loads_.back().base = model.base_motion->of;
  }
  for (const auto& slider : model.sliders)
    limits_.push_back({value_of(slider.friction_coefficient), value_of(slider.normal_load),
                       fmt::format("slider \"{}\"", slider.name)});
}

ParametricExcitation::Value ParametricExcitation::value_of(const model::Quantity& quantity) {
  Value value;
  value.quantity = &quantity;
  value.now = quantity.value;
  if (quantity.expression.empty()) return value;
  value.formula.emplace(quantity.expression, input_.parameters, values_.data());
  value.follows_point = dependence_.follows(quantity, point_);
  return value;
}

ParametricExcitation::Load ParametricExcitation::load_of(const model::HarmonicDescription& law,
                                                         const std::string& part) {
  Load load;
  load.amplitude = value_of(law.amplitude);
  load.frequency = value_of(law.angular_frequency);
  load.phase = value_of(law.phase);
  load.frequency_factor = law.frequency_in_hertz ? 2.0 * std::numbers::pi : 1.0;
  load.part = part;
  return load;
}

void ParametricExcitation::take_line(std::span<const double> values, const ParametricStructure& structure) {
  for (std::size_t i = 0; i < line_.size(); ++i) values_[line_[i]] = values[i];
  structure_ = &structure;
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
  value.now = (*value.formula)();
  if (std::isfinite(value.now)) return;
  throw InvalidInput(value.quantity->where,
                     fmt::format("{}: {} is {} (from \"{}\"); give a finite number", part, key,
                                 std::isnan(value.now) ? std::abs(value.now) : value.now, value.quantity->expression));
}

void ParametricExcitation::refresh_parameters() {
  for (auto& [place, formula] : formulas_) {
    if (!is_new_line_ && !std::binary_search(followers_.begin(), followers_.end(), place)) continue;
    values_[place] = formula();
    if (std::isfinite(values_[place])) continue;
    const auto& parameter = input_.study.parameters[place];
    throw InvalidInput(parameter.value.where,
                       fmt::format("parameter \"{}\" is {} (from \"{}\"); give a finite number", parameter.name,
                                   std::isnan(values_[place]) ? std::abs(values_[place]) : values_[place],
                                   parameter.value.expression));
  }
}

// Returns whether amplitudes have changed.
bool ParametricExcitation::refresh_loads() {
  bool has_changed = is_new_line_;
  for (Load& load : loads_) {
    evaluate(load.amplitude, load.part, "amplitude");
    evaluate(load.phase, load.part, "phase");
    evaluate(load.frequency, load.part, load.frequency_factor == 1.0 ? "angular_frequency" : "frequency");
    load.angular_frequency = load.frequency_factor * load.frequency.now;
    if (!(load.angular_frequency >= 0.0))
      throw InvalidInput(load.frequency.quantity->where,
                         fmt::format("{}: its frequency must not be negative, got {}", load.part, load.frequency.now));
    const bool scales = load.base && *load.base != model::BaseMotionDescription::Of::acceleration;
    if (!is_new_line_ && !load.amplitude.follows_point && !load.phase.follows_point && !scales) continue;
    has_changed = true;
    const double omega = load.angular_frequency;
    double amplitude = load.amplitude.now, phase = load.phase.now;
    if (scales && *load.base == model::BaseMotionDescription::Of::displacement) amplitude *= -omega * omega;
    if (scales && *load.base == model::BaseMotionDescription::Of::velocity) {
      amplitude *= omega;
      phase += 0.5 * std::numbers::pi;
    }
    load.complex_amplitude = {amplitude * std::cos(phase), amplitude * std::sin(phase)};
  }
  return has_changed;
}

// Whether every frequency is the multiple of one fundamental that it was at the point before.
bool ParametricExcitation::orders_hold() const {
  const auto moving = std::find_if(loads_.begin(), loads_.end(), [](const Load& load) { return load.order > 0; });
  if (moving == loads_.end()) return false;
  const double fundamental = moving->angular_frequency / moving->order;
  return fundamental > 0.0 && std::all_of(loads_.begin(), loads_.end(), [&](const Load& load) {
           return load.order ==
                  (load.angular_frequency > 0.0 ? integrate::order_over(load.angular_frequency, fundamental) : 0);
         });
}

void ParametricExcitation::find_orders() {
  std::vector<double> frequencies;
  for (const Load& load : loads_)
    if (load.angular_frequency > 0.0) frequencies.push_back(load.angular_frequency);
  if (frequencies.empty()) throw InvalidInput("no load has a frequency above zero: nothing repeats");
  has_period_ = needs_period_ || integrate::common_fundamental(frequencies).has_value();
  if (!has_period_) {
    for (Load& load : loads_) load.order = 0;
    return;
  }
  const double fundamental = integrate::fundamental_of(frequencies);
  for (Load& load : loads_)
    load.order = load.angular_frequency > 0.0 ? integrate::order_over(load.angular_frequency, fundamental) : 0;
}

double ParametricExcitation::window() const {
  constexpr double beats = 4.0, periods = 30.0;
  double slowest = HUGE_VAL, nearest = HUGE_VAL;
  for (const Load& load : loads_) {
    if (!(load.angular_frequency > 0.0)) continue;
    slowest = std::min(slowest, load.angular_frequency);
    for (const Load& other : loads_) {
      const double beat = std::abs(load.angular_frequency - other.angular_frequency);
      if (other.angular_frequency > 0.0 && beat > 1e-10 * load.angular_frequency) nearest = std::min(nearest, beat);
    }
  }
  return 2.0 * std::numbers::pi * std::max(beats / nearest, periods / slowest);
}

void ParametricExcitation::fill(integrate::Excitation& out) const {
  const Index n = structure_->system.size();
  out.constant.setZero(n);
  out.harmonics.clear();
  for (const Load& load : loads_) {
    integrate::ComplexVector* amplitude = nullptr;
    if (load.order > 0) {
      auto place = std::lower_bound(out.harmonics.begin(), out.harmonics.end(), load.order,
                                    [](const integrate::LoadHarmonic& h, int order) { return h.order < order; });
      if (place == out.harmonics.end() || place->order != load.order)
        place = out.harmonics.insert(place, {load.order, integrate::ComplexVector::Zero(n)});
      amplitude = &place->amplitude;
    }
    const auto add = [&](Index row, double weight) {
      if (amplitude)
        (*amplitude)[row] += weight * load.complex_amplitude;
      else
        out.constant[row] += weight * load.complex_amplitude.real();
    };
    if (!load.base) {
      add(structure_->force_rows[load.force], 1.0);
      continue;
    }
    for (Index row = 0; row < n; ++row)
      if (structure_->inertia[row] != 0.0) add(row, -structure_->inertia[row]);
  }
}

void ParametricExcitation::refresh_limits(integrate::Excitation& out) {
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

void ParametricExcitation::take_point(double value, integrate::Excitation& out) {
  values_[point_] = value;
  refresh_parameters();
  const bool amplitudes_have_changed = refresh_loads();
  const bool same_orders = !is_new_line_ && orders_hold();
  if (!same_orders) find_orders();
  refresh_limits(out);
  if (!has_period_) {
    const auto slower = [](const Load& a, const Load& b) {
      return (a.angular_frequency > 0.0 ? a.angular_frequency : HUGE_VAL) <
             (b.angular_frequency > 0.0 ? b.angular_frequency : HUGE_VAL);
    };
    out.angular_frequency = std::min_element(loads_.begin(), loads_.end(), slower)->angular_frequency;
    return;
  }
  if (amplitudes_have_changed || !same_orders) fill(out);
  const auto moving = std::find_if(loads_.begin(), loads_.end(), [](const Load& load) { return load.order > 0; });
  out.angular_frequency = moving->angular_frequency / moving->order;
  is_new_line_ = false;
}

}  // namespace rubato::analysis
