#pragma once

#include <cstddef>

// Private to the system floor.
namespace rubato::system {

/// The most places on which the coordinate of a joint with friction acts: two nodes in space.
inline constexpr std::size_t most_friction_places = 12;

}  // namespace rubato::system
