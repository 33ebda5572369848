#pragma once

#include <rubato/model/joints/plane_point.hpp>

#include <algorithm>

namespace rubato::model {

/// How far the second point lies from the first along a direction that turns with the first node: s = m . (p2 - p1),
/// m = R1 direction. Derivatives are by x, y, angle of the first node and then of the second.
struct PlaneProjection {
  PlanePoint first, second;
  std::array<double, 2> direction{};  ///< in the axes of the first node, of length 1

  struct Now {
    PlanePoint::Now a, b;
    double dx, dy;  ///< p2 - p1
    double mx, my;
    double value() const { return mx * dx + my * dy; }
  };
  Now at(const double* q) const {
    Now now{first.at(q), second.at(q), 0.0, 0.0, 0.0, 0.0};
    now.dx = now.b.x - now.a.x;
    now.dy = now.b.y - now.a.y;
    const double c = std::cos(q[first.node.q + 2]), s = std::sin(q[first.node.q + 2]);
    now.mx = c * direction[0] - s * direction[1];
    now.my = s * direction[0] + c * direction[1];
    return now;
  }

  /// @param slope  [6]
  static void slope(const Now& now, double* slope) {
    const double nx = -now.my, ny = now.mx;  // dm/dangle1
    slope[0] = -now.mx;
    slope[1] = -now.my;
    slope[2] = nx * now.dx + ny * now.dy + now.mx * now.a.arm_y - now.my * now.a.arm_x;
    slope[3] = now.mx;
    slope[4] = now.my;
    slope[5] = -now.mx * now.b.arm_y + now.my * now.b.arm_x;
  }

  /// @param curvature  weight times the second derivatives [6 x 6]
  static void curvature(const Now& now, double weight, double* curvature) {
    std::fill(curvature, curvature + 36, 0.0);
    const double nx = -now.my, ny = now.mx;
    const auto set = [curvature, weight](int i, int j, double value) {
      curvature[i * 6 + j] = curvature[j * 6 + i] = weight * value;
    };
    set(0, 2, -nx);
    set(1, 2, -ny);
    set(2, 3, nx);
    set(2, 4, ny);
    // d2/dangle1^2: -m.d from m, twice n.(-arm1') from both, m.arm1 from p1.
    set(2, 2, -now.value() + 2.0 * (nx * now.a.arm_y - ny * now.a.arm_x) + now.mx * now.a.arm_x + now.my * now.a.arm_y);
    set(2, 5, -nx * now.b.arm_y + ny * now.b.arm_x);
    set(5, 5, -(now.mx * now.b.arm_x + now.my * now.b.arm_y));
  }
};

}  // namespace rubato::model
