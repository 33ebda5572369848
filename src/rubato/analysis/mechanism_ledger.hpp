#pragma once

#include <rubato/system/mechanism_equations.hpp>

namespace rubato::analysis {

/// Where the energy of a mechanism is and where it went, in joules, since the start of a run.
struct MechanismEnergy {
  double kinetic = 0.0;            ///< v^T M v / 2
  double strain = 0.0;             ///< of beams, springs and elastic locks
  double damper_dissipated = 0.0;  ///< by dampers, those of locks included
  double lock_dissipated = 0.0;    ///< kinetic energy that rigid locks took as they engaged
  double load_work = 0.0;          ///< of forces, gravity and drives
  double start = 0.0;              ///< kinetic + strain at the start

  /// What the method itself made or lost: it closes the balance.
  double residue() const { return kinetic + strain + damper_dissipated + lock_dissipated - load_work - start; }
};

/// Books the steps of a march. Over a step with the travel dq, along the retraction from its start:
///
///   loads, drives, dampers (f0 + f1)/2 . dq
///
/// and between steps what the projection of the velocities took.
class MechanismLedger {
 public:
  explicit MechanismLedger(const system::Mechanism& mechanism);

  void start(const system::State& state);
  void add_step(const system::State& before, const system::State& after);
  /// The ledger at `now`, which lies in the step after `before`; books nothing. `now` may be `before`.
  MechanismEnergy at(const system::State& before, const system::State& now);

 private:
  struct Booking {
    double damper = 0.0, load = 0.0;
  };
  Booking booking(const system::State& before, const system::State& after);
  double kinetic(const system::State& state);
  double strain(const system::State& state);

  const system::Mechanism& mechanism_;
  system::MechanismEquations equations_;
  Vector travel_, force_, product_;
  MechanismEnergy sums_;
  double last_kinetic_ = 0.0;
};

}  // namespace rubato::analysis
