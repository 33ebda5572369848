#pragma once

#include <rubato/system/mechanism.hpp>

#include <vector>

namespace rubato::integrate {

/// The active set of locks while an equilibrium is looked for. A lock engages where the search would pass beyond it, so
/// that nothing falls through a stop. A stop lets go where all forces balance and it would have to pull. A latch that
/// held at the start holds for good; one that is met on the way is tried like a stop.
class ActiveLocks {
 public:
  ActiveLocks(const system::Mechanism& mechanism, const system::State& given);

  /// Whether a lock is open that might be met.
  bool any_open(const system::State& state) const;
  /// Whether a configuration lies beyond a lock that is open in the state.
  bool passes(const system::State& state, const Vector& q, double extent) const;
  /// Engages open locks that the state lies beyond. Returns whether there were any.
  /// @param extent  of the mechanism [m]
  bool meet(system::State& state, double extent);
  /// Opens locks that pull in an equilibrium, whose multipliers the state has. Returns whether there were any.
  bool release(system::State& state, double extent);

  int changes() const { return changes_; }
  /// The lock that changed last where there was no end of it, or -1.
  int unsettled() const { return unsettled_; }

 private:
  bool may_change(std::size_t lock);
  double beyond(std::size_t lock, const Vector& q) const;
  /// How far beyond a lock counts as not beyond it [rad] or [m].
  double nothing(std::size_t lock, double extent) const;

  const system::Mechanism& mechanism_;
  std::vector<char> holds_for_good_;
  int changes_ = 0, unsettled_ = -1;
};

}  // namespace rubato::integrate
