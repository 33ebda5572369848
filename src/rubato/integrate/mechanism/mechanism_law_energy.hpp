#pragma once

#include <rubato/integrate/law_energy.hpp>
#include <rubato/system/mechanism_equations.hpp>

namespace rubato::integrate {

/// The energy of the laws with a memory and of the contacts of a mechanism, by their own formulas.
class MechanismLawEnergy final : public EnergyPart {
 public:
  /// @param equations  lent; wherever they are left is well
  explicit MechanismLawEnergy(system::MechanismEquations& equations)
      : equations_(equations),
        dissipated_(static_cast<Index>(equations.mechanism().model().laws.size())),
        by_contacts_(static_cast<Index>(equations.mechanism().model().contacts.size())) {}

  bool has_laws() const { return dissipated_.size() > 0 || by_contacts_.size() > 0; }

  std::vector<Account> accounts() const override { return accounts_of_laws(); }
  void add_stored(const system::State& state, Entries row) override { row[0] += equations_.stored_by_laws(state); }
  void add_flow(const system::State& before, const system::State& after, Entries row) override {
    equations_.dissipated_by_laws(before, after, dissipated_);
    equations_.dissipated_by_contacts(before, after, by_contacts_);
    row[1] += dissipated_.sum() + by_contacts_.sum();
  }

 private:
  system::MechanismEquations& equations_;
  Vector dissipated_, by_contacts_;
};

}  // namespace rubato::integrate
