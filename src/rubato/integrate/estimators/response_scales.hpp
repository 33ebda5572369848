#pragma once

#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::integrate {

/// How large a response is about to be, and how fast, from one state. A shape of frequency omega (omega^2 = x^T K x /
/// x^T M x, K with all sliders stuck and the stops that touch) promises the displacement |a|/omega^2, |v|/omega or |q|
/// in the mass norm; each counts with its own frequency, so that an acceleration of round-off makes no fast motion of a
/// large displacement. A shape that nothing holds moves freely: its omega is that of a motion over the whole duration.
struct ResponseScales {
  struct Shape {
    double length = 0.0;     ///< in the mass norm; 0: at rest, or without load
    double frequency = 0.0;  ///< [rad/s]
    double rate =
        0.0;  ///< of what the shape does as an acceleration: the damping x^T C x/x^T M x if that is more [1/s]
  };
  Shape displacement, velocity, acceleration;
  double reached = 0.0;  ///< the displacement that the velocity is known to reach [m sqrt(kg)]

  /// Of the displacement to expect [m sqrt(kg)], of which the acceleration makes no more than `most`.
  double size(double most) const;
  double derivative(int k) const;    ///< |d^k q/dt^k|_M to expect, k = 1, 2 or 3
  double frequency_of(int k) const;  ///< of what makes most of that derivative
};

/// The displacement that a velocity reaches at least: the largest of single steps of backward Euler of the duration, a
/// tenth and a hundredth of it, v/(1/t + c + k t) in a mode. A velocity that stiff parts hold back at once may carry
/// soft ones far.
double reached_by(const system::LocallyNonlinear& system, const Vector& velocity, double duration);

ResponseScales response_scales(const system::LocallyNonlinear& system, const system::State& state,
                               const Vector& acceleration, double duration);

}  // namespace rubato::integrate
