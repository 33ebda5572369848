#pragma once

#include <rubato/integrate/energy_ledger.hpp>
#include <rubato/system/state_motion.hpp>

#include <vector>

namespace rubato::integrate {

/// The energy of the [[stop]]s of a mechanism, as StructureEnergy has it. Over a step of one that is closed (f0 + f1)/2
/// times the change of its depth, less the change of what it stores, is dissipated; and what its spring still holds as
/// it lets go.
class MechanismStopEnergy final : public EnergyPart {
 public:
  explicit MechanismStopEnergy(const system::Mechanism& mechanism);

  bool has_stops() const { return !stops_.empty(); }
  std::vector<Account> accounts() const override;
  void start(const system::State& state) override { keep(state); }
  void add_stored(const system::State& state, Entries row) override;
  void add_flow(const system::State& before, const system::State& after, Entries row) override;
  void keep(const system::State& after) override;

 private:
  /// What stops store where motion_ stands, those that are closed in some phases [J].
  double stored(const model::Motion& motion, const std::vector<int>& phase) const;

  const system::Mechanism& mechanism_;
  system::StateMotion motion_;
  std::vector<std::size_t> stops_;  // among the locks
  std::vector<int> last_phase_;
};

}  // namespace rubato::integrate
