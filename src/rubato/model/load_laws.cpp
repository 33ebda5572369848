#include <rubato/model/load_laws.hpp>

#include <fmt/format.h>

#include <numbers>

namespace rubato::model {

std::vector<LoadLaw> load_laws(const ModelDescription& description) {
  std::vector<LoadLaw> laws;
  for (const auto& force : description.forces)
    laws.push_back({&force.law, 0, fmt::format("the force on \"{}\"", force.on), force.where});
  for (const auto& force : description.distributed_forces)
    laws.push_back({&force.law, 0, fmt::format("the distributed force on \"{}\"", force.on), force.where});
  if (const auto& ground = description.base_motion)
    laws.push_back({&ground->law, acceleration_order(ground->of), "[base_motion]", ground->where});
  for (const auto& motion : description.prescribed)
    laws.push_back({&motion.law, 0, fmt::format("the displacement of \"{}\"", motion.on), motion.where});
  return laws;
}

int acceleration_order(BaseMotionDescription::Of of) {
  using Of = BaseMotionDescription::Of;
  return of == Of::displacement ? 2 : of == Of::velocity ? 1 : 0;
}

HarmonicLaw derivative(const HarmonicLaw& law, int order) {
  const double w = law.angular_frequency;
  if (order == 1) return {law.amplitude * w, w, law.phase + 0.5 * std::numbers::pi};
  if (order == 2) return {-law.amplitude * w * w, w, law.phase};
  return law;
}

bool is_constant(const TimeFormulaDescription& formula, const numerics::Parameters& parameters) {
  return numerics::is_formula_of(parameters, formula.formula.expression);
}

}  // namespace rubato::model
