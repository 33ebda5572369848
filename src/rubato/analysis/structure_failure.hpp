#pragma once

#include <rubato/analysis/transient_plan.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <string>

namespace rubato::analysis {

/// Why a march of a structure ended before its time, with the names of the user's parts, and what may help.
std::string failure_of(const integrate::MarchReport& report, const TransientPlan& plan,
                       const system::LocallyNonlinear& system);

}  // namespace rubato::analysis
