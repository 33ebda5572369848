#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/mechanism/friction_release.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>

#include <algorithm>
#include <cmath>

// What a step of a mechanism does to the friction in its joints.
namespace rubato::integrate {

void MechanismTimeline::note_standing_drives(double t) {
  stands_.clear();
  for (const auto& drive : mechanism_.model().drives)
    stands_.push_back(model::derivatives(drive.law, t, model::Side::right).rate == 0.0);
}

bool MechanismTimeline::has_started_drive(double t) const {
  constexpr double slow = 1e-6;  // of a radian or metre in the time of the run
  const auto& drives = mechanism_.model().drives;
  for (std::size_t k = 0; k < stands_.size(); ++k) {
    const double rate = stands_[k] ? model::derivatives(drives[k].law, t, model::Side::left).rate : 0.0;
    if (std::abs(rate) * 1e12 * resolution_ > slow) return true;
  }
  return false;
}

void MechanismTimeline::note_friction(const std::vector<int>& old, const system::State& state) {
  for (std::size_t i = 0; i < old.size(); ++i) {
    if (equations_.is_led(i)) continue;
    const bool rests = model::is_at_rest(state.rubbing[i]);
    if (model::is_at_rest(old[i]) != rests) events_.push_back({state.t, -1, rests, 0.0, static_cast<int>(i)});
  }
}

MechanismTimeline::Rubbing MechanismTimeline::rubbing_after(const system::State& before, system::State& state) {
  Rubbing result;
  result.candidates.assign(state.rubbing.size(), 0);
  result.at_limit = result.candidates;
  std::vector<std::size_t> reached;
  std::size_t resting = 0;
  for (std::size_t i = 0; i < state.rubbing.size(); ++i) {
    if (equations_.is_led(i)) continue;
    resting += model::is_at_rest(state.rubbing[i]) ? 1 : 0;
    if (!is_watched(row_.size() + i, before)) continue;
    const GuardValue now = guard(static_cast<Index>(row_.size() + i), before, state);
    if (now.value <= resolution_ * std::abs(now.rate) && now.rate <= 0.0) reached.push_back(i);
  }
  result.has_changed = !reached.empty();
  for (const std::size_t i : reached) {
    if (state.rubbing[i] == model::friction_free) {
      slide_with_drives(i, state);
      continue;
    }
    const bool is_pair = mechanism_.model().frictions[i].partner >= 0;
    const bool has_stuck = state.rubbing[i] == model::friction_sticks;
    if (is_pair && !has_stuck && turns_away(i, state)) continue;
    count_transition(row_.size() + i, state);
    if (!has_stuck || is_pair || resting > 1) {
      result.candidates[i] = 1;
    } else {
      forget_balances();
      const Balanced& now = balanced(state);
      const double force = now.is_found ? equations_.friction_force(i, now.state.multiplier) : 0.0;
      state.rubbing[i] = force < 0.0 ? model::friction_slides_up : model::friction_slides_down;
    }
    if (!has_stuck) continue;
    result.at_limit[i] = 1;
    for (std::size_t k = 0; k < state.rubbing.size(); ++k)  // a friction at its limit may give way first
      result.at_limit[k] = result.at_limit[k] || is_at_limit(state.rubbing[k]);
  }
  return result;
}

void MechanismTimeline::slide_with_drives(std::size_t i, system::State& state) {
  const ConsistentStart moving = make_consistent(equations_, state, model::Side::left);
  if (!moving.is_consistent) return;  // then it is decided what it does, or found that nothing goes on
  state = moving.state;
  equations_.go_to(state, model::Side::left);
  if (const int other = mechanism_.model().frictions[i].partner; other < 0) {
    state.rubbing[i] = equations_.friction_rate(i) > 0.0 ? model::friction_slides_up : model::friction_slides_down;
  } else {
    set_friction_phase(mechanism_.model(), state, i, model::friction_slides_up);
    set_slip_floor(mechanism_.model(), state, i, model::slip_floor_share * equations_.slip_velocity(i));
  }
}

bool MechanismTimeline::turns_away(std::size_t i, system::State& state) {
  constexpr double rest = 5.0 * model::slip_floor_share;  // what the floor may leave across
  const auto first = static_cast<Index>(i), second = static_cast<Index>(mechanism_.model().frictions[i].partner);
  equations_.go_to(state, model::Side::left);
  const Eigen::Vector2d slip = equations_.slip_velocity(i), floor(state.stuck_at[first], state.stuck_at[second]);
  const Eigen::Vector2d along = floor.normalized();
  const Eigen::Vector2d across = slip - along.dot(slip) * along;  // what goes back is of the shortest step
  if (across.norm() <= rest * floor.norm() / model::slip_floor_share) return false;
  state.stuck_at[first] = model::slip_floor_share * slip[0];
  state.stuck_at[second] = model::slip_floor_share * slip[1];
  return true;
}

GuardValue MechanismTimeline::friction_guard(std::size_t i, const system::State& state, const Vector& floors) {
  if (state.rubbing[i] == model::friction_free) return {has_started_drive(state.t) ? -1.0 : 1.0, 0.0};
  if (state.rubbing[i] == model::friction_sticks) {
    const Balanced& now = balanced(state);
    if (!now.is_found)  // nothing goes with these phases
      return {-std::abs(equations_.friction_limit(i, state.multiplier)), 0.0};
    const Vector& multiplier = now.state.multiplier;
    // Beyond what counts as no excess when it is decided that it sticks: joints may be at their limits for long.
    constexpr double clearly = 1e-9;
    const double beyond = clearly * equations_.friction_size(i, multiplier) + 2.0 * equations_.negligible_friction(i);
    return {equations_.friction_limit(i, multiplier) + beyond - equations_.friction_size(i, multiplier), 0.0};
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

}  // namespace rubato::integrate
