#pragma once

#include <rubato/integrate/pressed_motion.hpp>
#include <rubato/integrate/timeline.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::integrate {

/// The timeline of a structure: rows of tables of loads, and its contacts, guard i watching contact i.
///
///   sticking slider   limit - |fc0 + kT (u - u0)|    the force reaches its limit
///   slipping slider   +-du/dt, positive outward      the slip comes to rest
///   open stop         gap - u                        the gap closes
///   pushing stop      k (u - gap) + c du/dt          the force vanishes
///   lagging stop      the negative of that           a damped stop that has let go pushes again before it is open
///   other law         Law::guard()                   it goes on by another formula
///   contact           as an undamped stop            its ends meet or part
///
/// A slider at its limit slips if it moves outward, or if it is at rest and is accelerated outward.
class StructureTimeline final : public Timeline {
 public:
  /// @param resolution  [s]: at rest is who would be so within this time
  /// @param watches_sliders  and other laws; else stops alone
  StructureTimeline(const system::LocallyNonlinear& system, double resolution, bool watches_sliders = true);

  std::vector<double> breakpoints(double from, double to) const override;
  bool jumps_at(double t) override;
  bool restart(system::State& state) override;
  Passage pass(const system::State& before, system::State& state, double shift) override;
  double resolution() const override { return resolution_; }
  double unresolved(const system::State& from, const system::State& to) override;
  Crossing first_crossing(const system::State& from, const system::State& to, double least, Look look) override;
  GuardValue guard(Index guard, const system::State& from, const system::State& to) override;

  /// The branch on which a march goes on from a state: of a slider the side to which it slips, 1 or -1; of a stop that
  /// is closed 1; else 0.
  int branch(Index contact, const system::State& state) const;
  /// The same at the end of a step, which may have ended at a transition: forces and velocities there are zero but for
  /// what locating leaves, of either sign.
  int branch_after(Index contact, const system::State& before, const system::State& after);
  /// How a law that sticks goes on at the end of such a step, or went on at its start.
  model::Law::Contact contact_of_law(Index law, const system::State& before, const system::State& after, bool at_end);
  /// How a contact goes on from a state.
  model::Law::Contact contact_of_block(Index block, const system::State& state) const;

 private:
  enum class Watch { nothing, limit, rest_after_positive, rest_after_negative, closing, opening, pushing_again, law };
  struct Path;

  Path path_of(Index contact, const system::State& from, const system::State& to) const;
  Watch watch_of(Index contact, const system::State& from) const;
  Watch watch_of_slider(Index slider, const system::State& from) const;
  Watch watch_of_stop(Index contact, const system::State& from) const;
  double share_of(Index contact, const system::State& from, const system::State& to);
  /// What pushes where a gap is closed: a stop, or the normal direction of a contact.
  struct Gap {
    double gap, stiffness, damping;
  };
  Gap gap_of(Index contact) const;
  bool is_gap(Index contact) const;
  void go_on_beyond(Index contact, double shift, bool closes, const system::State& state);
  double guard_of_law(Index contact, const system::State& from, const system::State& to, double share);
  bool has_ended_at(Index contact, const system::State& from, const system::State& to);

  const system::LocallyNonlinear& system_;
  double resolution_;
  bool watches_sliders_;
  system::Loads loads_;
  Vector left_, right_;
  system::State beyond_;
  std::vector<std::pair<Index, double>> pushing_;  ///< damped contacts that close at a transition, with their force
  system::EquilibriumAcceleration equilibrium_;
  PressedMotion pressed_;
};

}  // namespace rubato::integrate
