#pragma once

#include <rubato/integrate/balance.hpp>
#include <rubato/system/constrained_equations.hpp>

namespace rubato::integrate {

/// The balance of a constrained system. Where no acceleration is found it leaves that of the state.
class ConstrainedBalance final : public Balance {
 public:
  /// @param equations  lent; wherever they are left is well
  explicit ConstrainedBalance(system::ConstrainedEquations& equations);

  void find_acceleration(system::State& state, model::Side side) override;
  void find_shown_acceleration(system::State& state) override;
  void add_swing_of_loads(std::span<const WeighedEnd> ends, system::State& state) override;
  /// Marches of constrained systems end steps at jumps, and go on with another acceleration.
  bool loads_jump(double) override { return false; }
  void find_contact_forces(const system::State& before, system::State& state) override {
    equations_.move_laws(before, state);
  }

 private:
  /// The forces of loads, and the second rates that constraints ask for, as if the state were there at another time.
  void evaluate(double t, model::Side side, system::State& state, Vector& force, Vector& rate);

  system::ConstrainedEquations& equations_;
  system::State known_, from_now_on_;
  Vector force_, force_now_, swing_;
  Vector rate_, rate_now_, swing_of_rate_;
};

}  // namespace rubato::integrate
