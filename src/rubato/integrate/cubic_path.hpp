#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::integrate {

/// A displacement over a step: the cubic through displacement and velocity of both ends.
struct CubicPath {
  double h, u0, v0, u1, v1;

  struct Place {
    double u, rate, acceleration;
  };
  /// At a share of the step.
  Place at(double share) const {
    const double s = share, r = 1.0 - s;
    double first = (6.0 * (u1 - u0) / h - 4.0 * v0 - 2.0 * v1) / h;
    double last = (6.0 * (u0 - u1) / h + 2.0 * v0 + 4.0 * v1) / h;
    // Of the displacements of a short step nothing but round-off is left.
    constexpr double round_off = 64.0 * std::numeric_limits<double>::epsilon(), little = 1e-2;
    const double mean = (v1 - v0) / h;
    if (!(round_off * (std::abs(u0) + std::abs(u1)) < little * h * h * std::max(std::abs(first), std::abs(last))))
      first = last = mean;
    return {r * r * (1.0 + 2.0 * s) * u0 + s * s * (3.0 - 2.0 * s) * u1 + h * s * r * (r * v0 - s * v1),
            6.0 * s * r * (u1 - u0) / h + r * (1.0 - 3.0 * s) * v0 + s * (3.0 * s - 2.0) * v1, r * first + s * last};
  }
};

}  // namespace rubato::integrate
