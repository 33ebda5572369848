#pragma once

#include <rubato/integrate/timeline.hpp>
#include <rubato/system/constrained_equations.hpp>
#include <rubato/system/own_system.hpp>

#include <memory>
#include <vector>

namespace rubato::integrate {

/// A transition that a march ended a step at.
struct GuardEvent {
  double t = 0.0;  ///< [s]
  Index guard = 0;
  double energy_lost = 0.0;  ///< kinetic energy that the impact took [J]
};

/// The timeline of a system of one's own: its breakpoints, and the transitions that its guards tell. A guard that is
/// negative where a step begins and rises is not watched in it; one that falls has been missed, which
/// ends the march (bounces that become ever smaller are). Throws InvalidInput for a guard that is not finite.
class GuardTimeline final : public Timeline {
 public:
  /// @param system      must outlive this
  /// @param resolution  of the times of transitions [s]; 1e-12 of the march is a good one
  GuardTimeline(const system::OwnSystem& system, double resolution);

  std::vector<double> breakpoints(double from, double to) const override;
  /// Whether t is a breakpoint: whether forces jump there or bend only the system does not say.
  bool jumps_at(double t) override;
  bool restart(system::State& state) override;
  Passage pass(const system::State& before, system::State& state, double shift) override;
  double resolution() const override { return resolution_; }
  Crossing first_crossing(const system::State& from, const system::State& to, double least, Look look) override;
  GuardValue guard(Index guard, const system::State& from, const system::State& to) override;

  const std::vector<GuardEvent>& events() const { return events_; }

 private:
  GuardValue guard_at(Index guard, const system::State& state) const;
  /// Whether a guard may pass zero in a step from there.
  bool is_watched(const GuardValue& from) const;
  double kinetic_energy(const system::State& state);

  const system::OwnSystem& system_;
  std::unique_ptr<system::ConstrainedEquations> equations_;
  double resolution_;
  mutable std::vector<double> breakpoints_;
  std::vector<GuardEvent> events_;
  Vector momentum_;
};

}  // namespace rubato::integrate
