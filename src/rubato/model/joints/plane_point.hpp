#pragma once

#include <rubato/model/bodies/motion.hpp>

#include <array>
#include <cmath>

namespace rubato::model {

/// A node in the plane, as elements and joints address it.
struct PlaneNode {
  Index q = 0;                   ///< of its first number
  std::array<Index, 3> place{};  ///< tangent coordinates of x, y and the angle; `ground` where fixed
};

/// A point that moves with a plane node: p = r + R(angle) s.
struct PlanePoint {
  PlaneNode node;
  std::array<double, 2> offset{};  ///< s, in the axes of the node [m]

  /// Where it is now, with its arm R s from the node, whose derivative in the angle is (-arm_y, arm_x).
  struct Now {
    double x, y, arm_x, arm_y;
  };
  Now at(const double* q) const {
    const double* number = q + node.q;
    if (offset[0] == 0.0 && offset[1] == 0.0) return {number[0], number[1], 0.0, 0.0};
    const double c = std::cos(number[2]), s = std::sin(number[2]);
    const double x = c * offset[0] - s * offset[1], y = s * offset[0] + c * offset[1];
    return {number[0] + x, number[1] + y, x, y};
  }
};

}  // namespace rubato::model
