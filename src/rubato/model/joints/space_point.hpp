#pragma once

#include <rubato/core/types.hpp>
#include <rubato/numerics/rotations.hpp>

#include <array>

namespace rubato::model {

/// A node in space, as elements and joints address it.
struct SpaceNode {
  Index q = 0;                   ///< of its first number: x, y, z, and the quaternion w, x, y, z
  std::array<Index, 6> place{};  ///< tangent coordinates of x, y, z and of the body axes; `ground` where fixed

  numerics::Vector3 position(const double* numbers) const { return {numbers[q], numbers[q + 1], numbers[q + 2]}; }
  numerics::Rotation rotation(const double* numbers) const {
    return {numbers[q + 3], numbers[q + 4], numbers[q + 5], numbers[q + 6]};
  }
};

/// A point that moves with a node: p = r + R offset.
struct SpacePoint {
  SpaceNode node;
  numerics::Vector3 offset = numerics::Vector3::Zero();  ///< in the axes of the node [m]
};

}  // namespace rubato::model
