#include <rubato/integrate/mechanism/active_locks.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {

ActiveLocks::ActiveLocks(const system::Mechanism& mechanism, const system::State& given) : mechanism_(mechanism) {
  const auto& locks = mechanism.model().locks;
  for (std::size_t i = 0; i < locks.size(); ++i)
    holds_for_good_.push_back(locks[i].is_latch && given.phase[i] == model::lock_engaged);
}

double ActiveLocks::beyond(std::size_t lock, const Vector& q) const {
  const model::Lock& of = mechanism_.model().locks[lock];
  return of.sign * (of.s.value(q.data()) - of.at);
}

double ActiveLocks::nothing(std::size_t lock, double extent) const {
  constexpr double share = 1e-9;
  return share * (mechanism_.model().locks[lock].s.is_angle() ? 1.0 : extent);
}

bool ActiveLocks::may_change(std::size_t lock) {
  constexpr int most_a_lock = 20;
  if (changes_ < most_a_lock * static_cast<int>(holds_for_good_.size())) return ++changes_, true;
  unsettled_ = static_cast<int>(lock);
  return false;
}

bool ActiveLocks::any_open(const system::State& state) const {
  return std::any_of(state.phase.begin(), state.phase.end(), [](int phase) { return phase == model::lock_open; });
}

bool ActiveLocks::passes(const system::State& state, const Vector& q, double extent) const {
  for (std::size_t i = 0; i < holds_for_good_.size(); ++i)
    if (state.phase[i] == model::lock_open && beyond(i, q) > nothing(i, extent)) return true;
  return false;
}

bool ActiveLocks::meet(system::State& state, double extent) {
  bool has_met = false;
  for (std::size_t i = 0; i < holds_for_good_.size(); ++i) {
    if (state.phase[i] != model::lock_open || !(beyond(i, state.q) > nothing(i, extent)) || !may_change(i)) continue;
    state.phase[i] = model::lock_engaged;
    has_met = true;
  }
  return has_met;
}

bool ActiveLocks::release(system::State& state, double extent) {
  constexpr double share = 1e-9;  // of the largest reaction: that of a lock which nothing presses
  const double no_force = share * (state.multiplier.size() > 0 ? state.multiplier.cwiseAbs().maxCoeff() : 0.0);
  bool has_released = false;
  for (std::size_t i = 0; i < holds_for_good_.size(); ++i) {
    const model::Lock& lock = mechanism_.model().locks[i];
    if (state.phase[i] == model::lock_open || holds_for_good_[i] != 0) continue;
    const bool pulls = lock.is_rigid() ? lock.sign * state.multiplier[mechanism_.first_row(lock.joint)] < -no_force
                                       : beyond(i, state.q) < -nothing(i, extent);
    if (!pulls || !may_change(i)) continue;
    state.phase[i] = model::lock_open;
    if (lock.is_rigid()) state.multiplier[mechanism_.first_row(lock.joint)] = 0.0;
    has_released = true;
  }
  return has_released;
}

}  // namespace rubato::integrate
