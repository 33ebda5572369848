#pragma once

#include <rubato/integrate/march.hpp>
#include <rubato/integrate/march_plan.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <memory>

namespace rubato::integrate {

/// A march of a structure. Both must outlive it.
std::unique_ptr<StepMarch> make_structure_march(const MarchPlan& plan, const system::LocallyNonlinear& system);

}  // namespace rubato::integrate
