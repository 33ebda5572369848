#pragma once

#include <rubato/model/joints/plane_coordinate.hpp>
#include <rubato/model/joints/space_joints.hpp>
#include <rubato/model/joints/space_rows.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::model {

/// The coordinate s that a joint in space leaves free: the angle by which the second part has turned about the axis,
/// the way along it, the length from one point to another, or of a screw the way along its thread as an angle (see
/// path_along_thread). Derivatives are by the increments of both nodes, rotations in body axes.
///
/// A rotation says its angle up to whole turns only. The turns are counted in the configuration: behind the numbers of
/// the nodes stands, for each angle, the angle with all its turns, which retract() carries on by continuity. A step
/// must not turn a joint by pi or more.
struct SpaceCoordinate {
  enum class Kind { angle, displacement, length };
  static constexpr int tangent_size = 12;
  static constexpr bool has_symmetric_curvature = false;

  Kind kind = Kind::angle;
  SpacePoint first, second;
  SpaceRow row;                            ///< a TurnAngle, a BodyGap or a PointDistance
  Index counter = -1;                      ///< of an angle: where in q its turns are counted
  double zero = 0.0;                       ///< subtracted from what the nodes say [rad] or [m]
  double share = 1.0;                      ///< of the row in s [-]
  BodyGap way{numerics::Vector3::Zero()};  ///< along a thread, what counts beside its angle
  double way_share = 0.0;                  ///< of the way in s [rad/m]; 0: no thread

  bool is_angle() const { return kind == Kind::angle; }
  /// As formulas call it.
  const char* name() const { return is_angle() ? "angle" : kind == Kind::length ? "length" : "displacement"; }
  bool has_constant_slope() const { return false; }
  std::vector<Index> places() const;
  double value(const double* q) const;
  void slope(const double* q, double* slope) const;                         ///< [12]
  void curvature(const double* q, double weight, double* curvature) const;  ///< [12 x 12]
  double rate(const Motion& motion) const;                                  ///< [rad/s] or [m/s]
  /// s'' for given accelerations.
  /// @param acceleration  [n], after a zero, as the velocities of a Motion
  double second_rate(const Motion& motion, const double* acceleration) const;
};

/// How far a point of the flanks at a radius has gone along the helix of a screw, divided by what it goes in a radian,
///
///   s = cos^2(a) angle + sin(a) cos(a)/radius way,    tan(a) = lead/(2 pi radius)
///
/// the angle itself where the thread holds. Its gradient is the direction along the helix, at a right angle to the
/// force between the flanks: a moment M on s is the force M cos(a)/radius along the helix.
/// @param angle  of the screw, with its zero
/// @param axis   in the axes of the first node, of length 1
SpaceCoordinate path_along_thread(const SpaceCoordinate& angle, const numerics::Vector3& axis, double lead,
                                  double radius);

/// The angle that lies nearest to one that is known: angle + 2 pi k.
double nearest_turn(double angle, double known);

std::unique_ptr<Element> make_joint_spring(std::string name, const SpaceCoordinate& s, double stiffness, double rest,
                                           const AtLock& when = {});
std::unique_ptr<Element> make_joint_damper(std::string name, const SpaceCoordinate& s, double damping,
                                           const AtLock& when = {});
std::unique_ptr<Element> make_joint_drive(std::string name, const SpaceCoordinate& s, const std::string& formula,
                                          const numerics::Parameters& parameters, const AtLock& when = {});
std::unique_ptr<Element> make_joint_table(std::string name, const SpaceCoordinate& s, CoordinateTable table,
                                          const AtLock& when = {});
std::unique_ptr<Joint> make_lock_joint(std::string name, const SpaceCoordinate& s, double at, int lock);

}  // namespace rubato::model
