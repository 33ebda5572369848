#pragma once

#include <rubato/integrate/law_energy.hpp>
#include <rubato/system/mechanism_equations.hpp>

namespace rubato::integrate {

/// The energy of the laws with a memory of a mechanism, by their own formulas.
class MechanismLawEnergy final : public EnergyPart {
 public:
  /// @param equations  lent; wherever they are left is well
  explicit MechanismLawEnergy(system::MechanismEquations& equations)
      : equations_(equations), dissipated_(static_cast<Index>(equations.mechanism().model().laws.size())) {}

  std::vector<Account> accounts() const override { return accounts_of_laws(); }
  void add_stored(const system::State& state, Entries row) override { row[0] += equations_.stored_by_laws(state); }
  void add_flow(const system::State& before, const system::State& after, Entries row) override {
    equations_.dissipated_by_laws(before, after, dissipated_);
    row[1] += dissipated_.sum();
  }

 private:
  system::MechanismEquations& equations_;
  Vector dissipated_;
};

}  // namespace rubato::integrate
