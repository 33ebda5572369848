#pragma once

#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::integrate {

/// How large a response is about to be, and how fast, from one state.
struct ResponseScales {
  double size = 0.0;          ///< displacement in the mass norm [m sqrt(kg)]; 0: at rest without load
  double frequency = 0.0;     ///< [rad/s]; 0: at rest without load
  double acceleration = 0.0;  ///< in the mass norm
};

/// The acceleration a promises the displacement |a|/omega^2 with the frequency of its own shape, omega^2 = a^T K a /
/// a^T M a (K with all sliders stuck); a velocity likewise |v|/omega. A shape that nothing holds moves freely: its
/// omega is that of a motion over the whole duration.
ResponseScales response_scales(const system::LocallyNonlinear& system, const system::State& state,
                               const Vector& acceleration, double duration);

}  // namespace rubato::integrate
