#pragma once

#include <rubato/integrate/balance.hpp>
#include <rubato/integrate/energy_ledger.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>

namespace rubato::integrate {

/// The energy of a mechanism. Over a step with the travel dq, along the retraction from its start:
///
///   loads, laws, dampers (f0 + f1)/2 . dq
///   friction              (F0 + F1)/2 times the change of its coordinate
///   drives               (F0 + F1)/2 times the change of what they prescribe, F minus the multiplier of
///                         equilibrium at either end (that of a step is of first order where velocities are projected)
///
/// and between steps what the projection of the velocities took, and drives gave to it, and what the spring of a damped
/// stop still held as it let go.
class MechanismEnergy final : public EnergyPart {
 public:
  /// @param equations  lent; wherever they are left is well   @param timeline  of the march
  MechanismEnergy(Balance& balance, system::MechanismEquations& equations, const MechanismTimeline& timeline);

  std::vector<Account> accounts() const override;
  void start(const system::State& state) override { keep(state); }
  void add_stored(const system::State& state, Entries row) override;
  void add_flow(const system::State& before, const system::State& after, Entries row) override;
  void keep(const system::State& after) override;

 private:
  void add_drive_work(const system::State& before, const system::State& after, Entries row);
  /// What locks took between the last step and this state, without what drives gave [J].
  double taken_before(const system::State& state);
  double kinetic_energy(const system::State& state);
  double strain_energy(const system::State& state);

  const system::Mechanism& mechanism_;
  Balance& balance_;
  system::MechanismEquations& equations_;
  const MechanismTimeline& timeline_;
  Vector travel_, force_, product_;
  system::State balanced_;
  double last_kinetic_ = 0.0, last_impulsive_work_ = 0.0;
  std::vector<int> last_phase_;
};

}  // namespace rubato::integrate
