#pragma once

#include <rubato/numerics/eigen_damped.hpp>
#include <rubato/system/mechanism_equations.hpp>

namespace rubato::integrate {

/// Free motions about a configuration.
struct MechanismModes {
  numerics::DampedModes found;   ///< shapes in all tangent coordinates [n]; they satisfy the constraints
  Index freedoms = 0;            ///< n less the constraints that say something of their own
  bool is_stable = true;         ///< false: a motion grows; beyond 400 freedoms nothing is found then
  double growth = 0.0;           ///< of the motion that leaves it fastest, exp(growth t) [1/s]; 0: stable
  bool flutters = false;         ///< it grows as it oscillates
  double skew = 0.0;             ///< the size of the skew part of K over that of K [-]
  bool leaves_out_skew = false;  ///< which is left out, in models of more than 400 freedoms
};

/// The `count` lowest modes of a mechanism about a configuration at rest, and all up to the last that grows:
///
///   N^T (s^2 M + s C + K) N x = 0,   G N = 0,   shape = N x
///
/// with C = df/dv and K = d(f + G^T multiplier)/dq. In equilibrium K is symmetric but for loads without a potential,
/// which follow their body: with them some motions may flutter (Ziegler 1952). Dense: for up to some thousand
/// coordinates.
MechanismModes modes_about(system::MechanismEquations& equations, const system::State& state, Index count);

}  // namespace rubato::integrate
