#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/static_equilibrium.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/model/description.hpp>

namespace rubato::analysis {

/// The equilibrium that a description asks for. Throws InvalidInput at `where`: for a displacement that the model does
/// not hold, and where there is no equilibrium, naming the coordinates that move.
StaticEquilibrium equilibrium_of(const std::string& name, const Location& where,
                                 const model::StaticDescription& description, const system::LocallyNonlinear& system);

/// Writes the equilibrium as a table of one row: displacements, angles, slider forces and the reactions on held
/// displacements. Throws what equilibrium_of throws.
RunReport run_static(const std::string& name, const Location& where, const model::StaticDescription& description,
                     const system::LocallyNonlinear& system, RunContext& context);

}  // namespace rubato::analysis
