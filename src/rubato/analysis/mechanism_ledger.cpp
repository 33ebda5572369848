#include <rubato/analysis/mechanism_ledger.hpp>

namespace rubato::analysis {

using Role = model::Element::Role;

MechanismLedger::MechanismLedger(integrate::MechanismBalance& balance)
    : mechanism_(balance.equations().mechanism()),
      balance_(balance),
      equations_(balance.equations()),
      travel_(mechanism_.size()),
      force_(mechanism_.size()),
      product_(mechanism_.size()) {}

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
  last_impulsive_work_ = 0.0;
  last_kinetic_ = kinetic(state);
  last_phase_ = state.phase;
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
    const system::State& end = is_end ? after : before;
    for (std::size_t i = 0; i < end.rubbing.size(); ++i) {
      const auto& s = mechanism_.model().frictions[i].s;
      booked.friction -=
          0.5 * equations_.friction_force(i, end.multiplier) * (s.value(after.q.data()) - s.value(before.q.data()));
    }
  }
  if (mechanism_.model().drives.empty()) return booked;
  for (const bool is_end : {false, true}) {
    balanced_ = is_end ? after : before;
    balance_.find_acceleration(balanced_, is_end ? model::Side::left : model::Side::right);
    for (const auto& drive : mechanism_.model().drives) {
      const double change = model::derivatives(drive.law, after.t, model::Side::left).value -
                            model::derivatives(drive.law, before.t, model::Side::right).value;
      booked.drive -= 0.5 * balanced_.multiplier[mechanism_.first_row(drive.joint)] * change;
    }
  }
  return booked;
}

void MechanismLedger::add_step(const system::State& before, const system::State& after, double impulsive_work) {
  const double impulse = impulsive_work - last_impulsive_work_;
  sums_.lock_dissipated += taken_before(before) + impulse;
  sums_.drive_work += impulse;
  last_impulsive_work_ = impulsive_work;
  const Booking booked = booking(before, after);
  sums_.damper_dissipated += booked.damper;
  sums_.friction_dissipated += booked.friction;
  sums_.load_work += booked.load;
  sums_.drive_work += booked.drive;
  last_kinetic_ = kinetic(after);
  last_phase_ = after.phase;
}

double MechanismLedger::taken_before(const system::State& state) {
  double taken = last_kinetic_ - kinetic(state);
  if (state.phase == last_phase_) return taken;
  // A damped stop lets go while its spring still presses: it relaxes against its damper, which takes what it holds.
  balanced_ = state;
  balanced_.phase = last_phase_;
  taken += strain(balanced_) - strain(state);
  return taken;
}

MechanismEnergy MechanismLedger::at(const system::State& before, const system::State& now, double impulsive_work) {
  const Booking part = &before == &now ? Booking{} : booking(before, now);
  MechanismEnergy energy = sums_;
  energy.kinetic = kinetic(now);
  energy.strain = strain(now);
  if (&before != &now) {
    const double impulse = impulsive_work - last_impulsive_work_;
    energy.lock_dissipated += taken_before(before) + impulse;
    energy.drive_work += impulse;
  }
  energy.damper_dissipated += part.damper;
  energy.friction_dissipated += part.friction;
  energy.load_work += part.load;
  energy.drive_work += part.drive;
  return energy;
}

}  // namespace rubato::analysis
