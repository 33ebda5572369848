#pragma once

#include <rubato/model/finite_elements/finite_elements.hpp>

#include <vector>

// Private to the model floor.
namespace rubato::model {

/// What the matrices have of each direction of each node, from the places of rows and the elements of the mesh [p].
/// A node whose elements move in a direction and that has no row of it is held in it; rotations count as known to a
/// node where one that shares an element with it has rows of them. Without elements a direction is known to all nodes
/// where one has a row of it, and rotations only to those that have them.
/// @param held_in_files  rows that a large diagonal holds, rising
std::vector<std::array<Freedom, 6>> freedoms_of(const FiniteElements& model,
                                                const std::vector<RowLabel>& held_in_files);

/// Whether a node has a row, and is held in some direction.
bool is_partly_held(const FiniteElements& model, std::size_t node);

}  // namespace rubato::model
