#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/model/joints/plane_point.hpp>
#include <rubato/model/time_law.hpp>

#include <memory>
#include <string>

namespace rubato::model {

/// A force of the plane that turns with its node: R(angle) e law(t) at a point that moves with the node, e the axis x
/// or y of the node (Ziegler 1952: a follower force, which has no potential; its tangent is not symmetric).
/// @param name   of the part, for messages
/// @param axis   0: along x, 1: along y
/// @param law    [N]
std::unique_ptr<Element> make_following_force(std::string name, const PlanePoint& point, std::size_t axis, TimeLaw law);

}  // namespace rubato::model
