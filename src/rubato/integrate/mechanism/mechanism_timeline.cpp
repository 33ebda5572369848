#include <rubato/integrate/mechanism/friction_phases.hpp>
#include <rubato/integrate/mechanism/mechanism_start.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>
#include <rubato/model/time_kinks.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::integrate {
namespace {

system::Loads loads_of(const model::Mechanism& model) {
  std::vector<system::LoadTerm> terms;
  for (const auto& force : model.forces) terms.push_back({{force.coordinate}, {1.0}, force.law});
  // Only when they are not smooth is asked: any coordinate serves.
  for (const auto& law : model.following_laws) terms.push_back({{0}, {1.0}, law});
  return system::Loads(std::move(terms));
}

/// Cubic through values and slopes at both ends of [0, 1].
double cubic(double x, double y0, double slope0, double y1, double slope1) {
  const double rest = 1.0 - x;
  return rest * rest * ((1.0 + 2.0 * x) * y0 + x * slope0) + x * x * ((1.0 + 2.0 * rest) * y1 - rest * slope1);
}

bool pulls(int phase) { return phase == model::friction_pulls_up || phase == model::friction_pulls_down; }

}  // namespace

MechanismTimeline::MechanismTimeline(const system::Mechanism& mechanism, double resolution)
    : mechanism_(mechanism),
      equations_(mechanism),
      resolution_(resolution),
      loads_(loads_of(mechanism.model())),
      left_(mechanism.size()),
      right_(mechanism.size()),
      padded_(static_cast<std::size_t>(mechanism.size()) + 1, 0.0),
      padded_acceleration_(padded_) {
  transitions_.resize(mechanism.model().locks.size() + mechanism.model().frictions.size());
  for (const auto& lock : mechanism.model().locks)
    row_.push_back(lock.is_rigid() ? mechanism.first_row(lock.joint) : -1);
  for (const auto& lock : mechanism.model().locks) {
    const auto& frictions = mechanism.model().frictions;
    const auto is_of_it = [&](const model::JointFriction& friction) { return friction.name == lock.name; };
    const auto found = std::find_if(frictions.begin(), frictions.end(), is_of_it);
    friction_of_.push_back(found == frictions.end() ? -1 : static_cast<int>(found - frictions.begin()));
  }
}

std::vector<double> MechanismTimeline::breakpoints(double from, double to) const {
  std::vector<double> times = loads_.breakpoints(from, to);
  std::vector<double> switches;
  for (const auto& drive : mechanism_.model().drives) {
    if (const auto* table = std::get_if<model::TableLaw>(&drive.law)) {
      for (const double t : table->times)
        if (t > from && t < to) times.push_back(t);
    } else {
      const std::vector<double> found =
          model::with_eighths(std::get<numerics::TimeFormula>(drive.law).switches(from, to));
      switches.insert(switches.end(), found.begin(), found.end());
    }
  }
  joint_switches_.clear();
  for (const auto& formula : mechanism_.model().joint_formulas) {
    const std::vector<double> found = formula.switches(from, to), pieces = model::with_eighths(found);
    joint_switches_.insert(joint_switches_.end(), found.begin(), found.end());
    switches.insert(switches.end(), pieces.begin(), pieces.end());
  }
  std::sort(joint_switches_.begin(), joint_switches_.end());
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::sort(switches.begin(), switches.end());
  numerics::add_switches(switches, from, to, times);
  return times;
}

bool MechanismTimeline::jumps_at(double t) {
  loads_.evaluate(t, left_, model::Side::left);
  loads_.evaluate(t, right_, model::Side::right);
  return !((right_ - left_).norm() <= 1e-12 * (right_.norm() + left_.norm())) || has_drive_jump(t) ||
         is_joint_switch(t);
}

