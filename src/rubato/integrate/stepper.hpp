#pragma once

#include <rubato/integrate/method.hpp>
#include <rubato/integrate/step_report.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <memory>

namespace rubato::integrate {

/// A method bound to a system, with all the memory that its steps need: one a thread. It reports and never decides, and
/// remembers nothing between steps but matrices: what a step computes depends on its arguments only.
class Stepper {
 public:
  virtual ~Stepper() = default;

  /// One try from `from.t` to `t1`.
  /// @param from  where the step starts
  /// @param h     its length [s]; matrices are kept while it stays the same
  /// @param t1    its end [s]: from.t + h but for round-off, which a driver that counts steps avoids
  /// @param to    the state at t1 if accepted, undefined otherwise; must not be `from`
  virtual StepReport attempt(const system::State& from, double h, double t1, system::State& to) = 0;

  /// Prepares a state for steps of another length, new over old = `ratio`: the auxiliary acceleration of the alpha
  /// methods stands at a time shifted by a share of the step.
  virtual void step_changes(system::State& state, double ratio) {
    (void)state;
    (void)ratio;
  }

  /// The auxiliary acceleration stands at t + shift h, but for terms of second order in h.
  virtual double shift() const { return 0.0; }

  /// The difference of the two solutions of an embedded pair in the last attempt [n]: an error of h^(order + 1) of the
  /// lower order. Returns false, and writes nothing, where there is no pair.
  virtual bool embedded_difference(Vector& dq, Vector& dv) const {
    (void)dq;
    (void)dv;
    return false;
  }

  /// Number of factorisations so far.
  virtual int factorisations() const { return 0; }
};

/// The stepper of a method for a system; the system must outlive it. Throws InvalidInput for `exact`, which takes no
/// step, and for `exponential` beyond 500 coordinates.
std::unique_ptr<Stepper> make_stepper(const Method& method, const system::LocallyNonlinear& system);

/// The state in which a march starts: the system's, or `given`, with the acceleration of equilibrium as the auxiliary
/// one.
system::State consistent_start(const system::LocallyNonlinear& system, system::State given);

}  // namespace rubato::integrate
