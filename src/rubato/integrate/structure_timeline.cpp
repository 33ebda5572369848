#include <rubato/integrate/structure_timeline.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::integrate {

/// The relative displacement over a step: the cubic through displacement and velocity of both ends.
struct StructureTimeline::Path {
  double h, u0, v0, u1, v1;

  double displacement(double share) const {
    const double s = share, r = 1.0 - s;
    return r * r * (1.0 + 2.0 * s) * u0 + s * s * (3.0 - 2.0 * s) * u1 + h * s * r * (r * v0 - s * v1);
  }
  double velocity(double share) const {
    const double s = share, r = 1.0 - s;
    return 6.0 * s * r * (u1 - u0) / h + r * (1.0 - 3.0 * s) * v0 + s * (3.0 * s - 2.0) * v1;
  }
  double final_acceleration() const { return (6.0 * (u0 - u1) / h + 2.0 * v0 + 4.0 * v1) / h; }
};

namespace {

/// Where a function that is positive at first and negative at 1 passes zero.
template <class Function>
double root(const Function& function) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (function(middle) > 0.0 ? low : high) = middle;
  }
  return high;
}

double relative(const Vector& x, Index first, Index second) {
  return (first == ground ? 0.0 : x[first]) - (second == ground ? 0.0 : x[second]);
}

}  // namespace

StructureTimeline::StructureTimeline(const system::LocallyNonlinear& system, double resolution)
    : system_(system),
      resolution_(resolution),
      loads_(system.loads()),
      left_(system.size()),
      right_(system.size()),
      beyond_(system.start()),
      equilibrium_(system) {}

std::vector<double> StructureTimeline::breakpoints(double from, double to) const {
  return loads_.breakpoints(from, to);
}

bool StructureTimeline::jumps_at(double t) {
  loads_.evaluate(t, left_, model::Side::left);
  loads_.evaluate(t, right_, model::Side::right);
  return !((right_ - left_).norm() <= 1e-12 * (right_.norm() + left_.norm()));
}

void StructureTimeline::restart(system::State& state) { equilibrium_(state, state.auxiliary_acceleration); }

// The force of a slider is the same on both sides of a transition, and so is the acceleration. The rate of the force is
// lost when a slider begins to slip, kT du/dt; one that comes to rest has none on either side.
bool StructureTimeline::pass(const system::State& before, system::State& state, double shift) {
  if (shift == 0.0) return false;
  bool slips = false;
  beyond_.slider_force = state.slider_force;
  for (Index i = 0; i < system_.slider_count(); ++i) {
    if (watch_of(i, before) != Watch::limit) continue;
    const GuardValue end = guard(i, before, state);
    if (!(end.value <= 2.0 * resolution_ * std::abs(end.rate))) continue;
    slips = true;
    const auto& s = system_.sliders()[static_cast<std::size_t>(i)];
    beyond_.slider_force[i] -= shift * s.stiffness * relative(state.v, s.first, s.second);
  }
  if (!slips) return false;
  beyond_.t = state.t;
  beyond_.q = state.q;
  beyond_.v = state.v;
  equilibrium_(state, left_);
  equilibrium_(beyond_, right_);
  state.auxiliary_acceleration += right_ - left_;
  return false;
}

StructureTimeline::Path StructureTimeline::path_of(Index slider, const system::State& from,
                                                   const system::State& to) const {
  const auto& s = system_.sliders()[static_cast<std::size_t>(slider)];
  return {to.t - from.t, relative(from.q, s.first, s.second), relative(from.v, s.first, s.second),
          relative(to.q, s.first, s.second), relative(to.v, s.first, s.second)};
}

StructureTimeline::Watch StructureTimeline::watch_of(Index slider, const system::State& from) const {
  const auto& s = system_.sliders()[static_cast<std::size_t>(slider)];
  if (s.limit == 0.0) return Watch::nothing;
  const double force = from.slider_force[slider], velocity = relative(from.v, s.first, s.second);
  const double ends =
      (s.first == ground ? 0.0 : std::abs(from.q[s.first])) + (s.second == ground ? 0.0 : std::abs(from.q[s.second]));
  const double round_off = 64.0 * std::numeric_limits<double>::epsilon() * (s.limit + s.stiffness * ends);
  if (s.limit - std::abs(force) > std::max(round_off, 2.0 * resolution_ * s.stiffness * std::abs(velocity)))
    return Watch::limit;
  const double side = force > 0.0 ? 1.0 : -1.0;
  const double acceleration = relative(from.auxiliary_acceleration, s.first, s.second);
  const bool rests = std::abs(velocity) <= 2.0 * resolution_ * std::abs(acceleration) || velocity == 0.0;
  if (!(side * (rests ? acceleration : velocity) > 0.0)) return Watch::limit;
  return side > 0.0 ? Watch::rest_after_positive : Watch::rest_after_negative;
}

GuardValue StructureTimeline::guard(Index guard, const system::State& from, const system::State& to) {
  const Path path = path_of(guard, from, to);
  const auto& slider = system_.sliders()[static_cast<std::size_t>(guard)];
  switch (watch_of(guard, from)) {
    case Watch::limit: {
      const double force = from.slider_force[guard] + slider.stiffness * (path.u1 - path.u0);
      return {slider.limit - std::abs(force), -std::copysign(slider.stiffness, force) * path.v1};
    }
    case Watch::rest_after_positive:
      return {path.v1, path.final_acceleration()};
    case Watch::rest_after_negative:
      return {-path.v1, -path.final_acceleration()};
    case Watch::nothing:
      break;
  }
  return {1.0, 0.0};
}

Crossing StructureTimeline::first_crossing(const system::State& from, const system::State& to, double least) {
  Crossing first;
  first.share = HUGE_VAL;
  for (Index i = 0; i < system_.slider_count(); ++i) {
    if (!(guard(i, from, to).value < 0.0)) continue;
    const Path path = path_of(i, from, to);
    const Watch watch = watch_of(i, from);
    const auto& slider = system_.sliders()[static_cast<std::size_t>(i)];
    const bool is_positive = watch == Watch::limit ? path.u1 > path.u0 : watch == Watch::rest_after_positive;
    const double sign = is_positive ? 1.0 : -1.0;
    const double share = root([&](double s) {
      if (watch != Watch::limit) return sign * path.velocity(s);
      return slider.limit - sign * (from.slider_force[i] + slider.stiffness * (path.displacement(s) - path.u0));
    });
    if (share >= least && share < first.share) first = {i, share};
  }
  return first;
}

}  // namespace rubato::integrate
