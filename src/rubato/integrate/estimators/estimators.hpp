#pragma once

#include <rubato/integrate/estimators/error_constants.hpp>
#include <rubato/integrate/estimators/error_space.hpp>
#include <rubato/integrate/estimators/estimator.hpp>

// One factory an estimator; make_estimator chooses among them.
namespace rubato::integrate {

std::unique_ptr<Estimator> make_inertia_jump(const InertiaJump& kind, const GeneralizedAlpha& method,
                                             std::unique_ptr<ErrorSpace> space, const system::State& start);
std::unique_ptr<Estimator> make_local_error(const LocalError& kind, const ErrorConstants& constants,
                                            std::unique_ptr<ErrorSpace> space, double duration);
std::unique_ptr<Estimator> make_embedded(const Embedded& kind, const Method& method,
                                         const system::LocallyNonlinear& system, Stepper& stepper, double duration,
                                         const std::vector<numerics::StepBound>& bounds);

/// A pair of explicit Runge-Kutta methods, or Wilson-theta.
bool can_embed(const Method& method);

}  // namespace rubato::integrate
