#include <rubato/integrate/law_energy.hpp>
#include <rubato/results/columns/block_columns.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::results {

BlockColumns::BlockColumns(const system::LocallyNonlinear& system, bool in_motion)
    : system_(system), in_motion_(in_motion), dissipated_(Vector::Zero(system.block_count())) {
  for (Index b = 0; b < system.block_count(); ++b) {
    const Index first = system.row_of_block(b), directions = directions_of(b);
    bool moves = false, rubs_by_rotations = true;  // an end that is held along the plane has no shares there
    for (Index i = first; i < first + directions; ++i) {
      moves = moves || !system.column(i).empty();
      rubs_by_rotations = rubs_by_rotations && system.is_of_rotations(i);
    }
    kind_of(rubbing_[directions], moves && rubs_by_rotations).blocks.push_back(b);
    kind_of(pressing_, system.is_of_rotations(first + directions)).blocks.push_back(b);
    all_.push_back(b);
  }
}

BlockColumns::Kind& BlockColumns::kind_of(std::array<Kind, 2>& kinds, bool is_rotation) {
  Kind& kind = kinds[is_rotation ? 1 : 0];
  kind.is_rotation = is_rotation;
  return kind;
}

Index BlockColumns::directions_of(Index block) const {
  return system_.blocks()[static_cast<std::size_t>(block)].law->size() - 1;
}

std::vector<std::string> BlockColumns::names_of(const std::vector<Index>& blocks) const {
  std::vector<std::string> names;
  for (const Index b : blocks) names.push_back(system_.blocks()[static_cast<std::size_t>(b)].name);
  return names;
}

void add_rubbing_blocks(const std::vector<std::string>& contacts, Index directions, bool is_rotation,
                        TableLayout& layout) {
  if (contacts.empty()) return;
  const std::string dimension = fmt::format("{}contact_of_{}_direction{}", is_rotation ? "rotational_" : "", directions,
                                            directions > 1 ? "s" : "");
  for (Index i = 0; i < directions; ++i) {
    const std::string place = directions > 1 ? fmt::format("_{}", i + 1) : "";
    if (is_rotation) {
      layout.blocks.push_back({"tangential_moment" + place, "N m",
                               "friction moment of a contact; -moment acts along its u", dimension, contacts});
      layout.blocks.push_back(
          {"slip_angle" + place, "rad", "where the friction spring ends, u - moment/kT", dimension, contacts});
    } else {
      layout.blocks.push_back({"tangential_force" + place, "N", "friction force of a contact; -force acts along its u",
                               dimension, contacts});
      layout.blocks.push_back(
          {"slip" + place, "m", "where the friction spring ends, u - force/kT", dimension, contacts});
    }
  }
}

void add_pressing_blocks(const std::vector<std::string>& contacts, const std::string& dimension, bool is_rotation,
                         TableLayout& layout) {
  if (contacts.empty()) return;
  layout.blocks.push_back({is_rotation ? "normal_moment" : "normal_force", is_rotation ? "N m" : "N",
                           "what presses the ends of a contact together", dimension, contacts});
  layout.blocks.push_back({is_rotation ? "gap_angle" : "gap", is_rotation ? "rad" : "m",
                           "clearance of a contact, negative while pressed", dimension, contacts});
}

void BlockColumns::add(TableLayout& layout) const {
  if (all_.empty()) return;
  for (Index directions = 1; directions < model::largest_block; ++directions)
    for (const Kind& kind : rubbing_[directions])
      add_rubbing_blocks(names_of(kind.blocks), directions, kind.is_rotation, layout);
  for (const Kind& kind : pressing_) {
    const char* dimension = kind.blocks.size() == all_.size() ? "contact"
                            : kind.is_rotation                ? "rotational_contact"
                                                              : "pressing_contact";
    add_pressing_blocks(names_of(kind.blocks), dimension, kind.is_rotation, layout);
  }
  if (in_motion_)
    layout.blocks.push_back({"dissipated", "J", "dissipated by a contact since the start", "contact", names_of(all_)});
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
    for (const Kind& kind : rubbing_[directions])
      for (Index i = 0; i < directions; ++i) {
        for (const Index b : kind.blocks) row.push_back(state.slider_force[system_.row_of_block(b) + i]);
        for (const Index b : kind.blocks) {
          const Index contact = system_.row_of_block(b) + i;
          row.push_back(system_.block_point(b, state).u[i] -
                        state.slider_force[contact] / law_of(b).limit_stiffness(i, true));
        }
      }
  for (const Kind& kind : pressing_) {
    for (const Index b : kind.blocks) row.push_back(state.slider_force[system_.row_of_block(b) + directions_of(b)]);
    for (const Index b : kind.blocks) {
      const Index contact = system_.row_of_block(b) + directions_of(b);
      row.push_back(law_of(b).clearance() - system_.relative_displacement(contact, state.q));
    }
  }
  if (!in_motion_) return;
  for (const Index b : all_)
    row.push_back(dissipated_[b] +
                  (before.t == state.t ? 0.0 : integrate::dissipated_by_block(system_, b, before, state)));
}

}  // namespace rubato::results
