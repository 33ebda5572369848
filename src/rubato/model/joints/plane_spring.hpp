#pragma once

#include <rubato/model/bodies/element.hpp>

#include <memory>
#include <string>

namespace rubato::model {

/// A number of a node as springs address it: where it lies in q, and the tangent coordinate that moves it.
struct NodeNumber {
  Index q = -1;  ///< -1: the ground, whose number is 0
  Index place = ground;
};

/// A spring and a damper between two coordinates: the force -(stiffness (u - rest) + damping u') on the first and its
/// opposite on the second, u = first - second.
/// @param stiffness  [N/m] or [N m/rad]   @param damping  [N s/m] or [N m s/rad]
std::unique_ptr<Element> make_coordinate_spring(std::string name, const NodeNumber& first, const NodeNumber& second,
                                                double stiffness, double rest);
std::unique_ptr<Element> make_coordinate_damper(std::string name, const NodeNumber& first, const NodeNumber& second,
                                                double damping);

}  // namespace rubato::model
