#include <rubato/results/columns/joint_frictions.hpp>

#include <string>

namespace rubato::results {
namespace {

/// Whether the friction is one of two along a plane.
bool is_planar(const model::Mechanism& model, std::size_t friction) {
  const int partner = model.frictions[friction].partner;
  return partner >= 0 && !model.frictions[friction].s.is_angle() &&
         !model.frictions[static_cast<std::size_t>(partner)].s.is_angle();
}

}  // namespace

JointFrictions::JointFrictions(system::MechanismEquations& equations)
    : equations_(equations), mechanism_(equations.mechanism()) {
  const auto& frictions = mechanism_.model().frictions;
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    if (!is_planar(mechanism_.model(), i))
      (frictions[i].s.is_angle() ? turning_ : sliding_).push_back(i);
    else if (static_cast<std::size_t>(frictions[i].partner) > i)
      planar_.push_back(i);
  }
}

void JointFrictions::add(TableLayout& layout) const {
  const auto add_block = [&](const std::vector<std::size_t>& frictions, const std::string& variable, const char* unit,
                             const std::string& axes, const std::string& dimension) {
    std::vector<std::string> joints;
    for (const std::size_t i : frictions) joints.push_back(mechanism_.model().frictions[i].label());
    if (!joints.empty())
      layout.blocks.push_back(
          {variable, unit, "what friction does to the second part of each joint" + axes, dimension, joints});
  };
  add_block(turning_, "friction_moment", "N m", "", "friction_moment_joint");
  add_block(sliding_, "friction_force", "N", "", "friction_force_joint");
  for (const char* const variable : {"friction_force_x", "friction_force_y", "friction_force_z"})
    add_block(planar_, variable, "N", ", by the axes of the world", "friction_plane_joint");
}

void JointFrictions::append(const system::State& state, std::vector<double>& row) {
  equations_.go_to(state, model::Side::right);
  constexpr std::size_t second = 6;  // where the position of the second node stands in a slope
  for (const auto* frictions : {&turning_, &sliding_})
    for (const std::size_t i : *frictions) row.push_back(equations_.friction_force(i, state.multiplier));
  const auto& frictions = mechanism_.model().frictions;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::size_t i : planar_) {
      double force = 0.0;
      for (const std::size_t one : {i, static_cast<std::size_t>(frictions[i].partner)}) {
        double slope[model::FreeCoordinate::most_places];
        frictions[one].s.slope(state.q.data(), slope);
        force += equations_.friction_force(one, state.multiplier) * slope[second + axis];
      }
      row.push_back(force);
    }
}

}  // namespace rubato::results
