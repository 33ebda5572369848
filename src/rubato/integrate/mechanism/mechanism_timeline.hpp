#pragma once

#include <rubato/integrate/mechanism/law_guards.hpp>
#include <rubato/integrate/timeline.hpp>
#include <rubato/system/loads.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace rubato::integrate {

/// A lock that engaged or let go, or a joint whose friction held or let go.
struct LockEvent {
  double t = 0.0;
  int lock = -1;  ///< -1: it is a friction
  bool has_engaged = true;
  double energy_lost = 0.0;  ///< what the projection of the velocities took away, or its spring held as it let go [J]
  int friction = -1;
};

/// The timeline of a mechanism: rows of tables of loads and drives, its locks and the friction of its joints: guard i
/// watches lock i, and after the locks come the frictions, then the laws and the contacts, where they are watched.
///
///   open                      sign (at - s)                  the coordinate reaches the lock
///   at a stop with stiffness  sign (stiffness (s - at) + damping s')   its force would pull
///   at a stop without         sign times its multiplier of equilibrium at that instant
///   latched                   nothing any more
///   slides                    s' in the direction in which it slides; of two that share a limit their slip velocity
///                             along that at the start of the step
///   sticks                    mu N - |its multiplier|, both of equilibrium at that instant
///   at limit, held by others  nothing: the others are watched
///   held by drives that stand a drive that stood when it was left out moves
///   law                       Law::guard(): it goes on by another formula
///   contact                   its ends meet or part
///
/// A lock without stiffness that engages projects the velocities with M, where stops only press: those that stand and
/// would pull let go. The state goes on with the acceleration and
/// the multipliers of equilibrium. A drive whose prescribed velocity jumps does the same: it gives the impulse, whose
/// work is booked. No other energy can appear: it is located, and the projection only takes.
class MechanismTimeline final : public Timeline {
 public:
  /// @param resolution  [s]
  MechanismTimeline(const system::Mechanism& mechanism, double resolution);
  /// @param equations  lent; wherever they are left is well
  /// @param watches_laws      whether steps end where laws change as well
  /// @param watches_contacts  whether they end where the ends of contacts meet and part
  MechanismTimeline(system::MechanismEquations& equations, double resolution, bool watches_laws = false,
                    bool watches_contacts = false);

  std::vector<double> breakpoints(double from, double to) const override;
  bool jumps_at(double t) override;
  bool restart(system::State& state) override;
  Passage pass(const system::State& before, system::State& state, double shift) override;
  double resolution() const override { return resolution_; }
  double unresolved(const system::State& from, const system::State& to) override {
    return law_guards_.unresolved(from, to);
  }
  Crossing first_crossing(const system::State& from, const system::State& to, double least, Look look) override;
  GuardValue guard(Index guard, const system::State& from, const system::State& to) override;

  const std::vector<LockEvent>& events() const { return events_; }
  /// Of the laws; null where steps do not end there.
  LawGuards* law_guards() { return watches_laws_ ? &law_guards_ : nullptr; }
  /// Of the contacts, likewise.
  LawGuards* contact_guards() { return watches_contacts_ ? &law_guards_ : nullptr; }
  /// The guard whose transitions had no end, for which pass() failed: a hundred within a thousandth of the run,
  /// between which its coordinate stayed where it was, to 1e-9 of a radian or of the model's size. -1: none.
  Index chattering() const { return chattering_; }
  /// What drives gave so far as their velocities jumped, or locks did against them [J].
  double impulsive_work() const { return impulsive_work_; }

