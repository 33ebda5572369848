#include <rubato/integrate/mechanism/held_frictions.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rubato::integrate {
namespace {

/// ds/dq [n].
Vector slope_of(const model::FreeCoordinate& s, const system::State& state) {
  const std::vector<Index> places = s.places();
  std::vector<double> slope(places.size());
  s.slope(state.q.data(), slope.data());
  Vector all = Vector::Zero(state.v.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i] != ground) all[places[i]] += slope[i];
  return all;
}

}  // namespace

bool find_friction_mobilities(system::MechanismEquations& equations, const system::State& state,
                              const std::vector<std::size_t>& frictions, std::vector<FrictionMobility>& found) {
  constexpr double driven = 1e-8;  // of a radian or metre for one of the drive
  const auto& mechanism = equations.mechanism();
  const auto& model = mechanism.model();
  Vector motion(mechanism.size()), impulse(mechanism.constraint_count());
  equations.go_to(state, model::Side::right);
  equations.linearise({}, state.multiplier, motion, impulse);
  if (!equations.factorise()) return false;
  Vector by_time(impulse.size()), rate(impulse.size()), correction(motion.size());
  equations.constraint_rate(Vector::Zero(motion.size()), by_time);
  found.clear();
  for (const std::size_t friction : frictions) {
    const Vector slope = slope_of(model.frictions[friction].s, state);
    motion = slope;
    impulse.setZero();
    equations.solve(motion, impulse);
    for (int round = 0; round < 2; ++round) {  // each removes what the share E of the multipliers leaves
      equations.constraint_rate(motion, rate);
      rate = by_time - rate;
      correction.setZero();
      equations.solve(correction, rate);
      motion += correction;
      impulse += rate;
    }
    FrictionMobility of{slope, motion, {}};
    for (const auto& drive : model.drives)  // by reciprocity: what the drive would move of s
      of.driven.push_back(!(std::abs(impulse[mechanism.first_row(drive.joint)]) <= driven));
    found.push_back(of);
  }
  return true;
}

std::vector<char> held_frictions(system::MechanismEquations& equations, const system::State& state) {
  // Axes that lie in one to four digits count as one: rows at an angle leave its square.
  constexpr double same_axis = 1e-8, round_off = 1e-12;
  const auto& model = equations.mechanism().model();
  std::vector<char> is_held(model.frictions.size(), 0);
  std::vector<std::size_t> sliding;
  system::State open = state;
  bool holds = false;
  for (std::size_t i = 0; i < is_held.size(); ++i) {
    if (model::sliding_direction(state.rubbing[i]) != 0.0) sliding.push_back(i);
    if (state.rubbing[i] != model::friction_sticks) continue;
    holds = true;
    open.rubbing[i] = model::friction_free;
  }
  for (std::size_t lock = 0; lock < model.locks.size(); ++lock) {
    if (state.phase[lock] != model::lock_engaged || !model.locks[lock].is_rigid()) continue;
    holds = true;
    open.phase[lock] = model::lock_open;
  }
  if (!holds || sliding.empty()) return is_held;
  std::vector<FrictionMobility> now, without;
  if (!find_friction_mobilities(equations, state, sliding, now) ||
      !find_friction_mobilities(equations, open, sliding, without))
    return {};
  const Vector masses = equations.mechanism().mass().diagonal();
  for (std::size_t i = 0; i < sliding.size(); ++i) {
    const double alone = now[i].slope.cwiseAbs2().cwiseQuotient(masses).sum(), free = without[i].of(without[i]);
    const bool is_driven = std::count(now[i].driven.begin(), now[i].driven.end(), 1) > 0;
    const bool may_move = free > round_off * alone;  // not so in a dead centre, through which it goes on
    is_held[sliding[i]] = !is_driven && may_move && now[i].of(now[i]) <= std::max(same_axis * free, round_off * alone);
  }
  return is_held;
}

std::vector<char> frictions_held_by_drives(system::MechanismEquations& equations, const system::State& state,
                                           double ahead) {
  constexpr double nothing = 1e-10;  // of the mobility without any joint
  const auto& model = equations.mechanism().model();
  const std::size_t count = model.frictions.size();
  std::vector<char> is_held(count, 0), stands;
  for (const auto& drive : model.drives) {
    const auto is_still = [&](double t) {
      const auto motion = model::derivatives(drive.law, t, model::Side::right);
      return motion.rate == 0.0 && motion.second_rate == 0.0;
    };
    stands.push_back(is_still(state.t) && is_still(state.t + ahead));
  }
  const auto standing = static_cast<std::size_t>(std::count(stands.begin(), stands.end(), 1));
  if (count == 0 || standing == 0) return is_held;
  const bool all_stand = standing == stands.size();
  system::State open = state;
  std::fill(open.rubbing.begin(), open.rubbing.end(), model::friction_free);
  std::vector<std::size_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  std::vector<FrictionMobility> found;
  if (!find_friction_mobilities(equations, open, all, found)) return is_held;
  const Vector masses = equations.mechanism().mass().diagonal();
  for (std::size_t i = 0; i < count; ++i) {
    const double alone = found[i].slope.cwiseAbs2().cwiseQuotient(masses).sum();
    bool is_driven = all_stand, is_moved = false;  // in a dead centre no drive seems to move it
    for (std::size_t k = 0; k < stands.size(); ++k) {
      is_driven = is_driven || found[i].driven[k];
      is_moved = is_moved || (found[i].driven[k] && !stands[k]);
    }
    is_held[i] = is_driven && !is_moved && found[i].of(found[i]) <= nothing * alone;
  }
  for (std::size_t i = 0; i < count; ++i)
    if (const int other = model.frictions[i].partner; other >= 0)
      is_held[i] = is_held[i] && is_held[static_cast<std::size_t>(other)];
  return is_held;
}

}  // namespace rubato::integrate
