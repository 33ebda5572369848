#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/model/joints/space_point.hpp>

#include <memory>
#include <string>

namespace rubato::model {

/// The moment omega x (J omega) on a body that turns in space, in its axes: with the constant mass J on the angular
/// acceleration, Euler's equations. It does no work.
/// @param inertia  J in the axes of the node, whose origin is the centre of mass [kg m2]
std::unique_ptr<Element> make_gyroscopic_moment(std::string name, const SpaceNode& node,
                                                const numerics::Matrix3& inertia);

}  // namespace rubato::model
