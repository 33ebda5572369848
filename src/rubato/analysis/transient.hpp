#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/kinds/system_kind.hpp>

#include <string>

namespace rubato::analysis {

/// Marches a planned transient and streams its rows; memory does not grow with the duration.
/// @param kind  of the system of the plan
RunReport run_transient(const std::string& name, const TransientPlan& plan, const integrate::SystemKind& kind,
                        RunContext& context);

}  // namespace rubato::analysis
