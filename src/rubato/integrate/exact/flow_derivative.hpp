#pragma once

#include <rubato/integrate/exact/taylor_piece.hpp>

#include <map>
#include <vector>

namespace rubato::integrate {

/// The derivative of the exact flow with respect to the state in which it starts, D = d(q, v, fc)/d(q0, v0, fc0)
/// [2n + m, 2n + m]. Over a piece it obeys the homogeneous linear equations,
///
///   dq' = dv,   M dv' = -C dv - K dq - B dfc,   dfc' = kT du' while a slider sticks, dfc = 0 while it slips.
///
/// The slider force, and so the acceleration, is continuous at a transition: there is no jump to account for, but that
/// a force at its limit does not move with the start any more. For Newton's matrix: exact to 1e-13 of its size for up
/// to sixteen unknowns, to 1e-7 for more.
class FlowDerivative {
 public:
  explicit FlowDerivative(const system::LocallyNonlinear& system);

  void set_identity();
  /// Goes on over a piece of a length [s], with its sliders in the given states.
  /// @param turn  length * the fastest rate of the piece, at most TaylorPiece::reach [-]
  void pass(double length, double turn, const std::vector<SliderState>& states);
  auto matrix() const { return derivative_.topRows(size_); }

 private:
  const Matrix& powers_of(const std::vector<SliderState>& states);

  const system::LocallyNonlinear& system_;
  Index n_, m_, size_, rows_;  // rows of matrices, with those that fill vectors of four
  int degree_;
  Matrix flow_;                                       // (q, v)' without sliders
  std::map<std::vector<SliderState>, Matrix> cache_;  // A^k/k! by columns of k
  Matrix derivative_, propagator_, product_;          // [rows x size]
  Vector length_powers_;
};

}  // namespace rubato::integrate
