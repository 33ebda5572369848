#include <rubato/integrate/law_energy.hpp>
#include <rubato/results/columns/block_columns.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::results {

BlockColumns::BlockColumns(const system::LocallyNonlinear& system, bool in_motion)
    : system_(system), in_motion_(in_motion), dissipated_(Vector::Zero(system.block_count())) {
  for (Index b = 0; b < system.block_count(); ++b) {
    rubbing_[directions_of(b)].push_back(b);
    all_.push_back(b);
  }
}

Index BlockColumns::directions_of(Index block) const {
  return system_.blocks()[static_cast<std::size_t>(block)].law->size() - 1;
}

std::vector<std::string> BlockColumns::names_of(const std::vector<Index>& blocks) const {
  std::vector<std::string> names;
  for (const Index b : blocks) names.push_back(system_.blocks()[static_cast<std::size_t>(b)].name);
  return names;
}

void BlockColumns::add(TableLayout& layout) const {
  if (all_.empty()) return;
  for (Index directions = 1; directions < model::largest_block; ++directions) {
    if (rubbing_[directions].empty()) continue;
    const std::vector<std::string> names = names_of(rubbing_[directions]);
    const std::string dimension = fmt::format("contact_of_{}_direction{}", directions, directions > 1 ? "s" : "");
    for (Index i = 0; i < directions; ++i) {
      const std::string place = directions > 1 ? fmt::format("_{}", i + 1) : "";
      layout.blocks.push_back(
          {"tangential_force" + place, "N", "friction force of a contact; -force acts along its u", dimension, names});
      layout.blocks.push_back({"slip" + place, "m", "where the friction spring ends, u - force/kT", dimension, names});
    }
  }
  const std::vector<std::string> names = names_of(all_);
  layout.blocks.push_back({"normal_force", "N", "what presses the ends of a contact together", "contact", names});
  layout.blocks.push_back({"gap", "m", "clearance of a contact, negative while pressed", "contact", names});
  if (in_motion_)
    layout.blocks.push_back({"dissipated", "J", "dissipated by a contact since the start", "contact", names});
}

void BlockColumns::add(const ColumnNames& names, std::vector<Block>& blocks) const {
  if (!all_.empty()) blocks.push_back({names.variable, names.unit, names.description, "contact", names_of(all_)});
}

void BlockColumns::book(const system::State& before, const system::State& after) {
  for (const Index b : all_) dissipated_[b] += integrate::dissipated_by_block(system_, b, before, after);
}

void BlockColumns::append_since(const system::State& before, const system::State& state, std::vector<double>& row) {
  const auto law_of = [&](Index b) -> const model::BlockLaw& {
    return *system_.blocks()[static_cast<std::size_t>(b)].law;
  };
  for (Index directions = 1; directions < model::largest_block; ++directions)
    for (Index i = 0; i < directions; ++i) {
      for (const Index b : rubbing_[directions]) row.push_back(state.slider_force[system_.row_of_block(b) + i]);
      for (const Index b : rubbing_[directions]) {
        const Index contact = system_.row_of_block(b) + i;
        row.push_back(system_.relative_displacement(contact, state.q) -
                      state.slider_force[contact] / law_of(b).limit_stiffness(i, true));
      }
    }
  for (const Index b : all_) row.push_back(state.slider_force[system_.row_of_block(b) + directions_of(b)]);
  for (const Index b : all_) {
    const Index contact = system_.row_of_block(b) + directions_of(b);
    row.push_back(law_of(b).clearance() - system_.relative_displacement(contact, state.q));
  }
  if (!in_motion_) return;
  for (const Index b : all_)
    row.push_back(dissipated_[b] +
                  (before.t == state.t ? 0.0 : integrate::dissipated_by_block(system_, b, before, state)));
}

}  // namespace rubato::results
