#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <cmath>
#include <vector>

namespace rubato::integrate {

/// The breakpoints in (from, to) at which a load jumps, by more than 1e-9 of the largest value that it has at any of
/// them; rising.
std::vector<double> jumps_of(const system::Loads& loads, double from, double to);

/// The jumps of the loads of a structure, which a march with equal steps meets one after another. A method that carries
/// an acceleration ends a step with that before the jump, and would go on with it: an error of h^2 M^-1 df. A
/// workspace: one a march.
class LoadJumps {
 public:
  /// Those in (from, to). A formula is searched for its switches.
  LoadJumps(const system::LocallyNonlinear& system, double from, double to);

  /// The first jump that is not passed yet; infinity: none [s].
  double next() const { return next_ < times_.size() ? times_[next_] : HUGE_VAL; }

  /// The last jump that is as good as at t1, else t1: where a step that should end there does.
  /// @param round_off  of t1 [s]
  double end_of_step(double t1, double round_off) const;

  /// Passes the jumps up to state.t, where a step has ended: the auxiliary acceleration changes by M^-1 (f(t+) -
  /// f(t-)). Jumps before `since` were within the step, which could not see them.
  void pass(system::State& state, double since);

  long missed() const { return missed_; }
  double first_missed() const { return first_missed_; }  ///< [s]

 private:
  std::vector<double> times_;
  std::size_t next_ = 0;
  long missed_ = 0;
  double first_missed_ = HUGE_VAL;
  const system::LocallyNonlinear& system_;
  system::EquilibriumAcceleration equilibrium_;
  Vector left_, right_;
};

}  // namespace rubato::integrate
