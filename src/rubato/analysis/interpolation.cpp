#include <rubato/analysis/interpolation.hpp>

#include <algorithm>

namespace rubato::analysis {

StepInterpolation::StepInterpolation(const system::LocallyNonlinear& system)
    : system_(system), equilibrium_(system), a0_(system.size()), a1_(system.size()) {}

void StepInterpolation::take(const system::State& before, const system::State& after) {
  before_ = &before;
  after_ = &after;
  equilibrium_(before, a0_);
  equilibrium_(after, a1_, model::Side::left);
}

void StepInterpolation::at(double t, system::State& state) const {
  const double h = after_->t - before_->t, s = (t - before_->t) / h, s2 = s * s, s3 = s2 * s;
  // Quintic Hermite basis: what each end value contributes at s, and its derivative with respect to s.
  const double q1 = s3 * (10.0 + s * (-15.0 + 6.0 * s)), q0 = 1.0 - q1;
  const double v0 = s + s3 * (-6.0 + s * (8.0 - 3.0 * s)), v1 = s3 * (-4.0 + s * (7.0 - 3.0 * s));
  const double a0 = 0.5 * s2 * (1.0 + s * (-3.0 + s * (3.0 - s))), a1 = 0.5 * s3 * (1.0 + s * (-2.0 + s));
  const double dq1 = 30.0 * s2 * (1.0 + s * (-2.0 + s));
  const double dv0 = 1.0 + s2 * (-18.0 + s * (32.0 - 15.0 * s)), dv1 = s2 * (-12.0 + s * (28.0 - 15.0 * s));
  const double da0 = s + s2 * (-4.5 + s * (6.0 - 2.5 * s)), da1 = s2 * (1.5 + s * (-4.0 + 2.5 * s));
  state.t = t;
  state.q = q0 * before_->q + q1 * after_->q + h * (v0 * before_->v + v1 * after_->v) + (h * h) * (a0 * a0_ + a1 * a1_);
  state.v = (dq1 / h) * (after_->q - before_->q) + dv0 * before_->v + dv1 * after_->v + h * (da0 * a0_ + da1 * a1_);
  for (Index i = 0; i < system_.slider_count(); ++i) {
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    const double travel = system_.relative_displacement(i, state.q) - system_.relative_displacement(i, before_->q);
    state.slider_force[i] =
        std::clamp(before_->slider_force[i] + slider.stiffness * travel, -slider.limit, slider.limit);
  }
  system_.set_stop_forces(state);
}

}  // namespace rubato::analysis
