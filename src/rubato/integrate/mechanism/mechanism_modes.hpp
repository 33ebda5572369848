#pragma once

#include <rubato/numerics/eigen_damped.hpp>
#include <rubato/system/mechanism_equations.hpp>

namespace rubato::integrate {

/// Free motions about a configuration.
struct MechanismModes {
  numerics::DampedModes found;  ///< shapes in all tangent coordinates [n]; they satisfy the constraints
  Index freedoms = 0;           ///< n less the constraints that say something of their own
  bool is_stable = true;  ///< false: the stiffness on the constraints has a negative eigenvalue, and nothing is found
  double growth = 0.0;    ///< of the motion that leaves it fastest, exp(growth t), without damping [1/s]; 0: stable
  double skew = 0.0;      ///< the size of the skew part of K, which is left out, over that of K [-]
};

/// The `count` lowest modes (at most `freedoms`) of a mechanism about a configuration at rest:
///
///   N^T (s^2 M + s C + K) N x = 0,   G N = 0,   shape = N x
///
/// with C = df/dv and the symmetric part of K = d(f + G^T multiplier)/dq. In equilibrium its skew part vanishes but for
/// loads without a potential, which follow their body. Dense: for up to some thousand coordinates.
MechanismModes modes_about(system::MechanismEquations& equations, const system::State& state, Index count);

}  // namespace rubato::integrate
