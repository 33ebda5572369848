#include <rubato/results/columns/bushing_forces.hpp>

#include <string>

namespace rubato::results {

BushingForces::BushingForces(const system::Mechanism& mechanism) : mechanism_(mechanism), motion_(mechanism) {
  const std::size_t components = mechanism.model().dimension == 3 ? 6 : 3;
  values_.resize(components * mechanism.model().bushings.size());
}

void BushingForces::add(TableLayout& layout) const {
  std::vector<std::string> names;
  for (const auto& bushing : mechanism_.model().bushings) names.push_back(bushing.name);
  if (names.empty()) return;
  const std::vector<const char*> components =
      mechanism_.model().dimension == 3
          ? std::vector<const char*>{"force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"}
          : std::vector<const char*>{"force_x", "force_y", "moment"};
  for (const std::string component : components)
    layout.blocks.push_back({component, component.starts_with("moment") ? "N m" : "N",
                             "what each bushing does to its second part, by its axes, which turn with the first",
                             "bushing", names});
}

void BushingForces::append(const system::State& state, std::vector<double>& row) {
  const auto& bushings = mechanism_.model().bushings;
  if (bushings.empty()) return;
  const model::Motion& motion = motion_.go_to(state, model::Side::left);
  const std::size_t components = values_.size() / bushings.size();
  for (std::size_t i = 0; i < bushings.size(); ++i) bushings[i].forces(motion, values_.data() + i * components);
  for (std::size_t component = 0; component < components; ++component)
    for (std::size_t i = 0; i < bushings.size(); ++i) row.push_back(values_[i * components + component]);
}

}  // namespace rubato::results
