#pragma once

#include <rubato/integrate/energy_ledger.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <vector>

namespace rubato::integrate {

/// What a law of a structure dissipates over a motion without a turn, by its own formula [J].
double dissipated_by_law(const system::LocallyNonlinear& system, Index law, const system::State& before,
                         const system::State& after);

/// Likewise a law of several numbers.
double dissipated_by_block(const system::LocallyNonlinear& system, Index block, const system::State& before,
                           const system::State& after);

/// What laws store, then what they dissipate.
std::vector<Account> accounts_of_laws();

/// Whether a contact slides on steadily, which takes work.
bool has_sliding_blocks(const system::LocallyNonlinear& system);

/// The energy of the laws of a structure beside sliders and stops.
class LawEnergy final : public EnergyPart {
 public:
  explicit LawEnergy(const system::LocallyNonlinear& system) : system_(system), slides_(has_sliding_blocks(system)) {}

  /// With the work of what moves contacts that slide on steadily, where there are such.
  std::vector<Account> accounts() const override;
  void add_stored(const system::State& state, Entries row) override;
  void add_flow(const system::State& before, const system::State& after, Entries row) override;

 private:
  const system::LocallyNonlinear& system_;
  bool slides_ = false;
};

}  // namespace rubato::integrate
