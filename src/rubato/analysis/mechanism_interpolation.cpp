#include <rubato/analysis/interpolation.hpp>
#include <rubato/analysis/mechanism_interpolation.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rubato::analysis {

MechanismInterpolation::MechanismInterpolation(const system::Mechanism& mechanism, std::vector<double> kinks)
    : mechanism_(mechanism),
      equations_(mechanism),
      kinks_(std::move(kinks)),
      travel_(mechanism.size()),
      part_(mechanism.size()) {}

void MechanismInterpolation::add(const system::State& state, model::Side side) {
  newest_ = (newest_ + 1) % most_knots;
  count_ = std::min(count_ + 1, most_knots);
  since_kink_ = std::min(since_kink_ + 1, most_knots);
  Knot& newest = knot(0);
  newest.state = state;
  newest.side = side;
  newest.is_balanced = false;
}

void MechanismInterpolation::take(const system::State& before, const system::State& after) {
  // A restart of the march leaves other accelerations, and a lock another phase or other velocities.
  const bool goes_on = count_ > 0 && knot(0).state.t == before.t && knot(0).state.v == before.v &&
                       knot(0).state.phase == before.phase && knot(0).state.rubbing == before.rubbing &&
                       last_acceleration_ == before.acceleration;
  if (!goes_on) {
    count_ = 0;
    add(before, model::Side::right);
  }
  if (!goes_on || std::binary_search(kinks_.begin(), kinks_.end(), before.t)) since_kink_ = 1;
  add(after, model::Side::left);
  last_acceleration_ = after.acceleration;
}

std::size_t MechanismInterpolation::usable() {
  // Beyond half a turn the shortest way to a rotation leads round the other side.
  constexpr double largest_turn = 2.0;
  const auto& is_rotation = mechanism_.model().is_rotation;
  if (mechanism_.model().dimension == 2) return count_;
  for (std::size_t age = 2; age < count_; ++age) {
    mechanism_.difference(knot(1).state.q, knot(age).state.q, part_);
    for (Index i = 0; i < part_.size(); ++i)
      if (is_rotation[static_cast<std::size_t>(i)] != 0 && std::abs(part_[i]) > largest_turn) return age;
  }
  return count_;
}

void MechanismInterpolation::at(double t, system::State& state) {
  const std::size_t count = usable();
  std::array<double, most_knots> times{};
  for (std::size_t age = 0; age < count; ++age) {
    Knot& end = knot(age);
    times[age] = end.state.t;
    if (end.is_balanced) continue;
    const system::State known = end.state;
    if (!integrate::find_acceleration(equations_, end.state, end.side)) end.state = known;
    end.is_balanced = true;
  }
  const system::State& before = knot(1).state;
  state = before;
  state.t = t;
  travel_.setZero();
  for (Vector* values : {&state.v, &state.acceleration, &state.multiplier}) values->setZero();
  for (std::size_t age = 0; age < count; ++age) {
    const double weight = lagrange_weight({times.data(), count}, age, t);
    const system::State& end = knot(age).state;
    mechanism_.difference(before.q, end.q, part_);
    travel_ += weight * part_;
    state.v += weight * end.v;
  }
  const std::size_t smooth = std::min(count, since_kink_);
  for (std::size_t age = 0; age < smooth; ++age) {
    const double weight = lagrange_weight({times.data(), smooth}, age, t);
    state.acceleration += weight * knot(age).state.acceleration;
    state.multiplier += weight * knot(age).state.multiplier;
  }
  mechanism_.retract(before.q, travel_, state.q);
}

}  // namespace rubato::analysis
