#pragma once

#include <rubato/integrate/balance.hpp>
#include <rubato/integrate/energy_ledger.hpp>
#include <rubato/integrate/load_values.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::integrate {

/// The energy of a structure between its free coordinates. Over a step with dq = q1 - q0:
///
///   dampers (C v0 + C v1)/2 . dq,   loads (f0 + f1)/2 . dq,   sliders (fc0 + fc1)/2 . d(slip),   slip = u - fc/kT
///   stops  (fs0 + fs1)/2 . du less the change of what they store, of those that push before the step
///
/// With average acceleration v0 + v1 = 2 dq/h, and the balance closes to round-off whatever the sliders do. A step in
/// which a stop closes without being located leaves its share of the work in the residue.
class StructureEnergy final : public EnergyPart {
 public:
  explicit StructureEnergy(const system::LocallyNonlinear& system);

  /// Those of stops where there are any.
  enum Place : std::size_t {
    kinetic,            ///< v^T M v / 2
    strain,             ///< q^T K q / 2
    slider_stored,      ///< sum of fc^2 / (2 kT)
    damper_dissipated,  ///< by C
    slider_dissipated,  ///< by slip
    load_work,
    stop_stored,     ///< sum of k (u - gap)^2 / 2 of the stops that push
    stop_dissipated  ///< by the dashpots of stops, and what is left in their springs when they let go
  };
  std::vector<Account> accounts() const override;
  void add_stored(const system::State& state, Entries row) override;
  void add_flow(const system::State& before, const system::State& after, Entries row) override;

 private:
  const system::LocallyNonlinear& system_;
  system::Loads loads_;
  Vector travel_, product_, force_;
};

/// What supports that move add to it, which count in all of this, and their own work (r0 + r1)/2 . dqp.
class SupportEnergy final : public EnergyPart {
 public:
  /// @param system   with supports
  /// @param balance  of that system
  SupportEnergy(const system::LocallyNonlinear& system, Balance& balance);

  std::vector<Account> accounts() const override;
  void add_stored(const system::State& state, Entries row) override;
  void add_flow(const system::State& before, const system::State& after, Entries row) override;

 private:
  struct End {
    Vector q, v, a, reaction, load;
  };
  void go_to(const system::State& state, model::Side side, End& end);

  const system::MovingSupports& supports_;
  Balance& balance_;
  system::State balanced_;
  End before_, after_;
};

/// All parts of a structure.
std::vector<std::unique_ptr<EnergyPart>> energy_parts(const system::LocallyNonlinear& system, Balance& balance);

}  // namespace rubato::integrate
