#include <rubato/analysis/parameter_dependence.hpp>
#include <rubato/model/fields/quantity_visitor.hpp>
#include <rubato/model/load_laws.hpp>
#include <rubato/numerics/formula.hpp>

#include <algorithm>

namespace rubato::analysis {

ParameterDependence::ParameterDependence(const model::StudyDescription& study, const numerics::Parameters& values,
                                         const std::vector<std::size_t>& fixed)
    : study_(study),
      values_(values),
      formula_uses_(values.size()),
      model_uses_(values.size()),
      in_angular_frequency_(values.size()),
      in_frequency_(values.size()) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::find(fixed.begin(), fixed.end(), i) == fixed.end()) formula_uses_[i] = used(study.parameters[i].value);
  for (auto& uses : role_uses_) uses.resize(values.size());
  model::for_each_quantity(study.model, [&](const model::Quantity& quantity, Role role, bool of_time) {
    for (const std::size_t place : used(quantity, of_time)) {
      model_uses_[place] = true;
      if (role != Role::none) role_uses_[static_cast<std::size_t>(role)][place] = true;
    }
  });
  for (const auto& load : model::load_laws(study.model)) {
    const auto* harmonic = std::get_if<model::HarmonicDescription>(load.law);
    if (!harmonic) continue;
    auto& uses = harmonic->frequency_in_hertz ? in_frequency_ : in_angular_frequency_;
    for (const std::size_t place : used(harmonic->angular_frequency)) uses[place] = true;
  }
}

std::vector<std::size_t> ParameterDependence::used(const model::Quantity& quantity, bool of_time) const {
  if (quantity.expression.empty()) return {};
  try {
    // Formulas of laws may use what they see, beside t.
    return numerics::parameters_used(quantity.expression, values_, of_time,
                                     of_time ? std::vector<std::string>{"u", "rate"} : std::vector<std::string>{});
  } catch (const InvalidInput& fault) {
    throw InvalidInput(quantity.where, fault.message());
  }
}

std::vector<bool> ParameterDependence::reached_by(std::size_t parameter) const {
  std::vector<bool> reached(formula_uses_.size());
  reached[parameter] = true;
  // A formula uses parameters before it only, so one pass in order follows every chain.
  for (std::size_t i = parameter + 1; i < reached.size(); ++i)
    for (const std::size_t place : formula_uses_[i])
      if (reached[place]) reached[i] = true;
  return reached;
}

bool ParameterDependence::reaches(std::size_t parameter, Role role) const {
  const auto reached = reached_by(parameter);
  const auto& uses = role_uses_[static_cast<std::size_t>(role)];
  for (std::size_t i = 0; i < reached.size(); ++i)
    if (reached[i] && uses[i]) return true;
  return false;
}

bool ParameterDependence::reaches_anything(std::size_t parameter) const {
  return reaches(parameter, Role::structure) || reaches(parameter, Role::load) || reaches(parameter, Role::frequency) ||
         reaches(parameter, Role::limit);
}

bool ParameterDependence::reaches_model(std::size_t parameter) const {
  const auto reached = reached_by(parameter);
  for (std::size_t i = 0; i < reached.size(); ++i)
    if (reached[i] && model_uses_[i]) return true;
  return false;
}

std::vector<std::size_t> ParameterDependence::followers(std::size_t parameter) const {
  const auto reached = reached_by(parameter);
  std::vector<std::size_t> places;
  for (std::size_t i = parameter + 1; i < reached.size(); ++i)
    if (reached[i]) places.push_back(i);
  return places;
}

bool ParameterDependence::follows(const model::Quantity& quantity, std::size_t parameter) const {
  const auto reached = reached_by(parameter);
  const auto places = used(quantity);
  return std::any_of(places.begin(), places.end(), [&](std::size_t place) { return reached[place]; });
}

bool ParameterDependence::has_formula(std::size_t parameter) const { return !formula_uses_[parameter].empty(); }

std::vector<std::size_t> ParameterDependence::in_frequencies() const {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < values_.size(); ++i)
    if (in_angular_frequency_[i] || in_frequency_[i]) places.push_back(i);
  return places;
}

bool ParameterDependence::is_in_hertz(std::size_t parameter) const {
  return in_frequency_[parameter] && !in_angular_frequency_[parameter];
}

}  // namespace rubato::analysis
