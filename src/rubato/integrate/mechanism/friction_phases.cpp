#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/mechanism/friction_choice.hpp>
#include <rubato/integrate/mechanism/friction_phases.hpp>
#include <rubato/integrate/mechanism/friction_release.hpp>
#include <rubato/integrate/mechanism/held_frictions.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

using model::friction_free;
using model::friction_slides_down;
using model::friction_slides_up;
using model::friction_sticks;

/// Leaves out what rigid locks or drives hold; what they held until now is a candidate.
void leave_out_held(system::MechanismEquations& equations, system::State& state, double ahead,
                    std::vector<char>& candidates) {
  const std::vector<char> is_driven = frictions_held_by_drives(equations, state, ahead);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (equations.is_led(i)) continue;
    const bool has_been_free = state.rubbing[i] == friction_free;
    const bool is_left_out = is_driven[i] || is_locked(equations.mechanism().model(), state, i);
    if (is_left_out) set_friction_phase(equations.mechanism().model(), state, i, friction_free);
    candidates[i] = !is_left_out && (candidates[i] || has_been_free);
  }
}

/// What may stick, by the candidates; the phases and accelerations of all become those of Coulomb's law. One by one:
/// of those that exceed their limit the worst goes first.
bool decide(system::MechanismEquations& equations, system::State& state, const std::vector<char>& candidates,
            const std::vector<char>& at_limit) {
  const auto& model = equations.mechanism().model();
  const std::size_t count = candidates.size();
  std::vector<char> is_open(count, 0);  // may stick or slide as it turns out
  for (std::size_t i = 0; i < count; ++i) {
    if (equations.is_led(i)) continue;
    if (candidates[i]) stick_here(model, state, i);
    is_open[i] = state.rubbing[i] == friction_sticks;
  }
  if (!find_acceleration(equations, state, model::Side::right)) return false;
  const auto most_changes = 4 * count + 4;
  for (std::size_t change = 0; change < most_changes; ++change) {
    equations.go_to(state, model::Side::right);
    std::size_t worst = count;
    double largest = -HUGE_VAL;
    for (std::size_t i = 0; i < count; ++i) {
      if (state.rubbing[i] != friction_sticks || equations.is_led(i)) continue;
      const double excess = excess_of_limit(equations, state, i, at_limit[i]);
      if (excess <= 0.0 || excess <= largest) continue;
      largest = excess;
      worst = i;
    }
    if (worst < count) {
      if (!let_go(equations, state, worst)) return false;
      continue;
    }
    std::size_t turned = 0;
    while (turned < count && !(is_open[turned] && goes_backward(equations, state, turned))) ++turned;
    if (turned == count) break;
    stick_here(model, state, turned);
    is_open[turned] = 0;  // once
    if (!find_acceleration(equations, state, model::Side::right)) return false;
  }
  return true;
}

/// Whether the friction of one that rests may change the limit of another.
bool may_change_each_other(const model::Mechanism& model, const std::vector<char>& rests) {
  bool follows = false;
  for (std::size_t i = 0; i < rests.size(); ++i)
    follows = follows || (rests[i] && model.frictions[i].follows_reaction());
  return follows && std::count(rests.begin(), rests.end(), 1) > 1;
}

/// The same until no friction that slid turns out to be held by others. One that is held becomes a candidate, and may
/// be put at its limit.
bool decide_with_held(system::MechanismEquations& equations, system::State& state, std::vector<char>& candidates,
                      const std::vector<char>& at_limit) {
  const std::size_t count = candidates.size();
  for (std::size_t round = 0; round <= count; ++round) {
    if (!decide(equations, state, candidates, at_limit)) return false;
    const std::vector<char> last = candidates;
    if (!put_held_at_limit(equations, state, candidates)) return false;
    if (candidates == last) break;
  }
  return true;
}

