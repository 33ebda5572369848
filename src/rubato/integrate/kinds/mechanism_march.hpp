#pragma once

#include <rubato/integrate/march.hpp>
#include <rubato/integrate/march_plan.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <memory>

namespace rubato::integrate {

/// A march of a mechanism. Both must outlive it.
std::unique_ptr<StepMarch> make_mechanism_march(const MarchPlan& plan, const system::Mechanism& mechanism);

/// What measures the errors of one.
/// @param plan       whose start is known   @param step  of that plan, or a candidate for it
/// @param equations  lent
std::unique_ptr<Estimator> make_mechanism_estimator(const MarchPlan& plan, const AutomaticStep& step,
                                                    system::MechanismEquations& equations);

}  // namespace rubato::integrate
