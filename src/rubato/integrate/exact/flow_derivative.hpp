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
/// a force at its limit does not move with the start any more. For Newton's matrix: exact to 1e-7 of its size.
class FlowDerivative {
 public:
  explicit FlowDerivative(const system::LocallyNonlinear& system);

  void set_identity();
  /// Goes on over a piece of a length [s], at most TaylorPiece::max_length(), with its sliders in the given states.
  void pass(double length, const std::vector<SliderState>& states);
  const Matrix& matrix() const { return derivative_; }

 private:
  static constexpr int degree = 14;  // reach^15/15! = 3e-8
  template <int N>
  void multiply();
  const Matrix& powers_of(const std::vector<SliderState>& states);

  const system::LocallyNonlinear& system_;
  Index n_, m_, size_;
  Matrix flow_, joins_;                               // (q, v)' without sliders; M^-1 B
  std::map<std::vector<SliderState>, Matrix> cache_;  // A^k/k! by columns of k
  Matrix derivative_, propagator_, product_;
  Vector length_powers_;
};

}  // namespace rubato::integrate
