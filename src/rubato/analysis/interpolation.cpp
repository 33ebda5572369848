#include <rubato/analysis/interpolation.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::analysis {
namespace {

/// sum = weight x, or more of it
void add_share(bool is_first, double weight, const Vector& x, Vector& sum) {
  if (is_first)
    sum = weight * x;
  else
    sum += weight * x;
}

}  // namespace

double lagrange_weight(std::span<const double> times, std::size_t i, double t) {
  double weight = 1.0;
  for (std::size_t j = 0; j < times.size(); ++j)
    if (j != i) weight *= (t - times[j]) / (times[i] - times[j]);
  return weight;
}

StepInterpolation::StepInterpolation(const system::System& system, integrate::Balance& balance, int order,
                                     std::vector<double> kinks)
    : system_(system),
      balance_(balance),
      is_quintic_(order > 2 && system.is_flat()),
      kinks_(std::move(kinks)),
      travel_(system.size()),
      part_(system.size()) {}

void StepInterpolation::add(const system::State& state, model::Side side) {
  newest_ = (newest_ + 1) % most_knots;
  count_ = std::min(count_ + 1, most_knots);
  since_kink_ = std::min(since_kink_ + 1, most_knots);
  Knot& newest = knot(0);
  newest.state = state;
  newest.side = side;
  newest.is_balanced = false;
}

bool StepInterpolation::goes_on(const system::State& before) {
  if (is_quintic_ || count_ == 0) return false;
  // A restart of the march leaves other accelerations, a lock another phase or other velocities, and the force of a
  // damped stop may jump.
  const system::State& last = knot(0).state;
  return last.t == before.t && last.v == before.v && last.slider_force == before.slider_force &&
         last.phase == before.phase && last.rubbing == before.rubbing && last_acceleration_ == before.acceleration &&
         !balance_.loads_jump(before.t);
}

void StepInterpolation::take(const system::State& before, const system::State& after) {
  const bool is_new = !goes_on(before);
  if (is_new) {
    count_ = 0;
    add(before, model::Side::right);
  }
  if (is_new || std::binary_search(kinks_.begin(), kinks_.end(), before.t)) since_kink_ = 1;
  add(after, model::Side::left);
  last_acceleration_ = after.acceleration;
}

std::size_t StepInterpolation::usable() {
  const double largest = system_.largest_turn();
  if (std::isinf(largest)) return count_;
  for (std::size_t age = 2; age < count_; ++age) {
    system_.difference(knot(1).state.q, knot(age).state.q, part_);
    for (Index i = 0; i < part_.size(); ++i)
      if (system_.is_rotation(i) && std::abs(part_[i]) > largest) return age;
  }
  return count_;
}

void StepInterpolation::at(double t, system::State& state) {
  const std::size_t count = usable();
  for (std::size_t age = 0; age < count; ++age) {
    Knot& end = knot(age);
    if (!end.is_balanced) balance_.find_acceleration(end.state, end.side);
    end.is_balanced = true;
  }
  const system::State& before = knot(1).state;
  state = before;
  state.t = t;
  if (is_quintic_)
    through_ends(t, state);
  else
    through_knots(count, t, state);
  balance_.find_contact_forces(before, state);
  if (is_quintic_) balance_.find_acceleration(state, model::Side::left);
}

void StepInterpolation::through_knots(std::size_t count, double t, system::State& state) {
  std::array<double, most_knots> times{};
  for (std::size_t age = 0; age < count; ++age) times[age] = knot(age).state.t;
  const bool is_flat = system_.is_flat();
  const Vector& from = knot(1).state.q;
  for (std::size_t age = 0; age < count; ++age) {
    const double weight = lagrange_weight({times.data(), count}, age, t);
    const system::State& end = knot(age).state;
    add_share(age == 0, weight, end.v, state.v);
    if (is_flat) {
      add_share(age == 0, weight, end.q, state.q);
    } else {
      system_.difference(from, end.q, part_);
      add_share(age == 0, weight, part_, travel_);
    }
  }
  if (!is_flat) system_.retract(from, travel_, state.q);
  const std::size_t smooth = std::min(count, since_kink_);
  std::array<integrate::WeighedEnd, most_knots> ends{};
  for (std::size_t age = 0; age < smooth; ++age) {
    const double weight = lagrange_weight({times.data(), smooth}, age, t);
    ends[age] = {times[age], knot(age).side, weight};
    add_share(age == 0, weight, knot(age).state.acceleration, state.acceleration);
    add_share(age == 0, weight, knot(age).state.multiplier, state.multiplier);
  }
  balance_.add_swing_of_loads({ends.data(), smooth}, state);
}

void StepInterpolation::through_ends(double t, system::State& state) {
  const system::State &from = knot(1).state, &to = knot(0).state;
  const Vector &a0 = from.acceleration, &a1 = to.acceleration;
  const double h = to.t - from.t, s = (t - from.t) / h, s2 = s * s, s3 = s2 * s;
  // Quintic Hermite basis: what each end value contributes at s, and its derivatives with respect to s.
  const double q1 = s3 * (10.0 + s * (-15.0 + 6.0 * s)), q0 = 1.0 - q1;
  const double v0 = s + s3 * (-6.0 + s * (8.0 - 3.0 * s)), v1 = s3 * (-4.0 + s * (7.0 - 3.0 * s));
  const double c0 = 0.5 * s2 * (1.0 + s * (-3.0 + s * (3.0 - s))), c1 = 0.5 * s3 * (1.0 + s * (-2.0 + s));
  const double dq1 = 30.0 * s2 * (1.0 + s * (-2.0 + s));
  const double dv0 = 1.0 + s2 * (-18.0 + s * (32.0 - 15.0 * s)), dv1 = s2 * (-12.0 + s * (28.0 - 15.0 * s));
  const double dc0 = s + s2 * (-4.5 + s * (6.0 - 2.5 * s)), dc1 = s2 * (1.5 + s * (-4.0 + 2.5 * s));
  state.q = q0 * from.q + q1 * to.q + h * (v0 * from.v + v1 * to.v) + (h * h) * (c0 * a0 + c1 * a1);
  state.v = (dq1 / h) * (to.q - from.q) + dv0 * from.v + dv1 * to.v + h * (dc0 * a0 + dc1 * a1);
}

}  // namespace rubato::analysis
