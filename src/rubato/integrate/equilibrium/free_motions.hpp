#pragma once

#include <rubato/numerics/eigen_damped.hpp>

namespace rubato::integrate {

/// Free motions about a configuration.
struct FreeMotions {
  numerics::DampedModes found;   ///< shapes in all tangent coordinates [n]; they satisfy the constraints
  Index freedoms = 0;            ///< n less the constraints that say something of their own
  bool is_stable = true;         ///< false: a motion grows; beyond 400 freedoms nothing is found then
  double growth = 0.0;           ///< of the motion that leaves it fastest, exp(growth t) [1/s]; 0: stable
  bool flutters = false;         ///< it grows as it oscillates
  double skew = 0.0;             ///< the size of the skew part of K over that of K [-]
  bool leaves_out_skew = false;  ///< which is left out, in models of more than 400 freedoms
};

}  // namespace rubato::integrate
