#pragma once

#include <rubato/integrate/march.hpp>
#include <rubato/integrate/march_plan.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <memory>

namespace rubato::integrate {

/// The event-driven flow of a structure, as a march. Both must outlive it. Throws what ExactFlow throws.
std::unique_ptr<FlowMarch> make_structure_flow(const MarchPlan& plan, const system::LocallyNonlinear& system);

}  // namespace rubato::integrate
