#pragma once

#include <rubato/integrate/method.hpp>

namespace rubato::integrate {

/// Leading local errors of the generalized-alpha step, numerical minus exact, started with the auxiliary acceleration
/// that it settles to, A = q''(t + d h) + kappa h^2 q'''':
///
///   dq = displacement h^3 q''',   dv = velocity h^2 q''' + velocity_next h^3 q''''
///
/// `velocity` vanishes for second-order members, where the next term rules; `displacement` for linear acceleration.
struct ErrorConstants {
  double shift = 0.0;          ///< d = alpha_m - alpha_f
  double displacement = 0.0;   ///< beta - 1/6 + d/2
  double velocity = 0.0;       ///< gamma - 1/2 + d
  double velocity_next = 0.0;  ///< d^2/2 + gamma d + gamma/2 + kappa - 1/6
  int order = 2;               ///< of the method: 1 where `velocity` does not vanish
};

inline ErrorConstants error_constants(const GeneralizedAlpha& p) {
  ErrorConstants c;
  const double d = p.alpha_m - p.alpha_f, kappa = -0.5 * d * (1.0 - p.alpha_m - p.alpha_f);
  c.shift = d;
  c.displacement = p.beta - 1.0 / 6.0 + 0.5 * d;
  c.velocity = p.gamma - 0.5 + d;
  c.velocity_next = 0.5 * d * d + p.gamma * d + 0.5 * p.gamma + kappa - 1.0 / 6.0;
  constexpr double round_off = 1e-12;
  if (c.velocity < round_off && c.velocity > -round_off) c.velocity = 0.0;
  if (c.displacement < round_off && c.displacement > -round_off) c.displacement = 0.0;
  c.order = c.velocity == 0.0 ? 2 : 1;
  return c;
}

/// Wilson-theta carries A = q'' + theta (theta - 1)/2 h^2 q'''', so that its velocity errs by that much more than
/// linear acceleration's.
inline ErrorConstants error_constants(const WilsonTheta& method) {
  ErrorConstants c;
  c.velocity_next = 1.0 / 12.0 + 0.5 * method.theta * (method.theta - 1.0);
  return c;
}

}  // namespace rubato::integrate
