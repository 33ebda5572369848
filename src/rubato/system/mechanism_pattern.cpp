#include <rubato/system/mechanism_equations.hpp>

#include <algorithm>
#include <utility>
#include <variant>

// Where elements and joints write into the matrix of a mechanism: found once.
namespace rubato::system {

MechanismEquations::ElementPlace MechanismEquations::place_of(const std::vector<Index>& places) const {
  ElementPlace result;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] == ground) continue;
    result.local.push_back(static_cast<int>(i));
    result.place.push_back(places[i]);
  }
  return result;
}

MechanismEquations::MechanismEquations(const Mechanism& mechanism) : mechanism_(mechanism) {
  const auto& model = mechanism.model();
  std::size_t largest = 1, widest = 1;
  for (const auto& element : model.elements) {
    elements_.push_back(element->clone());
    element_places_.push_back(place_of(element->places()));
    largest = std::max(largest, element->places().size());
  }
  Index row = 0;
  std::size_t entries = 0;
  for (const auto& joint : model.joints) {
    joints_.push_back(joint->clone());
    JointPlace place;
    static_cast<ElementPlace&>(place) = place_of(joint->places());
    place.first_row = row;
    place.jacobian_start = entries;
    row += joint->rows();
    entries += static_cast<std::size_t>(joint->rows()) * joint->places().size();
    largest = std::max(largest, joint->places().size());
    widest = std::max(widest, static_cast<std::size_t>(joint->rows()));
    joint_places_.push_back(std::move(place));
    patterns_.push_back(joint->pattern());
  }
  // Friction writes on all places of its joint.
  for (const auto& friction : model.frictions) {
    model::JointPattern& pattern = patterns_[static_cast<std::size_t>(friction.joint)];
    std::fill(pattern.jacobian.begin(), pattern.jacobian.end(), 1);
    std::fill(pattern.curvature.begin(), pattern.curvature.end(), 1);
  }
  list_entries();
  forces_ = model.forces;
  jacobian_.assign(entries, 0.0);
  local_.assign(std::max(largest, widest), 0.0);
  matrix_.assign(largest * largest, 0.0);
  velocity_.assign(static_cast<std::size_t>(mechanism.size()) + 1, 0.0);
  acceleration_ = other_velocity_ = velocity_;
  step_start_.resize(model.laws.size());
  contact_start_.resize(model.contacts.size());
  start_memory_.assign(static_cast<std::size_t>(model.law_memory_size), 0.0);
  tried_memory_ = start_memory_;
  analyse();
}

void MechanismEquations::list_entries() {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const JointPlace& place = joint_places_[j];
    const std::size_t k = joints_[j]->places().size();
    for (int r = 0; r < joints_[j]->rows(); ++r)
      for (std::size_t i = 0; i < place.place.size(); ++i) {
        const std::size_t local = static_cast<std::size_t>(r) * k + static_cast<std::size_t>(place.local[i]);
        if (!patterns_[j].jacobian[local]) continue;
        entries_.push_back({static_cast<int>(place.jacobian_start + local), static_cast<int>(place.first_row + r),
                            static_cast<int>(place.place[i]), 0, 0});
      }
  }
}

void MechanismEquations::analyse() {
  const Index n = mechanism_.size();
  std::vector<SaddleMatrix::Entry> entries;
  bool is_symmetric = true;
  const auto couple = [&](const std::vector<Index>& places) {
    for (const Index i : places)
      for (const Index j : places)
        if (i >= j) entries.emplace_back(i, j);
  };
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    couple(element_places_[e].place);
    is_symmetric = is_symmetric && elements_[e]->has_symmetric_tangent();
  }
  const auto is_coupled = [&](std::size_t j, int a, int b) {
    const auto k = static_cast<int>(joints_[j]->places().size());
    const auto& curvature = patterns_[j].curvature;
    return curvature[static_cast<std::size_t>(a * k + b)] || curvature[static_cast<std::size_t>(b * k + a)];
  };
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const JointPlace& place = joint_places_[j];
    for (std::size_t a = 0; a < place.place.size(); ++a)
      for (std::size_t b = 0; b < place.place.size(); ++b)
        if (place.place[a] >= place.place[b] && is_coupled(j, place.local[a], place.local[b]))
          entries.emplace_back(place.place[a], place.place[b]);
    is_symmetric = is_symmetric && joints_[j]->has_symmetric_curvature();
  }
  for (const Entry& entry : entries_) entries.emplace_back(n + entry.row, entry.place);
  for (const auto& friction : mechanism_.model().frictions) is_symmetric = is_symmetric && !friction.follows_reaction();
  const auto& laws = mechanism_.model().laws;
  for (std::size_t j = 0; j < laws.size(); ++j) {
    const model::PressingReaction& reaction = laws[j].reaction;
    if (!reaction.presses()) continue;
    is_symmetric = false;
    const auto places = std::visit([](const auto& u) { return u.places(); }, laws[j].u);
    pressed_by_reactions_.push_back({j, place_of(places), {}});
    for (const Index i : pressed_by_reactions_.back().u.place)
      for (int r = 0; r < reaction.rows; ++r) entries.emplace_back(n + reaction.multiplier + r, i);
  }
  saddle_.analyse(mechanism_.mass(), mechanism_.constraint_count(), std::move(entries), is_symmetric);

  const auto find_slots = [&](ElementPlace& place, std::size_t k, const std::vector<char>* pattern) {
    for (std::size_t i = 0; i < place.place.size(); ++i)
      for (std::size_t j = 0; j < place.place.size(); ++j) {
        const int local = place.local[i] * static_cast<int>(k) + place.local[j];
        if (pattern && !(*pattern)[static_cast<std::size_t>(local)]) continue;
        const int slot = saddle_.slot(place.place[i], place.place[j]);
        if (slot == saddle_.spare_slot()) continue;
        place.matrix.slot.push_back(slot);
        place.matrix.local.push_back(local);
      }
  };
  for (std::size_t e = 0; e < elements_.size(); ++e)
    find_slots(element_places_[e], elements_[e]->places().size(), nullptr);
  for (std::size_t j = 0; j < joints_.size(); ++j)
    find_slots(joint_places_[j], joints_[j]->places().size(), &patterns_[j].curvature);
  for (Entry& entry : entries_) {
    entry.slot = saddle_.slot(n + entry.row, entry.place);
    entry.transposed = saddle_.slot(entry.place, n + entry.row);
    if (entry.slot == saddle_.spare_slot()) std::swap(entry.slot, entry.transposed);
  }
  for (const auto& friction : mechanism_.model().frictions) {
    FrictionPlace place;
    const JointPlace& joint = joint_places_[static_cast<std::size_t>(friction.joint)];
    for (const Index i : joint.place)
      for (int r = 0; r < friction.pressing_rows; ++r)
        place.slot.push_back(saddle_.slot(i, n + joint.first_row + friction.first_pressing_row + r));
    friction_places_.push_back(std::move(place));
  }
  for (PressedByReaction& pressed : pressed_by_reactions_) {
    const model::PressingReaction& reaction = laws[pressed.law].reaction;
    for (const Index i : pressed.u.place)
      for (int r = 0; r < reaction.rows; ++r) pressed.slot.push_back(saddle_.slot(i, n + reaction.multiplier + r));
  }
}

}  // namespace rubato::system
