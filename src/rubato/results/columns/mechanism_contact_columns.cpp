#include <rubato/results/columns/block_columns.hpp>
#include <rubato/results/columns/mechanism_contact_columns.hpp>

namespace rubato::results {

MechanismContactColumns::MechanismContactColumns(system::MechanismEquations& equations, bool in_motion)
    : equations_(equations), in_motion_(in_motion) {
  const auto& contacts = equations.mechanism().model().contacts;
  for (std::size_t j = 0; j < contacts.size(); ++j) {
    rubbing_[contacts[j].law->size() - 1].push_back(j);
    all_.push_back(j);
  }
  dissipated_ = since_ = Vector::Zero(static_cast<Index>(contacts.size()));
}

std::vector<std::string> MechanismContactColumns::names_of(const std::vector<std::size_t>& contacts) const {
  std::vector<std::string> names;
  for (const std::size_t j : contacts) names.push_back(equations_.mechanism().model().contacts[j].name);
  return names;
}

void MechanismContactColumns::add(TableLayout& layout) const {
  for (Index directions = 1; directions < model::largest_block; ++directions)
    add_rubbing_blocks(names_of(rubbing_[directions]), directions, false, layout);
  add_pressing_blocks(names_of(all_), "contact", false, layout);
  if (in_motion_)
    layout.blocks.push_back({"dissipated", "J", "dissipated by a contact since the start", "contact", names_of(all_)});
}

void MechanismContactColumns::book(const system::State& before, const system::State& after) {
  equations_.dissipated_by_contacts(before, after, since_);
  dissipated_ += since_;
}

void MechanismContactColumns::append_since(const system::State& before, const system::State& state,
                                           std::vector<double>& row) {
  equations_.go_to(state, model::Side::right);
  const auto& contacts = equations_.mechanism().model().contacts;
  for (Index directions = 1; directions < model::largest_block; ++directions)
    for (Index i = 0; i < directions; ++i) {
      for (const std::size_t j : rubbing_[directions]) row.push_back(equations_.contact_answer(j).force[i]);
      for (const std::size_t j : rubbing_[directions])
        row.push_back(equations_.contact_point(j).u[i] -
                      equations_.contact_answer(j).force[i] / contacts[j].law->limit_stiffness(i, true));
    }
  for (const std::size_t j : all_) row.push_back(equations_.contact_answer(j).force[contacts[j].law->size() - 1]);
  for (const std::size_t j : all_)
    row.push_back(contacts[j].law->clearance() - equations_.contact_point(j).u[contacts[j].law->size() - 1]);
  if (!in_motion_) return;
  if (before.t != state.t)
    equations_.dissipated_by_contacts(before, state, since_);
  else
    since_.setZero();
  for (const std::size_t j : all_) row.push_back(dissipated_[static_cast<Index>(j)] + since_[static_cast<Index>(j)]);
}

}  // namespace rubato::results
