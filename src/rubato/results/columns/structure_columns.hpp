#pragma once

#include <rubato/results/columns/observed_columns.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::results {

/// What a transient of a structure shows: position, velocity and acceleration of what is observed, force and slip of
/// every slider, force and penetration of every stop, and the forces that move supports.
/// @param observed  of coordinates, then of supports that move
/// @param system    must outlive the columns
ColumnGroups columns_of_motion(const system::LocallyNonlinear& system, const std::vector<Observed>& observed);

}  // namespace rubato::results
