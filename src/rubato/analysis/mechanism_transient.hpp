#pragma once

#include <rubato/analysis/mechanism_plan.hpp>
#include <rubato/analysis/run_context.hpp>

namespace rubato::analysis {

/// Marches a planned transient of a mechanism and streams its rows. Locks are located with fixed steps too.
RunReport run_mechanism(const std::string& name, const MechanismPlan& plan, const system::Mechanism& mechanism,
                        RunContext& context);

}  // namespace rubato::analysis
