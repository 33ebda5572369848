#pragma once

#include <rubato/model/joints/joint.hpp>
#include <rubato/model/joints/plane_point.hpp>

#include <memory>
#include <string>

// Joints between two nodes in the plane. Each makes its points and directions from the configuration in which it is
// assembled; local coordinates are x, y, angle of the first node and then of the second.
namespace rubato::model {

/// The points stay together: g = p2 - p1; rows x, y [N].
std::unique_ptr<Joint> make_plane_revolute(std::string name, const PlanePoint& first, const PlanePoint& second);

/// The points stay together and the relative angle stays: g = (p2 - p1, angle2 - angle1 - angle); rows x, y [N], moment
/// [N m].
/// @param angle  angle2 - angle1 that is kept [rad]
std::unique_ptr<Joint> make_plane_rigid(std::string name, const PlanePoint& first, const PlanePoint& second,
                                        double angle);

/// The second point slides along a line through the first that turns with its node, and the relative angle stays:
/// g = (n . (p2 - p1), angle2 - angle1 - angle) with n across the line; rows normal [N], moment [N m].
/// @param axis   direction of the line in the axes of the first node, of length 1
/// @param holds_angle  false: a pin in a slot, without the second row
std::unique_ptr<Joint> make_plane_prismatic(std::string name, const PlanePoint& first, const PlanePoint& second,
                                            const std::array<double, 2>& axis, double angle, bool holds_angle = true);

/// The points keep their distance: g = (|p2 - p1|^2 - L^2)/(2 L); row tension [N]. L > 0.
std::unique_ptr<Joint> make_plane_distance(std::string name, const PlanePoint& first, const PlanePoint& second,
                                           double length);

}  // namespace rubato::model
