#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/model.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rubato::integrate {

/// The forces of all contacts, sliders, stops and then laws in a linear form, at the end of a step, from what the step
/// gives them without.
///
/// The displacement of the contacts depends on their forces by u = u_free - W fc with the contact compliance W [m x m]
/// [m/N], and their velocity by du/dt = v_free - W' fc. The return map of a slider is fc = clamp(fc0 + kT (u - u0), -L,
/// L), a stop pushes with fs = max(0, k (u - gap) + c du/dt). Together
///
///   sliders  fc = clamp(trial - Q fc, -L, L),   trial = fc0 + kT (u_free - u0),        Q = kT W
///   stops    fs = max(0, trial - Q fc),         trial = k (u_free - gap) + c v_free,   Q = k W + c W'
///
/// in their rows. A damped stop that its own damping would throw back over the gap within the step touches: the gap is
/// closed, u = gap, by a force between zero and trial - Q fc. A law whose force is linear in u and du/dt is a row that
/// always has its equation.
///
/// With W symmetric and positive semi-definite the solution is unique (a box-constrained linear complementarity problem
/// with a P-matrix). The set of sticking sliders is found by a semismooth Newton iteration (exact at a finite set: its
/// Jacobian is the consistent tangent) and, should that cycle, by pivoting on the least index (Murty 1974), which ends.
/// The result depends on the set only, not on the way to it.
class ContactProblem {
 public:
  /// @param compliance           W [m x m] [m/N]
  /// @param velocity_compliance  W' [m x m] [m/(N s)]; read only where there are stops
  /// @param laws                 rows behind them, whose slopes set_slopes() gives
  void reset(const Matrix& compliance, const Matrix& velocity_compliance, const std::vector<model::Slider>& sliders,
             const std::vector<model::Stop>& stops, Index laws = 0);
  /// The row of a law: fc = trial - Q fc with Q = k W + c W', trial = f + k (u_free - u) + c (v_free - v) about the
  /// point of which f, k and c are the force and its slopes.
  void set_slopes(Index contact, double k, double c);
  /// Behind set_slopes(): the force of the law rises by `slope` times the force of another contact, which presses on
  /// it; that force, times the slope, is no part of its trial. The matrix of the problem is not symmetric then, and
  /// the pivots may not end: solve() says so.
  void add_slope(Index contact, Index other, double slope) { scaled_compliance_(contact, other) -= slope; }
  /// Behind set_slopes(), of a law of several numbers: its force rises with u and du/dt of another contact as well, by
  /// k and c. Not symmetric in general, either.
  void add_slopes(Index contact, Index other, double k, double c);
  /// Sliders alone.
  void reset(const Matrix& compliance, const std::vector<model::Slider>& sliders);

  /// @param trial        as above [m] [N]
  /// @param previous     fc0 [m]: where it stands on its limit tells where to begin, not where to end
  /// @param force        fc [m]
  /// @param penetration  u_free - gap [m] [m]; read for stops only
  /// @return false if no consistent set was found (W not positive semi-definite, or not finite input)
  bool solve(const double* trial, const double* previous, double* force, const double* penetration = nullptr);

  /// The contact that was inconsistent when solve last failed.
  Index worst() const { return worst_; }

 private:
  bool solve_laws(const double* trial, double* force);
  bool solve_two(const double* trial, const double* previous, double* force);
  bool solve_stop(const double* trial, double* force, const double* penetration) const;
  bool solve_many(const double* trial, const double* previous, double* force, const double* penetration);
  void force_of_the_set(const double* trial, double* force, const double* penetration);
  /// The state that contact i takes given the forces of all. Sliders: -1, +1 slipping, 0 sticking; stops: 0 pushing,
  /// +1 open, 2 touching.
  int state_of(Index i, const double* trial, const double* force, const double* penetration) const;
  int stop_state(Index i, double rest, double size, const double* force, const double* penetration) const;

  Index m_ = 0, sliders_ = 0, boxes_ = 0;  // contacts; of them sliders, and those before the laws
  Matrix compliance_;                      // W, kept for stops and laws
  Matrix velocity_compliance_;             // W', kept for laws
  Vector touching_scale_;                  // turns metres into newtons in the rows of touching stops
  Matrix scaled_compliance_;               // Q
  Vector limit_;                           // of stops zero: open is their state at it
  double q_[2][2] = {{0, 0}, {0, 0}};
  double l_[2] = {0, 0};
  std::vector<int> set_, next_, factored_set_;
  Matrix tangent_;  // factorised in place
  Vector right_;
  Eigen::Transpositions<Eigen::Dynamic> row_swaps_;
  Index worst_ = -1;
};

inline bool ContactProblem::solve(const double* trial, const double* previous, double* force,
                                  const double* penetration) {
  if (m_ == 0) return true;
  if (boxes_ == 0) return solve_laws(trial, force);
  if (m_ > boxes_) return solve_many(trial, previous, force, penetration);
  if (m_ > sliders_)
    return m_ == 1 ? solve_stop(trial, force, penetration) : solve_many(trial, previous, force, penetration);
  if (m_ == 1) {
    force[0] = std::clamp(trial[0] / (1.0 + q_[0][0]), -l_[0], l_[0]);
    return true;
  }
  return m_ == 2 ? solve_two(trial, previous, force) : solve_many(trial, previous, force, penetration);
}

}  // namespace rubato::integrate
