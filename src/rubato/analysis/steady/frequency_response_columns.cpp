#include <rubato/analysis/steady/frequency_response_columns.hpp>

#include <cmath>
#include <numbers>

namespace rubato::analysis {

results::Block scalar(const std::string& variable, const std::string& unit, const std::string& description) {
  return {variable, unit, description, "", {}};
}

void add_phases(const std::vector<Observed>& observed, const std::string& variable, const std::string& description,
                std::vector<results::Block>& blocks) {
  std::vector<std::string> labels;
  bool has_displacements = false, has_rotations = false;
  for (const Observed& one : observed) {
    labels.push_back(one.label);
    (one.is_rotation ? has_rotations : has_displacements) = true;
  }
  if (labels.empty()) return;
  const char* dimension = !has_rotations ? "coordinate" : !has_displacements ? "rotation" : "observed";
  blocks.push_back({variable, "rad", description, dimension, labels});
}

void add_parameters(const FrequencyResponsePlan& plan, const std::vector<bool>& wanted,
                    std::vector<results::Block>& blocks) {
  for (std::size_t i = 0; i < plan.sweep.names().size(); ++i)
    if (wanted.empty() || wanted[i]) blocks.push_back(scalar(plan.sweep.names()[i], "", "swept parameter"));
}

results::Block direction() { return {"direction", "", "which way the frequency goes", "", {}, {"up", "down"}}; }

results::Block angular_frequency() {
  return scalar("angular_frequency", "rad/s", "angular frequency of the excitation");
}

double phase_of(const std::complex<double>& harmonic) {
  const double phase = std::arg(harmonic);
  return phase == -std::numbers::pi ? std::numbers::pi : phase;
}

void append(const Vector& values, std::vector<double>& rows) {
  rows.insert(rows.end(), values.data(), values.data() + values.size());
}

}  // namespace rubato::analysis