/// Joints that rub by themselves are decided one by one; of others all ways are tried.
bool settle_phases(system::MechanismEquations& equations, system::State& state, std::vector<char>& candidates,
                   const std::vector<char>& at_limit, const std::vector<char>& rests) {
  const system::State first = state;
  const bool is_coupled = may_change_each_other(equations.mechanism().model(), rests);
  if (is_coupled && choose_frictions(equations, state, rests, at_limit)) return true;
  state = first;
  const bool is_decided = decide_with_held(equations, state, candidates, at_limit);
  if (is_coupled || (is_decided && agree_with_coulomb(equations, state, rests, at_limit))) return is_decided;
  const system::State decided = state;
  state = first;
  if (choose_frictions(equations, state, rests, at_limit)) return true;
  state = decided;
  return is_decided;
}

}  // namespace

bool is_locked(const model::Mechanism& model, const system::State& state, std::size_t friction) {
  for (std::size_t lock = 0; lock < model.locks.size(); ++lock)
    if (state.phase[lock] == model::lock_engaged && model.locks[lock].is_rigid() &&
        model.locks[lock].name == model.frictions[friction].name)
      return true;
  return false;
}

bool find_friction_phases(system::MechanismEquations& equations, system::State& state, std::vector<char> candidates,
                          double ahead, std::vector<char> at_limit) {
  const std::size_t count = candidates.size();
  at_limit.resize(count, 0);
  for (std::size_t i = 0; i < count; ++i) candidates[i] = candidates[i] || is_at_limit(state.rubbing[i]);
  bool lets_go = false;  // of two that share a limit: what is left of velocities would be their direction
  for (std::size_t i = 0; i < count; ++i)
    lets_go = lets_go || (at_limit[i] && state.rubbing[i] == friction_sticks &&
                          equations.mechanism().model().frictions[i].partner >= 0);
  if (lets_go) {
    const ConsistentStart still = make_consistent(equations, state, model::Side::right);
    if (!still.is_consistent) return false;
    state = still.state;
  }
  leave_out_held(equations, state, ahead, candidates);
  const std::vector<char> rests = resting_frictions(equations, state, candidates);
  if (!settle_phases(equations, state, candidates, at_limit, rests)) return false;
  for (std::size_t i = 0; i < count; ++i) candidates[i] = candidates[i] || rests[i];
  bool holds_new = false;
  for (std::size_t i = 0; i < count; ++i)
    holds_new = holds_new || (candidates[i] && state.rubbing[i] == friction_sticks);
  if (!holds_new) return true;
  const ConsistentStart at_rest = make_consistent(equations, state, model::Side::right);  // rates left are round-off
  if (at_rest.is_consistent) state = at_rest.state;
  return at_rest.is_consistent;
}

bool find_phases_of_new_velocities(system::MechanismEquations& equations, system::State& state, double ahead) {
  const auto& frictions = equations.mechanism().model().frictions;
  std::vector<char> candidates(frictions.size(), 0);
  equations.go_to(state, model::Side::right);
  const double fastest = state.v.size() > 0 ? state.v.cwiseAbs().maxCoeff() : 0.0;
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    if (equations.is_led(i)) continue;
    if (frictions[i].partner >= 0) {
      const Eigen::Vector2d slip = equations.slip_velocity(i);
      candidates[i] = slip.norm() <= std::max(1e-10 * fastest, equations.negligible_rate(i));
      set_friction_phase(equations.mechanism().model(), state, i, friction_slides_up);
      set_slip_floor(equations.mechanism().model(), state, i, model::slip_floor_share * slip);
      continue;
    }
    const double rate = equations.friction_rate(i);
    candidates[i] = std::abs(rate) <= std::max(1e-10 * fastest, equations.negligible_rate(i));
    state.rubbing[i] = rate > 0.0 ? friction_slides_up : friction_slides_down;
  }
  return find_friction_phases(equations, state, candidates, ahead);
}

}  // namespace rubato::integrate
