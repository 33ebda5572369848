#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/mechanism/friction_choice.hpp>
#include <rubato/integrate/mechanism/friction_release.hpp>
#include <rubato/integrate/mechanism/held_frictions.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

constexpr double round_off = 1e-6;  // of accelerations

bool slides(const system::State& state, std::size_t friction) {
  return state.rubbing[friction] == model::friction_slides_up || state.rubbing[friction] == model::friction_slides_down;
}

/// One way in which the frictions at rest may go on.
struct Way {
  std::vector<int> phase;          // of each of them; a pair that slides goes up, wherever it is pulled
  std::vector<double> departures;  // of those that slide; 0 of the others
  double left = HUGE_VAL;          // the least share that one that sticks keeps of its limit
};

/// Makes the state that of a way; false where there is none.
bool go(system::MechanismEquations& equations, system::State& state, const std::vector<std::size_t>& resting,
        const std::vector<int>& phase, const std::vector<char>& at_limit) {
  const auto& model = equations.mechanism().model();
  const auto is_pair = [&](std::size_t k) { return model.frictions[resting[k]].partner >= 0; };
  for (std::size_t k = 0; k < resting.size(); ++k) {
    stick_here(model, state, resting[k]);
    if (!is_pair(k)) set_friction_phase(model, state, resting[k], phase[k]);
  }
  if (!find_acceleration(equations, state, model::Side::right)) return false;
  for (std::size_t k = 0; k < resting.size(); ++k) {
    if (!is_pair(k) || phase[k] == model::friction_sticks) continue;
    if (excess_of_limit(equations, state, resting[k], at_limit[resting[k]]) <= 0.0) return false;
    if (!let_go(equations, state, resting[k])) return false;
  }
  return true;
}

/// Fills in what tells whether a way is one; false where a friction exceeds its limit.
bool look_at(system::MechanismEquations& equations, const system::State& state, const std::vector<std::size_t>& resting,
             const std::vector<char>& at_limit, Way& way) {
  way.left = HUGE_VAL;
  for (std::size_t k = 0; k < resting.size(); ++k)
    way.departures[k] = slides(state, resting[k]) ? departure(equations, state, resting[k]) : 0.0;
  for (std::size_t k = 0; k < resting.size(); ++k) {
    const std::size_t i = resting[k];
    if (state.rubbing[i] != model::friction_sticks) continue;
    if (excess_of_limit(equations, state, i, at_limit[i]) > 0.0) return false;
    const double limit = equations.friction_limit(i, state.multiplier);
    way.left = std::min(way.left, limit > 0.0 ? 1.0 - equations.friction_size(i, state.multiplier) / limit : 0.0);
  }
  return true;
}

/// What moves the frictions at rest where none of them sticks.
class Freedoms {
 public:
  /// @return false where the matrix cannot be factorised
  bool find(system::MechanismEquations& equations, system::State state, const std::vector<std::size_t>& resting) {
    const auto& model = equations.mechanism().model();
    for (const std::size_t i : resting) set_friction_phase(model, state, i, model::friction_free);
    if (!find_friction_mobilities(equations, state, resting, mobility_)) return false;
    redundancy_ = equations.redundant_rows().size();
    for (const std::size_t i : resting) is_pair_.push_back(model.frictions[i].partner >= 0);
    return true;
  }

  /// How many rows of constraints repeat others.
  std::size_t redundancy() const { return redundancy_; }

  /// Whether no more stick than it takes, and those that slide can do so at the same time: of two on one freedom one
  /// leads the way of the other, unless a third of them sticks.
  bool allow(const std::vector<int>& phase) const {
    for (std::size_t i = 0; i < phase.size(); ++i) {
      const bool is_held = this->is_held(i, phase);
      if (is_held && phase[i] == model::friction_sticks) return false;
      if (is_held || phase[i] == model::friction_sticks) continue;
      for (std::size_t k = 0; k < i; ++k) {
        if (phase[k] == model::friction_sticks || !are_one(i, k)) continue;
        const double way = model::sliding_direction(phase[i]) * model::sliding_direction(phase[k]);
        if (way * mobility_[i].of(mobility_[k]) < 0.0) return false;
      }
    }
    return true;
  }

 private:
  /// By one that sticks on the same freedom.
  bool is_held(std::size_t i, const std::vector<int>& phase) const {
    for (std::size_t k = 0; k < phase.size(); ++k)
      if (k != i && phase[k] == model::friction_sticks && are_one(i, k)) return true;
    return false;
  }
  bool are_one(std::size_t i, std::size_t k) const {
    constexpr double same = 1e-8;  // of mobilities; axes that lie in one to four digits count as one
    if (is_pair_[i] || is_pair_[k]) return false;
    const double both = mobility_[i].of(mobility_[i]) * mobility_[k].of(mobility_[k]);
    return std::pow(mobility_[i].of(mobility_[k]), 2) >= (1.0 - same) * both;
  }

