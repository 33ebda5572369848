#include <rubato/integrate/balance.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <algorithm>

namespace rubato::integrate {
namespace {

bool is_zero(const Vector& x) { return (x.array() == 0.0).all(); }

class BalanceOfStructure final : public Balance {
 public:
  explicit BalanceOfStructure(const system::LocallyNonlinear& system)
      : system_(system),
        equilibrium_(system),
        loads_(system.loads()),
        left_(system.size()),
        right_(system.size()),
        swing_(system.size()) {}

  void find_acceleration(system::State& state, model::Side side) override {
    equilibrium_(state, state.acceleration, side);
  }

  void add_swing_of_loads(std::span<const WeighedEnd> ends, system::State& state) override {
    loads_.evaluate(state.t, right_);
    swing_.setZero();
    for (const WeighedEnd& end : ends) {
      loads_.evaluate(end.t, left_, end.side);
      swing_ += end.weight * (right_ - left_);
    }
    if (is_zero(swing_)) return;
    equilibrium_.of_force(swing_, left_);
    state.acceleration += left_;
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
  Vector left_, right_, swing_;
};

class BalanceOfMechanism final : public Balance {
 public:
  explicit BalanceOfMechanism(const system::Mechanism& mechanism)
      : equations_(mechanism),
        force_(mechanism.size()),
        force_now_(mechanism.size()),
        swing_(mechanism.size()),
        rate_(mechanism.constraint_count()),
        rate_now_(mechanism.constraint_count()),
        swing_of_rate_(mechanism.constraint_count()) {}

  void find_acceleration(system::State& state, model::Side side) override {
    known_ = state;
    if (!integrate::find_acceleration(equations_, state, side)) state = known_;
  }

  void add_swing_of_loads(std::span<const WeighedEnd> ends, system::State& state) override {
    evaluate(state.t, model::Side::left, state, force_now_, rate_now_);
    swing_.setZero();
    swing_of_rate_.setZero();
    for (const WeighedEnd& end : ends) {
      evaluate(end.t, end.side, state, force_, rate_);
      swing_ += end.weight * (force_now_ - force_);
      swing_of_rate_ += end.weight * (rate_now_ - rate_);
    }
    if (is_zero(swing_) && is_zero(swing_of_rate_)) return;
    known_ = state;
    if (!integrate::add_acceleration(equations_, state, swing_, swing_of_rate_)) state = known_;
  }

  /// Marches of mechanisms end steps at jumps, and go on with another acceleration.
  bool loads_jump(double) override { return false; }

  void find_contact_forces(const system::State&, system::State&) const override {}

 private:
  /// The forces of loads, and the second rates that constraints ask for, as if the state were there at another time.
  void evaluate(double t, model::Side side, system::State& state, Vector& force, Vector& rate) {
    const double now = state.t;
    state.t = t;
    equations_.go_to(state, side);
    equations_.force_of_loads(force);
    equations_.second_rate(rate);
    state.t = now;
  }

  system::MechanismEquations equations_;
  system::State known_;
  Vector force_, force_now_, swing_;
  Vector rate_, rate_now_, swing_of_rate_;
};

}  // namespace

std::unique_ptr<Balance> make_balance(const system::LocallyNonlinear& system) {
  return std::make_unique<BalanceOfStructure>(system);
}

std::unique_ptr<Balance> make_balance(const system::Mechanism& mechanism) {
  return std::make_unique<BalanceOfMechanism>(mechanism);
}

}  // namespace rubato::integrate
