#include <rubato/results/columns/contact_columns.hpp>
#include <rubato/results/columns/mechanism_stop_columns.hpp>

#include <algorithm>

namespace rubato::results {

MechanismStopColumns::MechanismStopColumns(const system::Mechanism& mechanism)
    : mechanism_(mechanism), motion_(mechanism) {
  const auto& locks = mechanism.model().locks;
  for (std::size_t i = 0; i < locks.size(); ++i)
    if (locks[i].is_stop_part) (locks[i].s.is_angle() ? turning_ : sliding_).push_back(i);
}

void MechanismStopColumns::add(TableLayout& layout) const {
  for (const bool is_rotation : {false, true}) {
    std::vector<std::string> names;
    for (const std::size_t i : is_rotation ? turning_ : sliding_) names.push_back(mechanism_.model().locks[i].name);
    add_stop_blocks(names, is_rotation, layout);
  }
}

void MechanismStopColumns::append(const system::State& state, std::vector<double>& row) {
  const model::Motion& motion = motion_.go_to(state, model::Side::right);
  const auto& locks = mechanism_.model().locks;
  for (const auto* stops : {&sliding_, &turning_}) {
    for (const std::size_t i : *stops) row.push_back(state.phase[i] == model::lock_open ? 0.0 : locks[i].push(motion));
    for (const std::size_t i : *stops) row.push_back(std::max(0.0, locks[i].depth(motion)));
  }
}

}  // namespace rubato::results
