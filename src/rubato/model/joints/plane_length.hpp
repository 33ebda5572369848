#pragma once

#include <rubato/model/joints/plane_point.hpp>

#include <cmath>

namespace rubato::model {

/// How far two points in the plane are apart, |d|, d = p2 - p1. Derivatives are by x, y, angle of the first node and
/// then of the second.
struct PlaneLength {
  PlanePoint::Now a, b;

  PlaneLength(const PlanePoint& first, const PlanePoint& second, const double* q) : a(first.at(q)), b(second.at(q)) {}

  double dx() const { return b.x - a.x; }
  double dy() const { return b.y - a.y; }
  double value() const { return std::hypot(dx(), dy()); }

  /// @param row  a factor times the first derivatives of d . d / 2 [6]
  void half_square_slope(double factor, double* row) const {
    const double ux = factor * dx(), uy = factor * dy();
    row[0] = -ux;
    row[1] = -uy;
    row[2] = ux * a.arm_y - uy * a.arm_x;
    row[3] = ux;
    row[4] = uy;
    row[5] = uy * b.arm_x - ux * b.arm_y;
  }

  /// weight times the second derivatives of d . d / 2: those of d against d, and the slopes of d against each other.
  /// @param h  [6 x 6]
  void half_square_curvature(double weight, double* h) const {
    const double slope_x[6] = {-1.0, 0.0, a.arm_y, 1.0, 0.0, -b.arm_y};
    const double slope_y[6] = {0.0, -1.0, -a.arm_x, 0.0, 1.0, b.arm_x};
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) h[i * 6 + j] = weight * (slope_x[i] * slope_x[j] + slope_y[i] * slope_y[j]);
    h[2 * 6 + 2] += weight * (dx() * a.arm_x + dy() * a.arm_y);
    h[5 * 6 + 5] -= weight * (dx() * b.arm_x + dy() * b.arm_y);
  }

  /// @param slope  the first derivatives of |d| [6]
  void slope(double* slope) const { half_square_slope(1.0 / value(), slope); }

  /// @param curvature  weight times the second derivatives of |d| [6 x 6]
  void curvature(double weight, double* curvature) const {
    const double share = weight / value();
    double along[6];
    slope(along);
    half_square_curvature(share, curvature);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) curvature[i * 6 + j] -= share * along[i] * along[j];
  }
};

}  // namespace rubato::model
