#include <rubato/system/mechanism_equations.hpp>

#include <algorithm>

// The laws of a mechanism that have a memory.
namespace rubato::system {

model::LawPoint MechanismEquations::law_point(std::size_t j, const State& state, model::Side side) {
  std::copy(state.v.data(), state.v.data() + state.v.size(), other_velocity_.data() + 1);
  model::Motion there;
  there.t = state.t;
  there.side = side;
  there.q = state.q.data();
  there.v = other_velocity_.data() + 1;
  there.phase = state.phase.data();
  there.laws.memory = state.memory.data();
  return mechanism_.model().laws[j].point(there);
}

void MechanismEquations::begin_step(const State& from) {
  for (std::size_t j = 0; j < step_start_.size(); ++j) step_start_[j] = law_point(j, from, model::Side::right);
  std::copy(from.memory.data(), from.memory.data() + from.memory.size(), start_memory_.data());
}

void MechanismEquations::go_to_end(const State& to, model::Side side) {
  go_to(to, side);
  motion_.laws = {step_start_.data(), start_memory_.data(), tried_memory_.data()};
}

// What presses on a law comes before it: its memory is there already.
void MechanismEquations::move_laws(State& to) {
  to.memory.resize(static_cast<Index>(start_memory_.size()));
  for (std::size_t j = 0; j < step_start_.size(); ++j) {
    const model::MechanismLaw& law = mechanism_.model().laws[j];
    law.law->advance(step_start_[j], start_memory_.data() + law.memory, law_point(j, to, model::Side::left),
                     to.memory.data() + law.memory);
  }
}

double MechanismEquations::stored_by_laws(const State& state) {
  double sum = 0.0;
  for (std::size_t j = 0; j < step_start_.size(); ++j) {
    const model::MechanismLaw& law = mechanism_.model().laws[j];
    sum += law.law->stored_energy(law_point(j, state, model::Side::right).u, state.memory.data() + law.memory);
  }
  return sum;
}

void MechanismEquations::dissipated_by_laws(const State& from, const State& to, Vector& dissipated) {
  for (std::size_t j = 0; j < step_start_.size(); ++j) {
    const model::MechanismLaw& law = mechanism_.model().laws[j];
    dissipated[static_cast<Index>(j)] =
        law.law->dissipated(law_point(j, from, model::Side::right), from.memory.data() + law.memory,
                            law_point(j, to, model::Side::left), to.memory.data() + law.memory);
  }
}

double MechanismEquations::law_force(std::size_t j) const {
  const model::MechanismLaw& law = mechanism_.model().laws[j];
  return law.law->at(law.point(motion_), motion_.laws.memory + law.memory).force;
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

}  // namespace rubato::system
