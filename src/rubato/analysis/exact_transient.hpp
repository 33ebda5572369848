#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::analysis {

/// A planned transient by the event-driven flow, for the method `exact`.
RunReport run_exact_transient(const std::string& name, const TransientPlan& plan,
                              const system::LocallyNonlinear& system, RunContext& context);

}  // namespace rubato::analysis
