#pragma once

#include <rubato/integrate/balance.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::integrate {

/// The balance of a structure.
class StructureBalance final : public Balance {
 public:
  /// @param system  must outlive this
  explicit StructureBalance(const system::LocallyNonlinear& system);

  void find_acceleration(system::State& state, model::Side side) override;
  void add_swing_of_loads(std::span<const WeighedEnd> ends, system::State& state) override;
  bool loads_jump(double t) override;
  /// Sliders by their return map; stops follow from displacement and velocity.
  void find_contact_forces(const system::State& before, system::State& state) override;

 private:
  const system::LocallyNonlinear& system_;
  system::EquilibriumAcceleration equilibrium_;
  system::Loads loads_;
  Vector left_, right_, swing_;
};

}  // namespace rubato::integrate
