#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/transient_plan.hpp>

namespace rubato::analysis {

/// Marches a planned transient and streams its rows; memory does not grow with the duration.
RunReport run_transient(const std::string& name, const TransientPlan& plan, const system::LocallyNonlinear& system,
                        RunContext& context);

/// Throws InvalidInput where the event-driven flow cannot run the system: too many coordinates, loads by formulas of t.
void check_exact_transient(const Location& where, const system::LocallyNonlinear& system);

/// The same by the event-driven flow, for the method `exact`.
RunReport run_exact_transient(const std::string& name, const TransientPlan& plan,
                              const system::LocallyNonlinear& system, RunContext& context);

}  // namespace rubato::analysis