bool MechanismTimeline::is_joint_switch(double t) const {
  const double same_time = 16.0 * std::numeric_limits<double>::epsilon() * std::abs(t);
  const auto found = std::lower_bound(joint_switches_.begin(), joint_switches_.end(), t - same_time);
  return found != joint_switches_.end() && *found <= t + same_time;
}

bool MechanismTimeline::has_drive_jump(double t) const {
  for (const auto& drive : mechanism_.model().drives) {
    const double before = model::derivatives(drive.law, t, model::Side::left).rate;
    const double after = model::derivatives(drive.law, t, model::Side::right).rate;
    if (!(std::abs(after - before) <= 1e-12 * (std::abs(after) + std::abs(before)))) return true;
  }
  return false;
}

bool MechanismTimeline::project(system::State& state, double& energy_lost) {
  std::fill(state.rubbing.begin(), state.rubbing.end(), model::friction_free);
  const ConsistentStart projected = make_consistent(equations_, state, model::Side::right);
  if (!projected.is_consistent) return false;
  energy_lost = projected.energy_lost;
  impulsive_work_ += projected.drive_work;
  state = projected.state;
  return true;
}

bool MechanismTimeline::restart(system::State& state) {
  const std::vector<int> old = state.rubbing;
  double energy_lost = 0.0;
  bool goes_on = false;
  if (has_drive_jump(state.t))
    goes_on = project(state, energy_lost) && settle_new_velocities(equations_, state);
  else
    goes_on = settle_friction(equations_, state, std::vector<char>(old.size(), 0));
  note_friction(old, state);
  return goes_on && release(state);
}

void MechanismTimeline::note_friction(const std::vector<int>& old, const system::State& state) {
  for (std::size_t i = 0; i < old.size(); ++i) {
    if (equations_.is_led(i)) continue;
    const bool rests = model::is_at_rest(state.rubbing[i]);
    if (model::is_at_rest(old[i]) != rests) events_.push_back({state.t, -1, rests, 0.0, static_cast<int>(i)});
  }
}

void MechanismTimeline::count_transition(std::size_t guard, const system::State& state) {
  constexpr int most = 100;
  constexpr double window = 1e9;  // over the resolution, 1e-12 of the run
  constexpr double still = 1e-9;  // ten times what Newton's method leaves of positions
  const auto& model = mechanism_.model();
  const model::FreeCoordinate& s = guard < row_.size() ? model.locks[guard].s : model.frictions[guard - row_.size()].s;
  const double value = s.value(state.q.data());
  const double size = s.is_angle() ? 1.0 : 1.0 + state.q.cwiseAbs().maxCoeff();
  Transitions& past = transitions_[guard];
  if (!(std::abs(value - past.at) <= still * size && state.t - past.since <= window * resolution_))
    past = {state.t, value, 0};
  if (++past.count > most) chattering_ = static_cast<Index>(guard);
}

MechanismTimeline::Rubbing MechanismTimeline::rubbing_after(const system::State& before, system::State& state) {
  Rubbing result;
  result.candidates.assign(state.rubbing.size(), 0);
  result.at_limit = result.candidates;
  const std::vector<int> old = state.rubbing;
  const bool has_pulling = std::any_of(old.begin(), old.end(), pulls);
  for (std::size_t i = 0; i < old.size(); ++i) {
    if (old[i] == model::friction_free || pulls(old[i]) || equations_.is_led(i)) continue;
    const GuardValue now = guard(static_cast<Index>(row_.size() + i), before, state);
    if (!(now.value <= resolution_ * std::abs(now.rate) && now.rate <= 0.0)) continue;
    result.has_changed = true;
    const bool is_pair = mechanism_.model().frictions[i].partner >= 0;
    if (is_pair && old[i] != model::friction_sticks && turns_away(i, state)) continue;
    count_transition(row_.size() + i, state);
    if (old[i] != model::friction_sticks) {
      result.candidates[i] = 1;
    } else if (has_pulling || is_pair) {  // it may have held against what pulls, which can give way first
      for (std::size_t k = 0; k < old.size(); ++k) result.at_limit[k] = result.at_limit[k] || k == i || pulls(old[k]);
      result.candidates[i] = 1;
    } else {
      const double force = balanced_friction(i, state);
      state.rubbing[i] = force < 0.0 ? model::friction_slides_up : model::friction_slides_down;
    }
  }
  return result;
}