  std::vector<FrictionMobility> mobility_;
  std::vector<char> is_pair_;
  std::size_t redundancy_ = 0;
};

/// The next of all combinations; false after the last.
bool advance(std::vector<int>& phase, const std::vector<char>& is_pair) {
  for (std::size_t k = 0; k < phase.size(); ++k) {
    if (phase[k] == model::friction_sticks) {
      phase[k] = model::friction_slides_up;
      return true;
    }
    if (phase[k] == model::friction_slides_up && !is_pair[k]) {
      phase[k] = model::friction_slides_down;
      return true;
    }
    phase[k] = model::friction_sticks;
  }
  return false;
}

}  // namespace

std::vector<char> resting_frictions(system::MechanismEquations& equations, const system::State& state,
                                    const std::vector<char>& candidates) {
  const auto& model = equations.mechanism().model();
  const std::size_t count = candidates.size();
  std::vector<char> rests(count, 0);
  if (count == 0) return rests;
  system::State still = state;
  for (std::size_t i = 0; i < count; ++i) {
    if (equations.is_led(i)) continue;
    if (candidates[i]) stick_here(model, still, i);
    rests[i] = still.rubbing[i] == model::friction_sticks;
  }
  if (count > 1 && !put_held_at_limit(equations, still, rests)) std::fill(rests.begin(), rests.end(), 0);
  return rests;
}

bool agree_with_coulomb(system::MechanismEquations& equations, const system::State& state,
                        const std::vector<char>& rests, const std::vector<char>& at_limit) {
  equations.go_to(state, model::Side::right);
  for (std::size_t i = 0; i < rests.size(); ++i) {
    if (!rests[i]) continue;
    const bool sticks = state.rubbing[i] == model::friction_sticks;
    if (sticks ? excess_of_limit(equations, state, i, at_limit[i]) > 0.0 : goes_backward(equations, state, i))
      return false;
  }
  return true;
}

bool choose_frictions(system::MechanismEquations& equations, system::State& state, const std::vector<char>& rests,
                      const std::vector<char>& at_limit) {
  constexpr std::size_t most = 6;
  const auto& model = equations.mechanism().model();
  std::vector<std::size_t> resting;
  std::vector<char> is_pair;
  for (std::size_t i = 0; i < rests.size(); ++i) {
    if (!rests[i]) continue;
    resting.push_back(i);
    is_pair.push_back(model.frictions[i].partner >= 0);
  }
  if (resting.empty() || resting.size() > most) return false;
  const auto sticking = [](const Way& of) {
    return static_cast<std::size_t>(std::count(of.phase.begin(), of.phase.end(), model::friction_sticks));
  };
  const system::State first = state;
  Freedoms freedoms;
  if (!freedoms.find(equations, first, resting)) return false;
  std::vector<Way> ways;
  std::vector<double> largest(resting.size(), 0.0);  // departures, of all ways: where nothing moves yet, the scale
  Way way;
  way.phase.assign(resting.size(), model::friction_sticks);
  way.departures.assign(resting.size(), 0.0);
  do {
    state = first;
    if (!freedoms.allow(way.phase) || !go(equations, state, resting, way.phase, at_limit)) continue;
    if (equations.redundant_rows().size() > freedoms.redundancy()) continue;  // forces that nothing determines
    const bool is_within = look_at(equations, state, resting, at_limit, way);
    for (std::size_t k = 0; k < resting.size(); ++k) largest[k] = std::max(largest[k], std::abs(way.departures[k]));
    if (is_within) ways.push_back(way);
    if (is_within && sticking(way) == resting.size()) break;  // none is better
  } while (advance(way.phase, is_pair));
  const Way* best = nullptr;
  for (const Way& one : ways) {
    bool goes_its_way = true;
    for (std::size_t k = 0; k < resting.size(); ++k)
      goes_its_way = goes_its_way && one.departures[k] >= -round_off * largest[k];
    if (!goes_its_way) continue;
    if (best == nullptr || sticking(one) > sticking(*best) ||
        (sticking(one) == sticking(*best) && one.left > best->left))
      best = &one;
  }
  if (best == nullptr) return false;
  state = first;
  std::vector<char> held(rests.size(), 0);
  return go(equations, state, resting, best->phase, at_limit) && put_held_at_limit(equations, state, held);
}

}  // namespace rubato::integrate
