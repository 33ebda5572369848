#pragma once

#include <rubato/model/bodies/motion.hpp>
#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/model/joints/plane_spring.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace rubato::model {

/// The difference of the numbers of two nodes, first - second, less that of the configuration given.
struct NumberDifference {
  NodeNumber first, second;
  double zero = 0.0;         ///< their difference in the configuration given [rad] or [m]
  bool is_rotation = false;  ///< of nodes in the plane

  static constexpr int tangent_size = 2;
  static constexpr bool has_symmetric_curvature = true;
  bool is_angle() const { return is_rotation; }
  bool has_constant_slope() const { return true; }

  std::vector<Index> places() const { return {first.place, second.place}; }
  double value(const double* q) const {
    return (first.q < 0 ? 0.0 : q[first.q]) - (second.q < 0 ? 0.0 : q[second.q]) - zero;
  }
  void slope(const double*, double* slope) const {
    slope[0] = 1.0;
    slope[1] = -1.0;
  }
  void curvature(const double*, double, double* curvature) const { std::fill(curvature, curvature + 4, 0.0); }
  double rate(const Motion& motion) const { return motion.v[first.place] - motion.v[second.place]; }
  double second_rate(const Motion&, const double* acceleration) const {
    return acceleration[first.place] - acceleration[second.place];
  }
};

/// As those of a PlaneCoordinate.
std::unique_ptr<Element> make_joint_spring(std::string name, const NumberDifference& s, double stiffness, double rest,
                                           const AtLock& when = {});
std::unique_ptr<Element> make_joint_damper(std::string name, const NumberDifference& s, double damping,
                                           const AtLock& when = {});
std::unique_ptr<Joint> make_lock_joint(std::string name, const NumberDifference& s, double at, int lock);

}  // namespace rubato::model
