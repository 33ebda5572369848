#pragma once

#include <rubato/integrate/method.hpp>
#include <rubato/steady/marching/period_map.hpp>

#include <memory>

namespace rubato::steady {

/// The map of any method with a step, by the steppers of the catalogue: one point at a time, models of any size. The
/// states are in physical coordinates. The system must outlive it; the request says what records hold.
std::unique_ptr<PeriodMap> make_stepper_map(const integrate::Method& method, const system::LocallyNonlinear& system,
                                            const SteadyRequest& request);

/// The system under other loads and with other limits: the loads of the excitation as harmonic terms (two a harmonic:
/// in phase and in quadrature; static ones of zero frequency).
system::LocallyNonlinear with_excitation(const system::LocallyNonlinear& system, const system::Excitation& excitation);

/// Writes samples of a march into a record, and adds up the works of its steps:
///
///   dampers (C v0 + C v1)/2 . dq,   loads (f0 + f1)/2 . dq,   laws by their own formula
///
/// of which the first two close the balance of energy to round-off for average acceleration (see the ledger of
/// transient runs).
class RecordWriter {
 public:
  RecordWriter(const system::LocallyNonlinear& system, const SteadyRequest& request);
  /// Sample `column` of the record; `adds_work`: the step from the sample written before to this one counts.
  void write(const system::State& state, PeriodRecord& record, Index column, bool adds_work);

 private:
  const system::LocallyNonlinear& system_;
  const SteadyRequest& request_;
  system::EquilibriumAcceleration equilibrium_;
  system::Loads loads_;
  system::State last_;  // written last, of a system with laws
  Vector acceleration_, travel_, product_, force_, last_q_, last_product_, last_force_;
};

}  // namespace rubato::steady
