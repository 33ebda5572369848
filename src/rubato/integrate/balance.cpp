#include <rubato/integrate/balance.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <algorithm>

namespace rubato::integrate {
namespace {

class BalanceOfStructure final : public Balance {
 public:
  explicit BalanceOfStructure(const system::LocallyNonlinear& system)
      : system_(system), equilibrium_(system), loads_(system.loads()), left_(system.size()), right_(system.size()) {}

  void find_acceleration(system::State& state, model::Side side) override {
    equilibrium_(state, state.acceleration, side);
  }

  bool loads_jump(double t) override {
    loads_.evaluate(t, left_, model::Side::left);
    loads_.evaluate(t, right_, model::Side::right);
    return !((right_ - left_).norm() <= 1e-12 * (right_.norm() + left_.norm()));
  }

  /// Sliders by their return map; stops follow from displacement and velocity.
  void find_contact_forces(const system::State& before, system::State& state) const override {
    for (Index i = 0; i < system_.slider_count(); ++i) {
      const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
      const double travel = system_.relative_displacement(i, state.q) - system_.relative_displacement(i, before.q);
      state.slider_force[i] =
          std::clamp(before.slider_force[i] + slider.stiffness * travel, -slider.limit, slider.limit);
    }
    system_.set_stop_forces(state);
  }

 private:
  const system::LocallyNonlinear& system_;
  system::EquilibriumAcceleration equilibrium_;
  system::Loads loads_;
  Vector left_, right_;
};

class BalanceOfMechanism final : public Balance {
 public:
  explicit BalanceOfMechanism(const system::Mechanism& mechanism) : equations_(mechanism) {}

  void find_acceleration(system::State& state, model::Side side) override {
    known_ = state;
    if (!integrate::find_acceleration(equations_, state, side)) state = known_;
  }

  /// Marches of mechanisms end steps at jumps, and go on with another acceleration.
  bool loads_jump(double) override { return false; }

  void find_contact_forces(const system::State&, system::State&) const override {}

 private:
  system::MechanismEquations equations_;
  system::State known_;
};

}  // namespace

std::unique_ptr<Balance> make_balance(const system::LocallyNonlinear& system) {
  return std::make_unique<BalanceOfStructure>(system);
}

std::unique_ptr<Balance> make_balance(const system::Mechanism& mechanism) {
  return std::make_unique<BalanceOfMechanism>(mechanism);
}

}  // namespace rubato::integrate