double MechanismTimeline::balanced_friction(std::size_t i, const system::State& state) {
  balanced_ = state;
  if (!find_acceleration(equations_, balanced_, model::Side::left)) return 0.0;
  return equations_.friction_force(i, balanced_.multiplier);
}

bool MechanismTimeline::turns_away(std::size_t i, system::State& state) {
  constexpr double rest = 5.0 * model::slip_floor_share;  // what the floor may leave across
  const auto first = static_cast<Index>(i), second = static_cast<Index>(mechanism_.model().frictions[i].partner);
  equations_.go_to(state, model::Side::left);
  const Eigen::Vector2d slip = equations_.slip_velocity(i);
  const double before = std::hypot(state.stuck_at[first], state.stuck_at[second]) / model::slip_floor_share;
  if (slip.norm() <= rest * before) return false;
  state.stuck_at[first] = model::slip_floor_share * slip[0];
  state.stuck_at[second] = model::slip_floor_share * slip[1];
  return true;
}

model::Motion MechanismTimeline::motion_of(const system::State& state) {
  std::copy(state.v.data(), state.v.data() + state.v.size(), padded_.data() + 1);
  std::copy(state.acceleration.data(), state.acceleration.data() + state.acceleration.size(),
            padded_acceleration_.data() + 1);
  return {state.t,
          model::Side::left,
          state.q.data(),
          padded_.data() + 1,
          state.phase.data(),
          state.rubbing.data(),
          state.stuck_at.data()};
}

GuardValue MechanismTimeline::friction_guard(std::size_t i, const system::State& state, const Vector& floors) {
  if (state.rubbing[i] == model::friction_sticks) {
    balanced_ = state;
    if (!find_acceleration(equations_, balanced_, model::Side::left))
      return {equations_.friction_limit(i, balanced_.multiplier), 0.0};
    return {equations_.friction_limit(i, balanced_.multiplier) - equations_.friction_size(i, balanced_.multiplier),
            0.0};
  }
  if (const int other = mechanism_.model().frictions[i].partner; other >= 0) {
    const Eigen::Vector2d way = Eigen::Vector2d(floors[static_cast<Index>(i)], floors[other]).normalized();
    equations_.go_to(state, model::Side::left);
    return {way.dot(equations_.slip_velocity(i)), way.dot(equations_.slip_acceleration(i, state.acceleration))};
  }
  const auto& s = mechanism_.model().frictions[i].s;
  const double direction = model::sliding_direction(state.rubbing[i]);
  const model::Motion motion = motion_of(state);
  return {direction * s.rate(motion), direction * s.second_rate(motion, padded_acceleration_.data() + 1)};
}

bool MechanismTimeline::release(system::State& state) {
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (row_[i] < 0 || !is_watched(i, state) || state.phase[i] != model::lock_engaged) continue;
    if (!(guard_at(i, state, state.stuck_at).value < 0.0)) continue;
    state.phase[i] = model::lock_open;
    events_.push_back({state.t, static_cast<int>(i), false, 0.0});
    const std::vector<int> old = state.rubbing;
    if (!settle_friction(equations_, state, std::vector<char>(old.size(), 0))) return false;
    note_friction(old, state);
  }
  return true;
}

bool MechanismTimeline::is_watched(std::size_t lock, const system::State& state) const {
  if (lock < row_.size() && friction_of_[lock] >= 0 && state.phase[lock] == model::lock_open &&
      model::is_at_rest(state.rubbing[static_cast<std::size_t>(friction_of_[lock])]))
    return false;  // what sticks at its stop lies beyond it by round-off, and comes no nearer
  if (lock >= row_.size() && (pulls(state.rubbing[lock - row_.size()]) || equations_.is_led(lock - row_.size())))
    return false;
  return lock >= row_.size() || !(mechanism_.model().locks[lock].is_latch && state.phase[lock] == model::lock_engaged);
}

