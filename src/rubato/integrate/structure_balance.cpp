#include <rubato/integrate/structure_balance.hpp>

#include <algorithm>

namespace rubato::integrate {

StructureBalance::StructureBalance(const system::LocallyNonlinear& system)
    : system_(system),
      equilibrium_(system),
      loads_(system.loads()),
      left_(system.size()),
      right_(system.size()),
      swing_(system.size()) {}

void StructureBalance::find_acceleration(system::State& state, model::Side side) {
  equilibrium_(state, state.acceleration, side);
}

void StructureBalance::add_swing_of_loads(std::span<const WeighedEnd> ends, system::State& state) {
  loads_.evaluate(state.t, right_);
  swing_.setZero();
  for (const WeighedEnd& end : ends) {
    loads_.evaluate(end.t, left_, end.side);
    swing_ += end.weight * (right_ - left_);
  }
  if ((swing_.array() == 0.0).all()) return;
  equilibrium_.of_force(swing_, left_);
  state.acceleration += left_;
}

bool StructureBalance::loads_jump(double t) {
  loads_.evaluate(t, left_, model::Side::left);
  loads_.evaluate(t, right_, model::Side::right);
  return !((right_ - left_).norm() <= 1e-12 * (right_.norm() + left_.norm()));
}

void StructureBalance::find_contact_forces(const system::State& before, system::State& state) {
  for (Index i = 0; i < system_.slider_count(); ++i) {
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    const double travel = system_.relative_displacement(i, state.q) - system_.relative_displacement(i, before.q);
    state.slider_force[i] = std::clamp(before.slider_force[i] + slider.stiffness * travel, -slider.limit, slider.limit);
  }
  system_.set_stop_forces(state);
  system_.move_laws(before, state);
}

}  // namespace rubato::integrate
