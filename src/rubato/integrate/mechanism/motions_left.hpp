#pragma once

#include <rubato/system/mechanism_equations.hpp>

namespace rubato::integrate {

/// The equations of a mechanism about a rest in the motions that its constraints leave, dq = N z:
///
///   M z'' + C z' + K z = N^T f,   G N = 0,   K = N^T d(f + G^T multiplier)/dq N,   C = N^T df/dv N
///
/// In equilibrium K is symmetric but for loads without a potential, and round-off.
struct MotionsLeft {
  Matrix basis;                     ///< N, orthonormal by the diagonal of M [n x r]
  Matrix mass, damping, stiffness;  ///< entries of K that are round-off of the multipliers are zero [r x r]
  /// What each entry of K is the sum of, in units of which it is rounded, and what the round-off of the multipliers may
  /// make of it [r x r]
  Matrix terms, noise;

  Index freedoms() const { return basis.cols(); }
};

/// Dense: for up to some thousand coordinates. The equations are left at the state.
/// @param state  at rest, with the multipliers of its loads
MotionsLeft motions_left(system::MechanismEquations& equations, const system::State& state);

}  // namespace rubato::integrate
