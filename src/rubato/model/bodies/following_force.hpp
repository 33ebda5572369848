#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/model/joints/plane_point.hpp>
#include <rubato/model/joints/space_point.hpp>
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

/// The same in space: R e law(t) at a point that moves with the node, e one of the axes of the node. About the node it
/// has the moment offset x e law(t), in the axes of the node, whatever R is.
/// @param axis  0, 1, 2: along x, y, z of the node
std::unique_ptr<Element> make_following_force(std::string name, const SpacePoint& point, std::size_t axis, TimeLaw law);

/// A moment about an axis of the world on a node in space: R^T e law(t) in the axes of the node. It has no potential
/// where the node turns about more than one axis (Argyris, Dunne and Scharpf 1978); its tangent is not symmetric.
/// @param axis  0, 1, 2: about x, y, z of the world
/// @param law   [N m]
std::unique_ptr<Element> make_fixed_moment(std::string name, const SpaceNode& node, std::size_t axis, TimeLaw law);

}  // namespace rubato::model
