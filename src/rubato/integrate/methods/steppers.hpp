#pragma once

#include <rubato/integrate/stepper.hpp>

#include <memory>

// One factory a family; make_stepper chooses among them.
namespace rubato::integrate {

std::unique_ptr<Stepper> make_alpha_stepper(const GeneralizedAlpha& parameters, const system::LocallyNonlinear& system);
std::unique_ptr<Stepper> make_wilson_stepper(const WilsonTheta& method, const system::LocallyNonlinear& system);
std::unique_ptr<Stepper> make_runge_kutta_stepper(const RungeKutta& method, const system::LocallyNonlinear& system);
std::unique_ptr<Stepper> make_exponential_stepper(const system::LocallyNonlinear& system);

}  // namespace rubato::integrate
