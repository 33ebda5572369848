#include <rubato/analysis/mechanism_ledger.hpp>

namespace rubato::analysis {

using Role = model::Element::Role;

MechanismLedger::MechanismLedger(const system::Mechanism& mechanism)
    : mechanism_(mechanism),
      equations_(mechanism),
      travel_(mechanism.size()),
      force_(mechanism.size()),
      product_(mechanism.size()) {}

double MechanismLedger::kinetic(const system::State& state) {
  mechanism_.times_mass(state.v, product_);
  return 0.5 * state.v.dot(product_);
}

double MechanismLedger::strain(const system::State& state) {
  equations_.go_to(state, model::Side::right);
  return equations_.stored_energy();
}

void MechanismLedger::start(const system::State& state) {
  sums_ = {};
  last_kinetic_ = kinetic(state);
  sums_.start = last_kinetic_ + strain(state);
}

MechanismLedger::Booking MechanismLedger::booking(const system::State& before, const system::State& after) {
  Booking booked;
  mechanism_.difference(before.q, after.q, travel_);
  for (const bool is_end : {false, true}) {
    equations_.go_to(is_end ? after : before, is_end ? model::Side::left : model::Side::right);
    equations_.external_force(force_);
    booked.load += 0.5 * force_.dot(travel_);
    equations_.force_of(Role::load, force_);
    booked.load -= 0.5 * force_.dot(travel_);
    equations_.force_of(Role::damper, force_);
    booked.damper += 0.5 * force_.dot(travel_);
  }
  return booked;
}

void MechanismLedger::add_step(const system::State& before, const system::State& after) {
  // A lock that engaged between the steps changed the velocities.
  sums_.lock_dissipated += last_kinetic_ - kinetic(before);
  const Booking booked = booking(before, after);
  sums_.damper_dissipated += booked.damper;
  sums_.load_work += booked.load;
  last_kinetic_ = kinetic(after);
}

MechanismEnergy MechanismLedger::at(const system::State& before, const system::State& now) {
  const Booking part = &before == &now ? Booking{} : booking(before, now);
  MechanismEnergy energy = sums_;
  energy.kinetic = kinetic(now);
  energy.strain = strain(now);
  if (&before != &now) energy.lock_dissipated += last_kinetic_ - kinetic(before);
  energy.damper_dissipated += part.damper;
  energy.load_work += part.load;
  return energy;
}

}  // namespace rubato::analysis
