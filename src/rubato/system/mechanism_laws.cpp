#include <rubato/system/mechanism_equations.hpp>

#include <algorithm>
#include <variant>

// The laws and contacts of a mechanism that have a memory.
namespace rubato::system {

model::Motion MechanismEquations::motion_at(const State& state, model::Side side) {
  std::copy(state.v.data(), state.v.data() + state.v.size(), other_velocity_.data() + 1);
  model::Motion there;
  there.t = state.t;
  there.side = side;
  there.q = state.q.data();
  there.v = other_velocity_.data() + 1;
  there.phase = state.phase.data();
  there.laws.memory = state.memory.data();
  return there;
}

model::LawPoint MechanismEquations::law_point(std::size_t j, const State& state, model::Side side) {
  model::Motion there = motion_at(state, side);
  if (!pressed_by_reactions_.empty()) take_reactions(state, there, other_reactions_);
  return mechanism_.model().laws[j].point(there);
}

model::BlockPoint MechanismEquations::contact_point(std::size_t j, const State& state, model::Side side) {
  return mechanism_.model().contacts[j].point(motion_at(state, side));
}

void MechanismEquations::begin_step(const State& from) {
  for (std::size_t j = 0; j < step_start_.size(); ++j) step_start_[j] = law_point(j, from, model::Side::right);
  for (std::size_t j = 0; j < contact_start_.size(); ++j)
    contact_start_[j] = contact_point(j, from, model::Side::right);
  std::copy(from.memory.data(), from.memory.data() + from.memory.size(), start_memory_.data());
}

void MechanismEquations::go_to_end(const State& to, model::Side side) {
  go_to(to, side);
  motion_.laws = {step_start_.data(), start_memory_.data(), tried_memory_.data(), contact_start_.data()};
}

// What presses on a law comes before it: its memory is there already.
void MechanismEquations::move_laws(State& to) {
  to.memory.resize(static_cast<Index>(start_memory_.size()));
  for (std::size_t j = 0; j < step_start_.size(); ++j) {
    const model::MechanismLaw& law = mechanism_.model().laws[j];
    law.law->advance(step_start_[j], start_memory_.data() + law.memory, law_point(j, to, model::Side::left),
                     to.memory.data() + law.memory);
  }
  for (std::size_t j = 0; j < contact_start_.size(); ++j) {
    const model::MechanismContact& contact = mechanism_.model().contacts[j];
    contact.law->advance(contact_start_[j], start_memory_.data() + contact.memory,
                         contact_point(j, to, model::Side::left), to.memory.data() + contact.memory);
  }
}

double MechanismEquations::stored_by_laws(const State& state) {
  double sum = 0.0;
  for (std::size_t j = 0; j < step_start_.size(); ++j) {
    const model::MechanismLaw& law = mechanism_.model().laws[j];
    sum += law.law->stored_energy(law_point(j, state, model::Side::right).u, state.memory.data() + law.memory);
  }
  for (std::size_t j = 0; j < contact_start_.size(); ++j) {
    const model::MechanismContact& contact = mechanism_.model().contacts[j];
    sum +=
        contact.law->stored_energy(contact_point(j, state, model::Side::right).u, state.memory.data() + contact.memory);
  }
  return sum;
}

void MechanismEquations::dissipated_by_contacts(const State& from, const State& to, Vector& dissipated) {
  for (std::size_t j = 0; j < contact_start_.size(); ++j) {
    const model::MechanismContact& contact = mechanism_.model().contacts[j];
    dissipated[static_cast<Index>(j)] =
        contact.law->dissipated(contact_point(j, from, model::Side::right), from.memory.data() + contact.memory,
                                contact_point(j, to, model::Side::left), to.memory.data() + contact.memory);
  }
}

model::BlockPoint MechanismEquations::contact_point(std::size_t j) const {
  return mechanism_.model().contacts[j].point(motion_);
}

model::BlockAnswer MechanismEquations::contact_answer(std::size_t j) const {
  return mechanism_.model().contacts[j].answer(motion_);
}

model::Law::Contact MechanismEquations::contact_branch(std::size_t j) const {
  const model::MechanismContact& contact = mechanism_.model().contacts[j];
  return contact.law->contact(contact.point(motion_), motion_.laws.memory + contact.memory);
}

void MechanismEquations::dissipated_by_laws(const State& from, const State& to, Vector& dissipated) {
  if (!pressed_by_reactions_.empty()) excess_ = (to.t - from.t) * from.reaction_lag;  // as in the step
  for (std::size_t j = 0; j < step_start_.size(); ++j) {
    const model::MechanismLaw& law = mechanism_.model().laws[j];
    dissipated[static_cast<Index>(j)] =
        law.law->dissipated(law_point(j, from, model::Side::right), from.memory.data() + law.memory,
                            law_point(j, to, model::Side::left), to.memory.data() + law.memory);
  }
  if (!pressed_by_reactions_.empty()) excess_.resize(0);
}

double MechanismEquations::law_force(std::size_t j) const {
  const model::MechanismLaw& law = mechanism_.model().laws[j];
  return law.law->at(law.point(motion_), motion_.laws.memory + law.memory).force;
}

model::LawAnswer MechanismEquations::law_answer(std::size_t j) const {
  return mechanism_.model().laws[j].answer(motion_);
}

double MechanismEquations::law_displacement(std::size_t j) const {
  return mechanism_.model().laws[j].displacement(motion_);
}

model::Law::Contact MechanismEquations::law_contact(std::size_t j) const {
  const model::MechanismLaw& law = mechanism_.model().laws[j];
  return law.law->contact(law.point(motion_), motion_.laws.memory + law.memory, 0.0);
}

double MechanismEquations::law_normal(std::size_t j) const {
  return std::max(0.0, mechanism_.model().laws[j].point(motion_).normal);
}

void MechanismEquations::add_laws_of_time(Vector& out) {
  for (const model::MechanismLaw& law : mechanism_.model().laws)
    if (law.depends_on_time()) add_force_of(law.element, out);
}

void MechanismEquations::take_reactions(const State& state, model::Motion& motion, Vector& reactions) const {
  const Index rows = mechanism_.constraint_count();
  if (state.multiplier.size() == rows)
    reactions = state.multiplier;
  else
    reactions.setZero(rows);
  if (excess_.size() == rows) reactions += excess_;
  motion.multiplier = reactions.data();
}

namespace {

/// The slope of a law by the reactions that press on it, and that of its u.
struct ReactionSlope {
  double by_row[3] = {}, of_u[model::SpaceCoordinate::tangent_size] = {};
};

/// False where it feels nothing of them: it sticks, or nothing presses.
bool find_slope(const model::MechanismLaw& law, const model::Motion& motion, ReactionSlope& slope) {
  const double by_normal = law.answer(motion).by_normal, size = law.reaction.force(motion);
  if (by_normal == 0.0 || size == 0.0) return false;
  for (int r = 0; r < law.reaction.rows; ++r)
    slope.by_row[r] = by_normal * motion.multiplier[law.reaction.multiplier + r] / size;
  std::visit([&](const auto& u) { u.slope(motion.q, slope.of_u); }, law.u);
  return true;
}

}  // namespace

void MechanismEquations::add_pressed_by_reactions(const Vector& multiplier, double factor, Vector& out) const {
  for (const PressedByReaction& pressed : pressed_by_reactions_) {
    const model::MechanismLaw& law = mechanism_.model().laws[pressed.law];
    ReactionSlope slope;
    if (!find_slope(law, motion_, slope)) continue;
    double applied = 0.0;
    for (int r = 0; r < law.reaction.rows; ++r) applied += slope.by_row[r] * multiplier[law.reaction.multiplier + r];
    for (std::size_t k = 0; k < pressed.u.place.size(); ++k)
      out[pressed.u.place[k]] += factor * applied * slope.of_u[pressed.u.local[k]];
  }
}

void MechanismEquations::linearise_pressed_by_reactions() {
  double* const values = saddle_.values();
  for (const PressedByReaction& pressed : pressed_by_reactions_) {
    const model::MechanismLaw& law = mechanism_.model().laws[pressed.law];
    ReactionSlope slope;
    if (!find_slope(law, motion_, slope)) continue;
    const auto rows = static_cast<std::size_t>(law.reaction.rows);
    for (std::size_t k = 0; k < pressed.u.place.size(); ++k)
      for (std::size_t r = 0; r < rows; ++r)
        values[pressed.slot[k * rows + r]] += slope.by_row[r] * slope.of_u[pressed.u.local[k]];
  }
}

}  // namespace rubato::system
