#include <rubato/analysis/parameter_dependence.hpp>
#include <rubato/model/load_laws.hpp>
#include <rubato/numerics/formula.hpp>

#include <algorithm>

namespace rubato::analysis {
namespace {

using Role = ParameterDependence::Role;

/// Calls take(quantity, role, is_of_time) for every quantity of a law.
template <typename Take>
void visit_law(const model::TimeLawDescription& law, const Take& take) {
  if (const auto* harmonic = std::get_if<model::HarmonicDescription>(&law)) {
    take(harmonic->amplitude, Role::load, false);
    take(harmonic->phase, Role::load, false);
    take(harmonic->angular_frequency, Role::frequency, false);
  } else if (const auto* formula = std::get_if<model::TimeFormulaDescription>(&law)) {
    take(formula->formula, Role::load, true);
  }
}

template <typename Take>
void visit_structure(const model::StructureDescription& structure, const Take& take) {
  const auto take_all = [&](const auto& quantities) {
    for (const auto& quantity : quantities) take(quantity);
  };
  for (const auto& node : structure.nodes) {
    take_all(node.position);
    take_all(node.velocity);
    take_all(node.angular_velocity);
  }
  for (const auto& material : structure.materials) {
    take(material.young);
    if (material.poisson) take(*material.poisson);
    if (material.shear_modulus) take(*material.shear_modulus);
    take(material.density);
    if (material.retardation_time) take(*material.retardation_time);
  }
  for (const auto& section : structure.sections) {
    take(section.area);
    take_all(section.inertia);
    if (section.torsion) take(*section.torsion);
    take_all(section.shear_factor);
  }
  for (const auto& beam : structure.beams) take_all(beam.orientation);
  for (const auto& mass : structure.masses) {
    if (mass.mass) take(*mass.mass);
    take_all(mass.inertia);
  }
}

template <typename Take>
void visit(const model::ModelDescription& model, const Take& take_any) {
  const auto take = [&](const model::Quantity& quantity) { take_any(quantity, Role::structure, false); };
  for (const auto& coordinate : model.coordinates) {
    take(coordinate.mass);
    take(coordinate.position);
    take(coordinate.velocity);
  }
  visit_structure(model.structure, take);
  if (model.matrices) {
    for (const auto& [name, value] : model.matrices->position) take(value);
    for (const auto& [name, value] : model.matrices->velocity) take(value);
  }
  for (const auto& spring : model.springs) take(spring.stiffness);
  for (const auto& damper : model.dampers) take(damper.damping);
  if (const auto* modal = std::get_if<model::ModalDamping>(&model.damping)) {
    for (const auto& ratio : modal->ratios) take(ratio);
    if (modal->modes) take(*modal->modes);
  } else if (const auto* rayleigh = std::get_if<model::RayleighDamping>(&model.damping)) {
    take(rayleigh->mass);
    take(rayleigh->stiffness);
  }
  for (const auto& slider : model.sliders) {
    take(slider.stiffness);
    take_any(slider.friction_coefficient, Role::limit, false);
    take_any(slider.normal_load, Role::limit, false);
  }
  for (const auto& stop : model.stops) {
    take(stop.gap);
    take(stop.stiffness);
    take(stop.damping);
  }
  for (const auto& load : model::load_laws(model)) visit_law(*load.law, take_any);
  for (const auto& force : model.distributed_forces)
    for (const auto& share : force.direction) take(share);
  if (model.gravity)
    for (const auto& component : model.gravity->acceleration) take(component);
  if (model.base_motion)
    for (const auto& [name, value] : model.base_motion->direction) take(value);
}

}  // namespace

ParameterDependence::ParameterDependence(const model::StudyDescription& study, const numerics::Parameters& values,
                                         const std::vector<std::size_t>& fixed)
    : study_(study),
      values_(values),
      formula_uses_(values.size()),
      in_angular_frequency_(values.size()),
      in_frequency_(values.size()) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::find(fixed.begin(), fixed.end(), i) == fixed.end()) formula_uses_[i] = used(study.parameters[i].value);
  for (auto& uses : role_uses_) uses.resize(values.size());
  visit(study.model, [&](const model::Quantity& quantity, Role role, bool of_time) {
    for (const std::size_t place : used(quantity, of_time)) role_uses_[static_cast<std::size_t>(role)][place] = true;
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
    return numerics::parameters_used(quantity.expression, values_, of_time);
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
