#include <rubato/integrate/law_energy.hpp>
#include <rubato/results/columns/law_columns.hpp>

#include <algorithm>

namespace rubato::results {

LawColumns::LawColumns(const system::LocallyNonlinear& system, bool in_motion)
    : system_(system), in_motion_(in_motion), dissipated_(Vector::Zero(system.law_count())) {
  for (Index j = 0; j < system.law_count(); ++j) {
    if (system.laws()[static_cast<std::size_t>(j)].kind == "stop") continue;  // a spring: it dissipates nothing
    (system.is_law_of_rotations(j) ? of_rotations_ : of_displacements_).push_back(j);
    if (system.laws()[static_cast<std::size_t>(j)].law->sticking_stiffness() > 0.0)
      (system.is_law_of_rotations(j) ? friction_of_rotations_ : friction_of_displacements_).push_back(j);
  }
}

void add_law_blocks(const std::vector<std::string>& laws, bool is_rotation, bool has_dissipated, TableLayout& layout) {
  if (laws.empty()) return;
  const char* dimension = is_rotation ? "rotational_law" : "law";
  if (is_rotation) {
    layout.blocks.push_back({"moment", "N m", "moment of a law; -moment acts along its u", dimension, laws});
    layout.blocks.push_back({"angle", "rad", "u of a law", dimension, laws});
  } else {
    layout.blocks.push_back({"force", "N", "force of a law; -force acts along its u", dimension, laws});
    layout.blocks.push_back({"displacement", "m", "u of a law", dimension, laws});
  }
  if (has_dissipated)
    layout.blocks.push_back({"dissipated", "J", "dissipated by a law since the start", dimension, laws});
}

void add_friction_blocks(const std::vector<std::string>& laws, bool is_rotation, TableLayout& layout) {
  if (laws.empty()) return;
  const char* dimension = is_rotation ? "rotational_law_of_friction" : "law_of_friction";
  if (is_rotation)
    layout.blocks.push_back({"slip_angle", "rad", "slip of a law of friction, u - moment/kT", dimension, laws});
  else
    layout.blocks.push_back({"slip", "m", "slip of a law of friction, u - force/kT", dimension, laws});
  layout.blocks.push_back({"normal_force", "N", "what presses on it, 0 where it is open", dimension, laws});
}

void LawColumns::add(TableLayout& layout) const {
  for (const bool is_rotation : {false, true})
    add_law_blocks(names_of(is_rotation ? of_rotations_ : of_displacements_), is_rotation, in_motion_, layout);
  for (const bool is_rotation : {false, true})
    add_friction_blocks(names_of(is_rotation ? friction_of_rotations_ : friction_of_displacements_), is_rotation,
                        layout);
}

void LawColumns::add(const ColumnNames& names, std::vector<Block>& blocks) const {
  for (const bool is_rotation : {false, true}) {
    const std::vector<std::string> laws = names_of(is_rotation ? of_rotations_ : of_displacements_);
    if (!laws.empty())
      blocks.push_back({names.variable, names.unit, names.description, is_rotation ? "rotational_law" : "law", laws});
  }
}

std::vector<Index> LawColumns::order() const {
  std::vector<Index> laws = of_displacements_;
  laws.insert(laws.end(), of_rotations_.begin(), of_rotations_.end());
  return laws;
}

std::vector<std::string> LawColumns::names_of(const std::vector<Index>& laws) const {
  std::vector<std::string> names;
  for (const Index j : laws) names.push_back(system_.laws()[static_cast<std::size_t>(j)].name);
  return names;
}

void LawColumns::book(const system::State& before, const system::State& after) {
  for (Index j = 0; j < dissipated_.size(); ++j)
    dissipated_[j] += integrate::dissipated_by_law(system_, j, before, after);
}

void LawColumns::append_since(const system::State& before, const system::State& state, std::vector<double>& row) {
  const Index first = system_.first_law();
  for (const auto* laws : {&of_displacements_, &of_rotations_}) {
    for (const Index j : *laws) row.push_back(state.slider_force[first + j]);
    for (const Index j : *laws) row.push_back(system_.relative_displacement(first + j, state.q));
    if (!in_motion_) continue;
    for (const Index j : *laws)
      row.push_back(dissipated_[j] +
                    (before.t == state.t ? 0.0 : integrate::dissipated_by_law(system_, j, before, state)));
  }
  for (const auto* laws : {&friction_of_displacements_, &friction_of_rotations_}) {
    for (const Index j : *laws)
      row.push_back(system_.relative_displacement(first + j, state.q) -
                    state.slider_force[first + j] /
                        system_.laws()[static_cast<std::size_t>(j)].law->sticking_stiffness());
    for (const Index j : *laws) row.push_back(std::max(0.0, system_.law_point(j, state, model::Side::right).normal));
  }
}

}  // namespace rubato::results
