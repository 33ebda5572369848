#pragma once

#include <rubato/core/types.hpp>

#include <cmath>
#include <limits>

namespace rubato::numerics {

/// What is left of (K - omega^2 M) phi, or of (s^2 M + s C + K) x, in a measure that does not depend on the units of
/// the coordinates, and that a light or soft coordinate feels beside a heavy or stiff one:
///
///   |r|^2 = sum_i |r_i|^2 / d_i,   |x|^2 = sum_i d_i |x_i|^2,   d_i = |K_ii| + |s C_ii| + |s^2 M_ii|
///
/// |r|/|x| is the relative change of K (with K_ij against sqrt(K_ii K_jj)) of which x is an exact solution. A solver
/// that keeps the largest entry of r small beside the largest of K loses low modes where d_i differ by 1e16.
/// Infinite where a number is not finite: a motion without mass has no mode.
class ScaledResidual {
 public:
  /// @param size  d [n]   @param residual, shape  r, x [n]
  template <class AnyVector>
  ScaledResidual(const Vector& size, const AnyVector& residual, const AnyVector& shape) {
    for (Index i = 0; i < size.size(); ++i) {
      if (size[i] <= 0.0) continue;  // nothing acts on this coordinate
      residual_ += std::norm(residual[i]) / size[i];
      shape_ += std::norm(shape[i]) * size[i];
    }
  }
  /// |r|/|x| [-]
  double backward() const { return shape_ <= 0.0 ? 0.0 : root_of_ratio(shape_); }
  /// |r| over the square root of an energy x^H K x: about the error of the shape, and the root of that of omega^2 [-]
  double of_energy(double energy) const { return energy <= 0.0 ? backward() : root_of_ratio(energy); }

 private:
  double root_of_ratio(double divisor) const {
    const double root = std::sqrt(residual_ / divisor);
    return std::isfinite(root) && std::isfinite(divisor) ? root : std::numeric_limits<double>::infinity();
  }

  double residual_ = 0.0, shape_ = 0.0;
};

}  // namespace rubato::numerics
