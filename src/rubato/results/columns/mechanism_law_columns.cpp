#include <rubato/results/columns/law_columns.hpp>
#include <rubato/results/columns/mechanism_law_columns.hpp>

namespace rubato::results {

MechanismLawColumns::MechanismLawColumns(system::MechanismEquations& equations, bool in_motion)
    : equations_(equations), in_motion_(in_motion) {
  const auto& laws = equations.mechanism().model().laws;
  for (std::size_t j = 0; j < laws.size(); ++j) {
    (laws[j].is_angle() ? turning_ : sliding_).push_back(j);
    if (laws[j].law->sticking_stiffness() > 0.0)
      (laws[j].is_angle() ? rubbing_turning_ : rubbing_sliding_).push_back(j);
  }
  dissipated_ = since_ = Vector::Zero(static_cast<Index>(laws.size()));
}

void MechanismLawColumns::add(TableLayout& layout) const {
  const auto names_of = [&](const std::vector<std::size_t>& laws) {
    std::vector<std::string> names;
    for (const std::size_t j : laws) names.push_back(equations_.mechanism().model().laws[j].name);
    return names;
  };
  for (const bool is_rotation : {false, true})
    add_law_blocks(names_of(is_rotation ? turning_ : sliding_), is_rotation, in_motion_, layout);
  for (const bool is_rotation : {false, true})
    add_friction_blocks(names_of(is_rotation ? rubbing_turning_ : rubbing_sliding_), is_rotation, layout);
}

void MechanismLawColumns::book(const system::State& before, const system::State& after) {
  equations_.dissipated_by_laws(before, after, since_);
  dissipated_ += since_;
}

void MechanismLawColumns::append_since(const system::State& before, const system::State& state,
                                       std::vector<double>& row) {
  equations_.go_to(state, model::Side::right);
  if (in_motion_ && before.t != state.t)
    equations_.dissipated_by_laws(before, state, since_);
  else
    since_.setZero();
  for (const auto* laws : {&sliding_, &turning_}) {
    for (const std::size_t j : *laws) row.push_back(equations_.law_force(j));
    for (const std::size_t j : *laws) row.push_back(equations_.law_displacement(j));
    if (!in_motion_) continue;
    for (const std::size_t j : *laws) {
      const auto i = static_cast<Index>(j);
      row.push_back(dissipated_[i] + since_[i]);
    }
  }
  const auto& laws_of_model = equations_.mechanism().model().laws;
  for (const auto* laws : {&rubbing_sliding_, &rubbing_turning_}) {
    for (const std::size_t j : *laws)
      row.push_back(equations_.law_displacement(j) -
                    equations_.law_force(j) / laws_of_model[j].law->sticking_stiffness());
    for (const std::size_t j : *laws) row.push_back(equations_.law_normal(j));
  }
}

}  // namespace rubato::results
