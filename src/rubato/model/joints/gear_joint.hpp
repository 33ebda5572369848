#pragma once

#include <rubato/model/joints/free_coordinate.hpp>
#include <rubato/model/joints/joint.hpp>

#include <memory>
#include <string>

namespace rubato::model {

/// A ratio between the coordinates of two joints, g = s1 - ratio s2 - offset. Its row is "gear_moment" [N m] where s1
/// is an angle, else "gear_force" [N]: minus the multiplier acts on s1, ratio times the multiplier on s2.
std::unique_ptr<Joint> make_gear(std::string name, const FreeCoordinate& first, const FreeCoordinate& second,
                                 double ratio, double offset);

}  // namespace rubato::model
