#pragma once

#include <rubato/model/description.hpp>
#include <rubato/results/columns/observed_columns.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <string>
#include <vector>

namespace rubato::results {

/// What a transient of a mechanism shows: position, velocity and acceleration of what is observed, the coordinate that
/// each joint leaves free, the reactions, frictions and laws of the joints, laws with a memory, and section forces of
/// beams.
/// @param equations  lent to the columns
ColumnGroups columns_of_motion(system::MechanismEquations& equations, const std::vector<Observed>& observed,
                               const model::SectionForcesDescription& section_forces);

/// The same of an equilibrium: positions, and no friction. Throws InvalidInput for a beam that is not there.
/// @param equations  lent to the columns
/// @param title      of the analysis, for the error
ColumnGroups columns_of_equilibrium(system::MechanismEquations& equations, const std::vector<Observed>& observed,
                                    const model::SectionForcesDescription& section_forces, const std::string& title);

}  // namespace rubato::results
