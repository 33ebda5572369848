#include <rubato/analysis/interpolation.hpp>

#include <algorithm>

namespace rubato::analysis {

double lagrange_weight(std::span<const double> times, std::size_t i, double t) {
  double weight = 1.0;
  for (std::size_t j = 0; j < times.size(); ++j)
    if (j != i) weight *= (t - times[j]) / (times[i] - times[j]);
  return weight;
}

StepInterpolation::StepInterpolation(const system::LocallyNonlinear& system, int order)
    : system_(system),
      equilibrium_(system),
      loads_(system.loads()),
      left_(system.size()),
      right_(system.size()),
      is_quintic_(order > 2) {}

bool StepInterpolation::jumps_at(double t) {
  loads_.evaluate(t, left_, model::Side::left);
  loads_.evaluate(t, right_, model::Side::right);
  return !((right_ - left_).norm() <= 1e-12 * (right_.norm() + left_.norm()));
}

void StepInterpolation::add(const system::State& state, model::Side side) {
  newest_ = (newest_ + 1) % most_knots;
  count_ = std::min(count_ + 1, most_knots);
  Knot& newest = knot(0);
  newest.state = state;
  newest.side = side;
  newest.has_acceleration = false;
}

void StepInterpolation::take(const system::State& before, const system::State& after) {
  const bool goes_on = !is_quintic_ && count_ > 0 && knot(0).state.t == before.t && !jumps_at(before.t) &&
                       knot(0).state.slider_force == before.slider_force;  // a damped stop may jump
  if (!goes_on) {
    count_ = 0;
    add(before, model::Side::right);
  }
  add(after, model::Side::left);
}

void StepInterpolation::at(double t, system::State& state, Vector& acceleration) {
  for (std::size_t age = 0; age < count_; ++age) {
    Knot& end = knot(age);
    if (!end.has_acceleration) equilibrium_(end.state, end.acceleration, end.side);
    end.has_acceleration = true;
  }
  state.t = t;
  if (is_quintic_)
    through_ends(t, state, acceleration);
  else
    through_knots(t, state, acceleration);
  const system::State& before = knot(1).state;
  for (Index i = 0; i < system_.slider_count(); ++i) {
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    const double travel = system_.relative_displacement(i, state.q) - system_.relative_displacement(i, before.q);
    state.slider_force[i] = std::clamp(before.slider_force[i] + slider.stiffness * travel, -slider.limit, slider.limit);
  }
  system_.set_stop_forces(state);
}

void StepInterpolation::through_knots(double t, system::State& state, Vector& acceleration) {
  std::array<double, most_knots> times{};
  for (std::size_t i = 0; i < count_; ++i) times[i] = knot(i).state.t;
  for (std::size_t i = 0; i < count_; ++i) {
    const double weight = lagrange_weight({times.data(), count_}, i, t);
    const Knot& end = knot(i);
    if (i == 0) {
      state.q = weight * end.state.q;
      state.v = weight * end.state.v;
      acceleration = weight * end.acceleration;
    } else {
      state.q += weight * end.state.q;
      state.v += weight * end.state.v;
      acceleration += weight * end.acceleration;
    }
  }
}

void StepInterpolation::through_ends(double t, system::State& state, Vector& acceleration) {
  const system::State &from = knot(1).state, &to = knot(0).state;
  const Vector &a0 = knot(1).acceleration, &a1 = knot(0).acceleration;
  const double h = to.t - from.t, s = (t - from.t) / h, s2 = s * s, s3 = s2 * s;
  // Quintic Hermite basis: what each end value contributes at s, and its derivatives with respect to s.
  const double q1 = s3 * (10.0 + s * (-15.0 + 6.0 * s)), q0 = 1.0 - q1;
  const double v0 = s + s3 * (-6.0 + s * (8.0 - 3.0 * s)), v1 = s3 * (-4.0 + s * (7.0 - 3.0 * s));
  const double c0 = 0.5 * s2 * (1.0 + s * (-3.0 + s * (3.0 - s))), c1 = 0.5 * s3 * (1.0 + s * (-2.0 + s));
  const double dq1 = 30.0 * s2 * (1.0 + s * (-2.0 + s));
  const double dv0 = 1.0 + s2 * (-18.0 + s * (32.0 - 15.0 * s)), dv1 = s2 * (-12.0 + s * (28.0 - 15.0 * s));
  const double dc0 = s + s2 * (-4.5 + s * (6.0 - 2.5 * s)), dc1 = s2 * (1.5 + s * (-4.0 + 2.5 * s));
  const double ddq1 = 60.0 * s * (1.0 + s * (-3.0 + 2.0 * s));
  const double ddv0 = s * (-36.0 + s * (96.0 - 60.0 * s)), ddv1 = s * (-24.0 + s * (84.0 - 60.0 * s));
  const double ddc0 = 1.0 + s * (-9.0 + s * (18.0 - 10.0 * s)), ddc1 = s * (3.0 + s * (-12.0 + 10.0 * s));
  state.q = q0 * from.q + q1 * to.q + h * (v0 * from.v + v1 * to.v) + (h * h) * (c0 * a0 + c1 * a1);
  state.v = (dq1 / h) * (to.q - from.q) + dv0 * from.v + dv1 * to.v + h * (dc0 * a0 + dc1 * a1);
  acceleration = (ddq1 / (h * h)) * (to.q - from.q) + (ddv0 / h) * from.v + (ddv1 / h) * to.v + ddc0 * a0 + ddc1 * a1;
}

}  // namespace rubato::analysis
