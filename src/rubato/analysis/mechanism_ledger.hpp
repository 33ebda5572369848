#pragma once

#include <rubato/integrate/mechanism/mechanism_balance.hpp>

namespace rubato::analysis {

/// Where the energy of a mechanism is and where it went, in joules, since the start of a run.
struct MechanismEnergy {
  double kinetic = 0.0;              ///< v^T M v / 2
  double strain = 0.0;               ///< of beams, springs and elastic locks
  double damper_dissipated = 0.0;    ///< by dampers, those of locks included
  double lock_dissipated = 0.0;      ///< what rigid locks took as they engaged, and damped stops held as they let go
  double friction_dissipated = 0.0;  ///< by the friction of joints
  double load_work = 0.0;            ///< of forces, gravity, and laws of joints
  double drive_work = 0.0;           ///< of the drives that prescribe motions
  double start = 0.0;                ///< kinetic + strain at the start

  /// What the method itself made or lost: it closes the balance.
  double residue() const {
    return kinetic + strain + damper_dissipated + lock_dissipated + friction_dissipated - load_work - drive_work -
           start;
  }
};

/// Books the steps of a march. Over a step with the travel dq, along the retraction from its start:
///
///   loads, laws, dampers (f0 + f1)/2 . dq
///   friction              (F0 + F1)/2 times the change of its coordinate
///   drives               (F0 + F1)/2 times the change of what they prescribe, F minus the multiplier of
///                         equilibrium at either end (that of a step is of first order where velocities are projected)
///
/// and between steps what the projection of the velocities took, and drives gave to it, and what the spring of a damped
/// stop still held as it let go.
class MechanismLedger {
 public:
  explicit MechanismLedger(integrate::MechanismBalance& balance);

  void start(const system::State& state);
  /// @param impulsive_work  of the drives so far, between steps [J]
  void add_step(const system::State& before, const system::State& after, double impulsive_work = 0.0);
  /// The ledger at `now`, which lies in the step after `before`; books nothing. `now` may be `before`.
  MechanismEnergy at(const system::State& before, const system::State& now, double impulsive_work = 0.0);

 private:
  struct Booking {
    double damper = 0.0, load = 0.0, drive = 0.0, friction = 0.0;
  };
  /// What locks took between the step before and this state, without what drives gave [J].
  double taken_before(const system::State& state);
  Booking booking(const system::State& before, const system::State& after);
  double kinetic(const system::State& state);
  double strain(const system::State& state);

  const system::Mechanism& mechanism_;
  integrate::MechanismBalance& balance_;
  system::MechanismEquations& equations_;
  Vector travel_, force_, product_;
  system::State balanced_;
  MechanismEnergy sums_;
  double last_kinetic_ = 0.0, last_impulsive_work_ = 0.0;
  std::vector<int> last_phase_;
};

}  // namespace rubato::analysis
