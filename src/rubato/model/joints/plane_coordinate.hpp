#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/model/joints/coordinate_table.hpp>
#include <rubato/model/joints/joint.hpp>
#include <rubato/model/joints/plane_projection.hpp>
#include <rubato/numerics/formula.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::model {

/// The coordinate s that a joint in the plane leaves free: the angle between its nodes, the way along a direction, or
/// the length from one point to another.
struct PlaneCoordinate {
  enum class Kind { angle, displacement, length };
  Kind kind = Kind::angle;
  PlaneProjection along;  ///< of an angle only the nodes are used, of a length the points
  double zero = 0.0;      ///< subtracted from what the nodes say [rad] or [m]

  static constexpr int tangent_size = 6;
  static constexpr bool has_symmetric_curvature = true;
  bool is_angle() const { return kind == Kind::angle; }
  /// As formulas call it.
  const char* name() const { return is_angle() ? "angle" : kind == Kind::length ? "length" : "displacement"; }
  bool has_constant_slope() const { return is_angle(); }

  std::vector<Index> places() const;
  double value(const double* q) const;
  void slope(const double* q, double* slope) const;                         ///< [6]
  void curvature(const double* q, double weight, double* curvature) const;  ///< [6 x 6]
  double rate(const Motion& motion) const;                                  ///< [rad/s] or [m/s]
  /// s'' for given accelerations.
  /// @param acceleration  [n], after a zero, as the velocities of a Motion
  double second_rate(const Motion& motion, const double* acceleration) const;
};

/// Where a part stands in the phases of one lock, or of several in a row.
struct AtLock {
  int lock = -1;           ///< the first
  int count = 0;           ///< 0: always at work
  bool is_engaged = true;  ///< at work while one of them is engaged, or while all are open
  bool is_at_work(const Motion& motion) const {
    bool any = false;
    for (int i = 0; i < count; ++i) any = any || motion.phase[lock + i] != 0;
    return count == 0 || any == is_engaged;
  }
};

/// The force -stiffness (s - rest) on s. @param stiffness  [N m/rad] or [N/m]
std::unique_ptr<Element> make_joint_spring(std::string name, const PlaneCoordinate& s, double stiffness, double rest,
                                           const AtLock& when = {});

/// The force -damping s' on s. @param damping  [N m s/rad] or [N s/m]
std::unique_ptr<Element> make_joint_damper(std::string name, const PlaneCoordinate& s, double damping,
                                           const AtLock& when = {});

/// A force on s by a formula of `angle` (or `displacement`, `length`), `rate` and `t`. Its slopes are central
/// differences.
/// Throws InvalidInput for a faulty formula.
/// @param parameters  other names it may use
std::unique_ptr<Element> make_joint_drive(std::string name, const PlaneCoordinate& s, const std::string& formula,
                                          const numerics::Parameters& parameters, const AtLock& when = {});

/// A force on s by a table over s.
std::unique_ptr<Element> make_joint_table(std::string name, const PlaneCoordinate& s, CoordinateTable table,
                                          const AtLock& when = {});

/// s = at while the lock is engaged; nothing while it is open. Row "lock_moment" [N m] or "lock_force" [N].
std::unique_ptr<Joint> make_lock_joint(std::string name, const PlaneCoordinate& s, double at, int lock);

}  // namespace rubato::model
