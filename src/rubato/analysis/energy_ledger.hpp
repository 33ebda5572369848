#pragma once

#include <rubato/integrate/balance.hpp>
#include <rubato/integrate/load_values.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <optional>

namespace rubato::analysis {

/// What supports that move do in a step. A workspace.
class SupportWork {
 public:
  SupportWork(const system::LocallyNonlinear& system, integrate::Balance& balance);

  struct Work {
    double damper;  ///< dissipated beyond what the free coordinates alone would
    double load;    ///< of forces on the supports
    double drive;   ///< of the forces that move them
  };
  Work over(const system::State& before, const system::State& after);

 private:
  struct End {
    Vector q, v, a, reaction, load;
  };
  void go_to(const system::State& state, model::Side side, End& end);

  const system::LocallyNonlinear& system_;
  integrate::Balance& balance_;
  system::State balanced_;
  End before_, after_;
};

/// Where the energy is and where it went, in joules, since the start of a run.
struct Energy {
  double kinetic = 0.0;            ///< v^T M v / 2
  double strain = 0.0;             ///< q^T K q / 2
  double slider_stored = 0.0;      ///< sum of fc^2 / (2 kT)
  double stop_stored = 0.0;        ///< sum of k (u - gap)^2 / 2 of the stops that push
  double damper_dissipated = 0.0;  ///< by C
  double slider_dissipated = 0.0;  ///< by slip
  double stop_dissipated = 0.0;    ///< by the dashpots of stops, and what is left in their springs when they let go
  double load_work = 0.0;
  double drive_work = 0.0;  ///< of the forces that move supports
  double start = 0.0;       ///< stored() at the start

  double stored() const { return kinetic + strain + slider_stored + stop_stored; }
  /// What the method itself made or lost: it closes the balance. Round-off for the exact flow, and for average
  /// acceleration.
  double residue() const {
    return stored() + damper_dissipated + slider_dissipated + stop_dissipated - load_work - drive_work - start;
  }
};

/// Books the steps of a method. Over a step with dq = q1 - q0:
///
///   dampers (C v0 + C v1)/2 . dq,   loads (f0 + f1)/2 . dq,   sliders (fc0 + fc1)/2 . d(slip),   slip = u - fc/kT
///   stops  (fs0 + fs1)/2 . du less the change of stop_stored, of those that push before the step
///
/// and with supports that move, which count in all of these, their work (r0 + r1)/2 . dqp.
///
/// With average acceleration v0 + v1 = 2 dq/h, and the balance closes to round-off whatever the sliders do. A step in
/// which a stop closes without being located leaves its share of the work in the residue.
class EnergyLedger {
 public:
  EnergyLedger(const system::LocallyNonlinear& system, integrate::Balance& balance);

  void start(const system::State& state);
  /// Adds a step to the sums.
  void add_step(const system::State& before, const system::State& after);
  /// The ledger at `now`, which lies in the step after `before`, the last state booked; books nothing. `now` may be
  /// `before`.
  Energy at(const system::State& before, const system::State& now);

 private:
  struct Booking {
    double damper, slider, stop, load, drive;
  };
  Booking booking(const system::State& before, const system::State& after);

  const system::LocallyNonlinear& system_;
  system::Loads loads_;
  Vector travel_, product_, force_;
  std::optional<SupportWork> supports_;
  Energy sums_;
};

/// Energies that are stored in a state; the other entries are zero. `product` [n] is overwritten.
Energy energy_of(const system::LocallyNonlinear& system, const system::State& state, Vector& product);

}  // namespace rubato::analysis