bool MechanismTimeline::has_rate(std::size_t i, const system::State& from) const {
  if (i >= row_.size()) return from.rubbing[i - row_.size()] != model::friction_sticks;
  return row_[i] < 0 || from.phase[i] == model::lock_open;
}

GuardValue MechanismTimeline::guard_at(std::size_t i, const system::State& state, const Vector& floors) {
  if (i >= row_.size()) return friction_guard(i - row_.size(), state, floors);
  const model::Lock& lock = mechanism_.model().locks[i];
  const model::Motion motion = motion_of(state);
  const double s = lock.s.value(state.q.data()), rate = lock.s.rate(motion);
  if (state.phase[i] == model::lock_open) return {lock.sign * (lock.at - s), -lock.sign * rate};
  if (row_[i] >= 0) return {lock.sign * state.multiplier[row_[i]], 0.0};
  const double second_rate = lock.s.second_rate(motion, padded_acceleration_.data() + 1);
  return {lock.sign * (lock.stiffness * (s - lock.at) + lock.damping * rate),
          lock.sign * (lock.stiffness * rate + lock.damping * second_rate)};
}

Crossing MechanismTimeline::first_crossing(const system::State& from, const system::State& to, double least) {
  Crossing first;
  const double h = to.t - from.t;
  for (std::size_t i = 0; i < row_.size() + from.rubbing.size(); ++i) {
    if (!is_watched(i, from)) continue;
    const GuardValue a = guard_at(i, from, to.stuck_at);  // both ends by the floors of the step
    const GuardValue b = guard_at(i, to, to.stuck_at);
    const bool has_slope = has_rate(i, from);
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
  GuardValue value = guard_at(i, to, to.stuck_at);
  if (!has_rate(i, from)) value.rate = (value.value - guard_at(i, from, to.stuck_at).value) / (to.t - from.t);
  return value;
}

Passage MechanismTimeline::pass(const system::State& before, system::State& state, double shift) {
  const std::vector<int> old = state.rubbing;
  const Rubbing rubbing = rubbing_after(before, state);
  bool jumps = rubbing.has_changed, has_impact = false;
  for (std::size_t i = 0; i < row_.size(); ++i) {
    if (!is_watched(i, before)) continue;
    GuardValue now = guard(static_cast<Index>(i), before, state);
    if (!(now.value <= resolution_ * std::abs(now.rate) && now.rate <= 0.0)) continue;
    count_transition(i, state);
    const bool engages = state.phase[i] == model::lock_open;
    state.phase[i] = engages ? model::lock_engaged : model::lock_open;
    events_.push_back({state.t, static_cast<int>(i), engages, 0.0});
    const model::Lock& lock = mechanism_.model().locks[i];
    jumps = jumps || lock.is_rigid() || lock.is_latch || lock.damping > 0.0;
    if (!engages && !lock.is_rigid() && lock.damping > 0.0) {
      const double depth = lock.s.value(state.q.data()) - lock.at;
      events_.back().energy_lost = 0.5 * lock.stiffness * depth * depth;
    }
    if (!engages || !lock.is_rigid()) continue;
    if (!project(state, events_.back().energy_lost)) return Passage::fails;
    has_impact = true;
  }
  const bool is_settled = has_impact ? settle_new_velocities(equations_, state)
                                     : settle_friction(equations_, state, rubbing.candidates, rubbing.at_limit);
  note_friction(old, state);
  if (!is_settled || !release(state) || chattering_ >= 0) return Passage::fails;
  shift_acceleration(equations_, state, shift);
  return jumps ? Passage::restarts : Passage::continues;
}

}  // namespace rubato::integrate
