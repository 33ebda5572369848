#include <rubato/results/columns/joint_laws.hpp>

#include <algorithm>
#include <utility>
#include <vector>

namespace rubato::results {

JointLaws::JointLaws(const system::Mechanism& mechanism) : motion_(mechanism) {
  const auto take = [&](const std::string& name, const model::FreeCoordinate& s) {
    Law law{name, s, {}};
    for (const auto& element : mechanism.model().elements)
      if (element->name() == name && element->places() == s.places()) law.elements.push_back(element->clone());
    if (!law.elements.empty()) (s.is_angle() ? turning_ : sliding_).push_back(std::move(law));
  };
  for (const auto& joint : mechanism.model().joint_coordinates) take(joint.name, joint.s);
  for (const auto& joint : mechanism.model().space_coordinates) take(joint.name, joint.s);
  // The laws of a screw are of its angle: of its way, which has the same places, they say nothing.
  std::erase_if(sliding_, [&](const Law& law) {
    return std::any_of(turning_.begin(), turning_.end(), [&](const Law& other) { return other.name == law.name; });
  });
  force_.resize(model::FreeCoordinate::most_places);
  slope_.resize(model::FreeCoordinate::most_places);
}

void JointLaws::add(TableLayout& layout) const {
  const auto add_block = [&](const std::vector<Law>& laws, const std::string& variable, const char* unit) {
    std::vector<std::string> joints;
    for (const Law& law : laws) joints.push_back(law.name);
    if (!joints.empty())
      layout.blocks.push_back({variable, unit,
                               "what springs, dampers, laws and elastic locks of each joint do to its second part",
                               variable + "_joint", joints});
  };
  add_block(turning_, "law_moment", "N m");
  add_block(sliding_, "law_force", "N");
}

void JointLaws::append(const system::State& state, std::vector<double>& row) {
  const model::Motion& motion = motion_.go_to(state, model::Side::left);
  for (const auto* laws : {&turning_, &sliding_})
    for (const Law& law : *laws) row.push_back(value(law, motion));
}

/// Elements give -F ds/dq.
double JointLaws::value(const Law& law, const model::Motion& motion) {
  law.s.slope(motion.q, slope_.data());
  const std::size_t k = law.s.places().size();
  double along = 0.0, square = 0.0;
  for (std::size_t i = 0; i < k; ++i) square += slope_[i] * slope_[i];
  for (const auto& element : law.elements) {
    element->force(motion, force_.data());
    for (std::size_t i = 0; i < k; ++i) along -= force_[i] * slope_[i];
  }
  return along / square;
}

}  // namespace rubato::results
