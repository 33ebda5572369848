#include <rubato/integrate/mechanism/mechanism_energy.hpp>

namespace rubato::integrate {
namespace {

using Kind = Account::Kind;
using Role = model::Element::Role;

enum Place : std::size_t {
  kinetic,
  strain,
  damper_dissipated,
  lock_dissipated,
  friction_dissipated,
  load_work,
  drive_work
};

}  // namespace

MechanismEnergy::MechanismEnergy(Balance& balance, system::MechanismEquations& equations,
                                 const MechanismTimeline& timeline)
    : mechanism_(equations.mechanism()),
      balance_(balance),
      equations_(equations),
      timeline_(timeline),
      travel_(mechanism_.size()),
      force_(mechanism_.size()),
      product_(mechanism_.size()) {}

std::vector<Account> MechanismEnergy::accounts() const {
  return {{Kind::stored, "kinetic", "kinetic energy"},
          {Kind::stored, "strain", "strain energy of beams, springs and elastic locks"},
          {Kind::dissipated, "damper_dissipated", "dissipated by the dampers since the start"},
          {Kind::dissipated, "lock_dissipated", "energy that locks took as they engaged and let go since the start"},
          {Kind::dissipated, "friction_dissipated", "dissipated by the friction of joints since the start"},
          {Kind::work, "load_work", "work of loads, gravity and laws of joints since the start"},
          {Kind::work, "drive_work", "work of the drives that prescribe motions since the start"}};
}

double MechanismEnergy::kinetic_energy(const system::State& state) {
  mechanism_.times_mass(state.v, product_);
  return 0.5 * state.v.dot(product_);
}

double MechanismEnergy::strain_energy(const system::State& state) {
  equations_.go_to(state, model::Side::right);
  return equations_.stored_energy();
}

void MechanismEnergy::add_stored(const system::State& state, Entries row) {
  row[kinetic] += kinetic_energy(state);
  row[strain] += strain_energy(state);
}

void MechanismEnergy::keep(const system::State& after) {
  last_kinetic_ = kinetic_energy(after);
  last_phase_ = after.phase;
  last_impulsive_work_ = timeline_.impulsive_work();
}

double MechanismEnergy::taken_before(const system::State& state) {
  double taken = last_kinetic_ - kinetic_energy(state);
  if (state.phase == last_phase_) return taken;
  // A damped stop lets go while its spring still presses: it relaxes against its damper, which takes what it holds.
  balanced_ = state;
  balanced_.phase = last_phase_;
  taken += strain_energy(balanced_) - strain_energy(state);
  return taken;
}

void MechanismEnergy::add_flow(const system::State& before, const system::State& after, Entries row) {
  const double impulse = timeline_.impulsive_work() - last_impulsive_work_;
  row[lock_dissipated] += taken_before(before) + impulse;
  row[drive_work] += impulse;
  mechanism_.difference(before.q, after.q, travel_);
  for (const bool is_end : {false, true}) {
    const system::State& end = is_end ? after : before;
    equations_.go_to(end, is_end ? model::Side::left : model::Side::right);
    equations_.external_force(force_);
    row[load_work] += 0.5 * force_.dot(travel_);
    equations_.force_of(Role::load, force_);
    row[load_work] -= 0.5 * force_.dot(travel_);
    equations_.force_of(Role::damper, force_);
    row[damper_dissipated] += 0.5 * force_.dot(travel_);
    for (std::size_t i = 0; i < end.rubbing.size(); ++i) {
      const auto& s = mechanism_.model().frictions[i].s;
      row[friction_dissipated] -=
          0.5 * equations_.friction_force(i, end.multiplier) * (s.value(after.q.data()) - s.value(before.q.data()));
    }
  }
  if (!mechanism_.model().drives.empty()) add_drive_work(before, after, row);
}

void MechanismEnergy::add_drive_work(const system::State& before, const system::State& after, Entries row) {
  for (const bool is_end : {false, true}) {
    balanced_ = is_end ? after : before;
    balance_.find_acceleration(balanced_, is_end ? model::Side::left : model::Side::right);
    for (const auto& drive : mechanism_.model().drives) {
      const double change = model::derivatives(drive.law, after.t, model::Side::left).value -
                            model::derivatives(drive.law, before.t, model::Side::right).value;
      row[drive_work] -= 0.5 * balanced_.multiplier[mechanism_.first_row(drive.joint)] * change;
    }
  }
}

}  // namespace rubato::integrate
