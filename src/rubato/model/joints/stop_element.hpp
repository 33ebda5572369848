#pragma once

#include <rubato/model/bodies/element.hpp>
#include <rubato/model/joints/lock.hpp>

#include <memory>

namespace rubato::model {

/// The force of a [[stop]] while it is closed: -sign (stiffness depth + damping depth') on its s. What it stores is in
/// the accounts of stops.
/// @param index  among the locks of the mechanism
std::unique_ptr<Element> make_stop_element(const Lock& stop, int index);

}  // namespace rubato::model
