#include <rubato/analysis/joint_frictions.hpp>

#include <string>

namespace rubato::analysis {

JointFrictions::JointFrictions(const system::Mechanism& mechanism) : mechanism_(mechanism) {
  const auto& frictions = mechanism.model().frictions;
  for (std::size_t i = 0; i < frictions.size(); ++i) (frictions[i].s.is_angle() ? turning_ : sliding_).push_back(i);
}

void JointFrictions::add(results::TableLayout& layout) const {
  const auto add_block = [&](const std::vector<std::size_t>& frictions, const std::string& variable, const char* unit) {
    std::vector<std::string> joints;
    for (const std::size_t i : frictions) joints.push_back(mechanism_.model().frictions[i].name);
    if (!joints.empty())
      layout.blocks.push_back(
          {variable, unit, "what friction does to the second part of each joint", variable + "_joint", joints});
  };
  add_block(turning_, "friction_moment", "N m");
  add_block(sliding_, "friction_force", "N");
}

void JointFrictions::append(const system::MechanismEquations& equations, const Vector& multiplier,
                            std::vector<double>& row) const {
  for (const auto* frictions : {&turning_, &sliding_})
    for (const std::size_t i : *frictions) row.push_back(equations.friction_force(i, multiplier));
}

}  // namespace rubato::analysis
