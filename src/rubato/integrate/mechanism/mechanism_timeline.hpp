#pragma once

#include <rubato/integrate/timeline.hpp>
#include <rubato/system/loads.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <string>
#include <vector>

namespace rubato::integrate {

/// A lock that engaged or let go.
struct LockEvent {
  double t = 0.0;
  int lock = -1;
  bool has_engaged = true;
  double energy_lost = 0.0;  ///< kinetic energy that the projection of the velocities took away [J]
};

/// The timeline of a mechanism: rows of tables of loads, and its locks, guard i watching lock i.
///
///   open                      sign (at - s)                  the coordinate reaches the lock
///   at a stop with stiffness  sign (stiffness (s - at) + damping s')   its force would pull
///   at a stop without         sign times its multiplier
///   latched                   nothing any more
///
/// A lock without stiffness that engages projects the velocities with M; the state goes on with the acceleration and
/// the multipliers of equilibrium. No energy can appear: it is located, and the projection only takes.
class MechanismTimeline final : public Timeline {
 public:
  /// @param resolution  [s]
  MechanismTimeline(const system::Mechanism& mechanism, double resolution);

  std::vector<double> breakpoints(double from, double to) const override;
  bool jumps_at(double t) override;
  void restart(system::State& state) override;
  bool pass(const system::State& before, system::State& state, double shift) override;
  double resolution() const override { return resolution_; }
  Crossing first_crossing(const system::State& from, const system::State& to, double least) override;
  GuardValue guard(Index guard, const system::State& from, const system::State& to) override;

  const std::vector<LockEvent>& events() const { return events_; }

 private:
  /// The guard of a lock in a state.
  GuardValue guard_at(std::size_t lock, const system::State& state);
  bool is_watched(std::size_t lock, const system::State& state) const;
  /// Opens rigid stops that would pull after a jump.
  void release(system::State& state);

  const system::Mechanism& mechanism_;
  system::MechanismEquations equations_;
  double resolution_;
  system::Loads loads_;
  Vector left_, right_;
  std::vector<Index> row_;  // of the constraint of each lock, or -1
  std::vector<double> padded_;
  std::vector<LockEvent> events_;
};

}  // namespace rubato::integrate
