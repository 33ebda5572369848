#pragma once

#include <rubato/numerics/rotations.hpp>

#include <fmt/format.h>

#include <string>

namespace rubato::testing {

/// A plane that lies askew in space, to write studies of the plane in it.
struct TiltedPlane {
  numerics::Vector3 turn_vector{0.5, -0.7, 0.3};
  numerics::Vector3 origin{0.4, -0.2, 0.9};

  numerics::Vector3 direction_of(double x, double y, double z = 0.0) const {
    return numerics::rotation_of(turn_vector) * numerics::Vector3(x, y, z);
  }
  static std::string text(const numerics::Vector3& v) {
    return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v[0], v[1], v[2]);
  }
  std::string point(double x, double y) const { return text(origin + direction_of(x, y)); }
  std::string direction(double x, double y) const { return text(direction_of(x, y)); }
  std::string normal() const { return text(direction_of(0.0, 0.0, 1.0)); }
  /// Of a body whose axes x and y lie in the plane, turned by an angle in it.
  std::string rotation(double angle = 0.0) const {
    const auto turn = numerics::rotation_of(turn_vector) * numerics::rotation_of({0.0, 0.0, angle});
    return text(numerics::vector_of(turn));
  }
};

}  // namespace rubato::testing
