#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/model.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rubato::integrate {

/// The forces of all sliders at the end of a step, from what the step gives them without friction.
///
/// The displacement of the sliders depends on their forces by u = u_free - W fc with the contact compliance W [m x m]
/// [m/N], and the return map of each is fc = clamp(fc0 + kT (u - u0), -L, L). Together
///
///   fc = clamp(trial - Q fc, -L, L),   trial = fc0 + kT (u_free - u0),   Q = diag(kT) W
///
/// With W symmetric and positive semi-definite the solution is unique (a box-constrained linear complementarity problem
/// with a P-matrix). The set of sticking sliders is found by a semismooth Newton iteration (exact at a finite set: its
/// Jacobian is the consistent tangent) and, should that cycle, by pivoting on the least index (Murty 1974), which ends.
/// The result depends on the set only, not on the way to it.
class ContactProblem {
 public:
  /// @param compliance  W [m x m]
  void reset(const Matrix& compliance, const std::vector<model::Slider>& sliders);

  /// @param trial     fc0 + kT (u_free - u0) [m] [N]
  /// @param previous  fc0 [m]: where it stands on its limit tells where to begin, not where to end
  /// @param force     fc [m]
  /// @return false if no consistent set was found (W not positive semi-definite, or not finite input)
  bool solve(const double* trial, const double* previous, double* force);

  /// The slider that was inconsistent when solve last failed.
  Index worst() const { return worst_; }

 private:
  bool solve_two(const double* trial, const double* previous, double* force);
  bool solve_many(const double* trial, const double* previous, double* force);
  void force_of_the_set(const double* trial, double* force);
  /// The state that slider i takes given the forces of all: -1, +1 slipping, 0 sticking.
  int state_of(Index i, const double* trial, const double* force) const;

  Index m_ = 0;
  Matrix scaled_compliance_;  // Q
  Vector limit_;
  double q_[2][2] = {{0, 0}, {0, 0}};
  double l_[2] = {0, 0};
  std::vector<int> set_, next_, factored_set_;
  Matrix tangent_;  // factorised in place
  Vector right_;
  Eigen::Transpositions<Eigen::Dynamic> row_swaps_;
  Index worst_ = -1;
};

inline bool ContactProblem::solve(const double* trial, const double* previous, double* force) {
  if (m_ == 0) return true;
  if (m_ == 1) {
    force[0] = std::clamp(trial[0] / (1.0 + q_[0][0]), -l_[0], l_[0]);
    return true;
  }
  return m_ == 2 ? solve_two(trial, previous, force) : solve_many(trial, previous, force);
}

}  // namespace rubato::integrate
