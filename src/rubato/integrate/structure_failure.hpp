#pragma once

#include <rubato/integrate/march_failure.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::integrate {

/// Why a march of a structure ended before its time.
MarchFailure failure_of(const MarchReport& report, const system::LocallyNonlinear& system);

}  // namespace rubato::integrate
