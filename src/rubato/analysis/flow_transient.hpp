#pragma once

#include <rubato/analysis/run_context.hpp>
#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/march.hpp>

#include <string>

namespace rubato::analysis {

/// A planned transient by a march without steps: rows at the times that are asked for, or as many as show the motion,
/// and at transitions.
RunReport run_flow(const std::string& name, const TransientPlan& plan, integrate::FlowMarch& march,
                   RunContext& context);

}  // namespace rubato::analysis
