#pragma once

#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::analysis {

/// States between the ends of an accepted step: the quintic through displacement, velocity and acceleration of
/// equilibrium at both ends (error h^6 in q, h^5 in v: above the order of every method that marches here), the
/// return map of the sliders from the start of the step, and the stops at its displacement and velocity.
class StepInterpolation {
 public:
  explicit StepInterpolation(const system::LocallyNonlinear& system);

  /// Takes the ends of a step; they must stay as they are while states between them are asked for.
  void take(const system::State& before, const system::State& after);
  /// The state at t in [before.t, after.t].
  void at(double t, system::State& state) const;

 private:
  const system::LocallyNonlinear& system_;
  system::EquilibriumAcceleration equilibrium_;
  const system::State* before_ = nullptr;
  const system::State* after_ = nullptr;
  Vector a0_, a1_;
};

}  // namespace rubato::analysis
