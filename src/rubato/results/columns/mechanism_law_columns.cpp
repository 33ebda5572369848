#include <rubato/results/columns/law_columns.hpp>
#include <rubato/results/columns/mechanism_law_columns.hpp>

namespace rubato::results {

MechanismLawColumns::MechanismLawColumns(system::MechanismEquations& equations, bool in_motion)
    : equations_(equations), in_motion_(in_motion) {
  const auto& laws = equations.mechanism().model().laws;
  for (std::size_t j = 0; j < laws.size(); ++j) (laws[j].is_angle() ? turning_ : sliding_).push_back(j);
  for (const auto* of : {&sliding_, &turning_})
    for (const std::size_t j : *of)
      if (laws[j].law->sticking_stiffness() > 0.0) of_friction_.push_back(j);
  dissipated_ = since_ = Vector::Zero(static_cast<Index>(laws.size()));
}

void MechanismLawColumns::add(TableLayout& layout) const {
  for (const bool is_rotation : {false, true}) {
    std::vector<std::string> names;
    for (const std::size_t j : is_rotation ? turning_ : sliding_)
      names.push_back(equations_.mechanism().model().laws[j].name);
    add_law_blocks(names, is_rotation, in_motion_, layout);
  }
  std::vector<std::string> names;
  for (const std::size_t j : of_friction_) names.push_back(equations_.mechanism().model().laws[j].name);
  add_friction_blocks(names, layout);
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
  for (const std::size_t j : of_friction_)
    row.push_back(equations_.law_displacement(j) -
                  equations_.law_force(j) / laws_of_model[j].law->sticking_stiffness());
  for (const std::size_t j : of_friction_) row.push_back(equations_.law_normal(j));
}

}  // namespace rubato::results
