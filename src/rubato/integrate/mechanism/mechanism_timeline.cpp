#include <rubato/integrate/mechanism/mechanism_start.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

system::Loads loads_of(const model::Mechanism& model) {
  std::vector<system::LoadTerm> terms;
  for (const auto& force : model.forces) terms.push_back({{force.coordinate}, {1.0}, force.law});
  return system::Loads(std::move(terms));
}

/// Cubic through values and slopes at both ends of [0, 1].
double cubic(double x, double y0, double slope0, double y1, double slope1) {
  const double rest = 1.0 - x;
  return rest * rest * ((1.0 + 2.0 * x) * y0 + x * slope0) + x * x * ((1.0 + 2.0 * rest) * y1 - rest * slope1);
}

}  // namespace

MechanismTimeline::MechanismTimeline(const system::Mechanism& mechanism, double resolution)
    : mechanism_(mechanism),
      equations_(mechanism),
      resolution_(resolution),
      loads_(loads_of(mechanism.model())),
      left_(mechanism.size()),
      right_(mechanism.size()),
      padded_(static_cast<std::size_t>(mechanism.size()) + 1, 0.0) {
  std::vector<Index> first_row;
  Index rows = 0;
  for (const auto& joint : mechanism.model().joints) {
    first_row.push_back(rows);
    rows += joint->rows();
  }
  for (const auto& lock : mechanism.model().locks)
    row_.push_back(lock.is_rigid() ? first_row[static_cast<std::size_t>(lock.joint)] : -1);
}

std::vector<double> MechanismTimeline::breakpoints(double from, double to) const {
  return loads_.breakpoints(from, to);
}

bool MechanismTimeline::jumps_at(double t) {
  loads_.evaluate(t, left_, model::Side::left);
  loads_.evaluate(t, right_, model::Side::right);
  return !((right_ - left_).norm() <= 1e-12 * (right_.norm() + left_.norm()));
}

void MechanismTimeline::restart(system::State& state) {
  (void)find_acceleration(equations_, state, model::Side::right);
  release(state);
}

void MechanismTimeline::release(system::State& state) {
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (row_[i] < 0 || !is_watched(i, state) || state.phase[i] != model::lock_engaged) continue;
    if (!(guard_at(i, state).value < 0.0)) continue;
    state.phase[i] = model::lock_open;
    events_.push_back({state.t, static_cast<int>(i), false, 0.0});
    (void)find_acceleration(equations_, state, model::Side::right);
  }
}

bool MechanismTimeline::is_watched(std::size_t lock, const system::State& state) const {
  return !(mechanism_.model().locks[lock].is_latch && state.phase[lock] == model::lock_engaged);
}

GuardValue MechanismTimeline::guard_at(std::size_t i, const system::State& state) {
  const model::Lock& lock = mechanism_.model().locks[i];
  std::copy(state.v.data(), state.v.data() + state.v.size(), padded_.data() + 1);
  const model::Motion motion{state.t, model::Side::left, state.q.data(), padded_.data() + 1, state.phase.data()};
  const double s = lock.s.value(state.q.data()), rate = lock.s.rate(motion);
  if (state.phase[i] == model::lock_open) return {lock.sign * (lock.at - s), -lock.sign * rate};
  if (row_[i] >= 0) return {lock.sign * state.multiplier[row_[i]], 0.0};
  double second_rate = 0.0;  // of an angle; close enough for a displacement, whose slope turns slowly
  double slope[6];
  lock.s.slope(state.q.data(), slope);
  const auto places = lock.s.places();
  for (std::size_t k = 0; k < places.size(); ++k)
    if (places[k] != ground) second_rate += slope[k] * state.acceleration[places[k]];
  return {lock.sign * (lock.stiffness * (s - lock.at) + lock.damping * rate),
          lock.sign * (lock.stiffness * rate + lock.damping * second_rate)};
}

Crossing MechanismTimeline::first_crossing(const system::State& from, const system::State& to, double least) {
  Crossing first;
  const double h = to.t - from.t;
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (!is_watched(i, from)) continue;
    const GuardValue a = guard_at(i, from);
    const GuardValue b = guard_at(i, to);
    const bool has_slope = row_[i] < 0 || from.phase[i] == model::lock_open;
    const double slope0 = has_slope ? h * a.rate : b.value - a.value, slope1 = has_slope ? h * b.rate : slope0;
    // A coordinate may cross and come back within a step: the cubic is searched in parts.
    constexpr int parts = 8;
    double low = least, at_low = cubic(least, a.value, slope0, b.value, slope1);
    for (int part = 1; part <= parts; ++part) {
      const double high = std::max(least, static_cast<double>(part) / parts);
      const double at_high = part == parts ? b.value : cubic(high, a.value, slope0, b.value, slope1);
      if (at_high < 0.0 && at_high < at_low) {
        double left = low, right = high;
        for (int k = 0; k < 50 && at_low > 0.0; ++k) {
          const double middle = 0.5 * (left + right);
          (cubic(middle, a.value, slope0, b.value, slope1) > 0.0 ? left : right) = middle;
        }
        const double share = at_low > 0.0 ? right : low;
        if (first.guard < 0 || share < first.share) first = {static_cast<Index>(i), std::min(share, 1.0)};
        break;
      }
      low = high;
      at_low = at_high;
    }
  }
  return first;
}

GuardValue MechanismTimeline::guard(Index guard, const system::State& from, const system::State& to) {
  const auto i = static_cast<std::size_t>(guard);
  GuardValue value = guard_at(i, to);
  if (row_[i] >= 0 && from.phase[i] == model::lock_engaged)
    value.rate = (value.value - guard_at(i, from).value) / (to.t - from.t);
  return value;
}

bool MechanismTimeline::pass(const system::State& before, system::State& state, double shift) {
  bool jumps = false;
  const std::vector<int> old = state.phase;
  Vector product;
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (!is_watched(i, before)) continue;
    GuardValue now = guard(static_cast<Index>(i), before, state);
    if (!(now.value <= resolution_ * std::abs(now.rate) && now.rate <= 0.0)) continue;
    const bool engages = state.phase[i] == model::lock_open;
    state.phase[i] = engages ? model::lock_engaged : model::lock_open;
    events_.push_back({state.t, static_cast<int>(i), engages, 0.0});
    const model::Lock& lock = mechanism_.model().locks[i];
    jumps = jumps || lock.is_rigid() || lock.is_latch || lock.damping > 0.0;
    if (!engages || !lock.is_rigid()) continue;
    const ConsistentStart projected = make_consistent(equations_, state, model::Side::right);
    if (!projected.is_consistent) continue;  // the next step fails, and says where
    events_.back().energy_lost = projected.energy_lost;
    state = projected.state;
  }
  if (!find_acceleration(equations_, state, model::Side::right)) return true;
  release(state);
  shift_acceleration(equations_, state, shift);
  return jumps;
}

}  // namespace rubato::integrate
