#pragma once

#include <rubato/model/joints/number_difference.hpp>
#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/model/joints/space_coordinate.hpp>

#include <utility>
#include <variant>
#include <vector>

namespace rubato::model {

/// The coordinate s that a joint leaves free, in the plane or in space, or a difference of two coordinates: what locks
/// and friction watch.
struct FreeCoordinate {
  static constexpr int most_places = SpaceCoordinate::tangent_size;

  std::variant<PlaneCoordinate, SpaceCoordinate, NumberDifference> of;

  FreeCoordinate() = default;
  FreeCoordinate(const PlaneCoordinate& s) : of(s) {}
  FreeCoordinate(const SpaceCoordinate& s) : of(s) {}
  FreeCoordinate(const NumberDifference& s) : of(s) {}

  bool is_angle() const {
    return std::visit([](const auto& s) { return s.is_angle(); }, of);
  }
  std::vector<Index> places() const {
    return std::visit([](const auto& s) { return s.places(); }, of);
  }
  double value(const double* q) const {
    return std::visit([&](const auto& s) { return s.value(q); }, of);
  }
  /// @param slope  ds/dq [k]
  void slope(const double* q, double* slope) const {
    std::visit([&](const auto& s) { s.slope(q, slope); }, of);
  }
  /// @param curvature  weight d2s/dq2 [k x k]
  void curvature(const double* q, double weight, double* curvature) const {
    std::visit([&](const auto& s) { s.curvature(q, weight, curvature); }, of);
  }
  /// [rad/s] or [m/s]
  double rate(const Motion& motion) const {
    return std::visit([&](const auto& s) { return s.rate(motion); }, of);
  }
  /// s'' for given accelerations [rad/s2] or [m/s2].
  /// @param acceleration  [n], after a zero, as the velocities of a Motion
  double second_rate(const Motion& motion, const double* acceleration) const {
    return std::visit([&](const auto& s) { return s.second_rate(motion, acceleration); }, of);
  }
};

}  // namespace rubato::model