 private:
  struct Rubbing {
    bool has_changed = false;
    std::vector<char> candidates, at_limit;
  };
  /// Where the mechanism is, for its joints, with padded_ and padded_acceleration_ set to the state.
  model::Motion motion_of(const system::State& state);
  /// A state with the multipliers of equilibrium at its instant. The equations are there.
  struct Balanced {
    const system::State* of = nullptr;
    system::State state;
    bool is_found = false;
  };
  /// Kept for four states at a time, which must not change meanwhile, until forget_balances().
  const Balanced& balanced(const system::State& state);
  void forget_balances();
  /// @param floors  of slip velocities, as State::stuck_at has them
  GuardValue friction_guard(std::size_t friction, const system::State& state, const Vector& floors);
  /// Whether two frictions that share a limit go on across the way in which the step began; their floor is then new.
  bool turns_away(std::size_t friction, system::State& state);
  /// Which frictions a step ended in: those that slide no more, and those that let go.
  Rubbing rubbing_after(const system::State& before, system::State& state);
  /// Makes what drives held slide the way in which they begin to move it.
  void slide_with_drives(std::size_t friction, system::State& state);
  /// A way of a coordinate that is none [rad] or [m].
  double no_way(const model::FreeCoordinate& s, const system::State& state) const;
  /// Counts a transition of a guard.
  void count_transition(std::size_t guard, const system::State& state);
  /// Notes what friction did since `old`.
  void note_friction(const std::vector<int>& old, const system::State& state);
  /// The guard of a lock in a state.
  GuardValue guard_at(std::size_t lock, const system::State& state, const Vector& floors);
  /// The state at a share of a step, by the cubic of its positions and the chord of its velocities: slopes of
  /// velocities are those of vibrations too, and what is stiffly damped would turn their errors into forces.
  void interpolate(const system::State& from, const system::State& to, double share, system::State& out);
  /// Where a guard without a rate first passes zero; after a share of 2: nowhere. Its values at both ends and in
  /// the middle give a parabola; where that turns round close to zero the guard is looked at.
  Crossing first_passage(std::size_t guard, const system::State& from, const system::State& to, double least,
                         Look look);
  bool has_rate(std::size_t guard, const system::State& from) const;
  bool is_watched(std::size_t lock, const system::State& state) const;
  /// Opens rigid stops that would pull after a jump. Returns false where no acceleration is found.
  bool release(system::State& state);
  bool has_drive_jump(double t) const;
  /// Notes which drives stand, for the friction that they hold.
  void note_standing_drives(double t);
  bool has_started_drive(double t) const;
  /// For which a drive that stands must stand to hold friction: a millionth of the run [s].
  double ahead() const { return 1e6 * resolution_; }
  bool is_joint_switch(double t) const;  ///< the law of a joint may jump there
  /// Velocities, accelerations and multipliers that the constraints allow from now on, friction left out.
  bool project(system::State& state, double& energy_lost);

  MechanismTimeline(std::unique_ptr<system::MechanismEquations> own, double resolution);

  std::unique_ptr<system::MechanismEquations> own_;  // null: they are lent
  system::MechanismEquations& equations_;
  const system::Mechanism& mechanism_;
  double resolution_;
  bool watches_laws_, watches_contacts_;
  LawGuards law_guards_;
  system::Loads loads_;
  Vector left_, right_;
  std::vector<Index> row_;                            // of the constraint of each lock, or -1
  std::vector<int> friction_of_;                      // of the joint of each lock, or -1
  std::vector<double> padded_, padded_acceleration_;  // after a zero
  std::vector<char> stands_;                          // of the drives, when friction was settled last
  std::array<Balanced, 4> balances_;
  std::size_t balance_count_ = 0;
  system::State halfway_, turning_;  // of the last step that first_crossing() looked at
  bool has_halfway_ = false;
  mutable std::vector<double> joint_switches_;  // of laws of joints, in the interval of the last breakpoints()
  std::vector<LockEvent> events_;
  /// Transitions of a guard since a time and a place.
  struct Transitions {
    double since = 0.0, at = 0.0;
    int count = 0;
  };
  std::vector<Transitions> transitions_;
  Index chattering_ = -1;
  double impulsive_work_ = 0.0;
};

}  // namespace rubato::integrate
