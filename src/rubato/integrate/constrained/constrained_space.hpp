#pragma once

#include <rubato/integrate/estimators/error_space.hpp>
#include <rubato/system/constrained_system.hpp>

#include <memory>

namespace rubato::integrate {

/// How large a constrained system is [m sqrt(kg)]: its reference value, or that of one metre and one radian in every
/// coordinate.
double extent(const system::ConstrainedSystem& system);

/// The size by which errors are measured at least [m sqrt(kg)], a share of the system's extent (its reference value,
/// or that of one metre and one radian in every coordinate): a hundredth for tolerances above 1e-4. Below, it grows
/// with the root to the whole at 1e-8, since what Newton's method leaves of a step, over its length, must stay below.
double least_size(const system::ConstrainedSystem& system, double tolerance);

/// What estimators ask of a constrained system, which must outlive it. Errors are measured by the way from the start,
/// and before by what the start promises of it, between the least size and the extent; frequencies by the slope of the
/// forces, those of the constraints included, along the motion. Configurations have no size of their own.
/// @param start      of the march
/// @param tolerance  of the errors [-]
std::unique_ptr<ErrorSpace> make_error_space(const system::ConstrainedSystem& system, const system::State& start,
                                             double tolerance);

/// The same with equations that are lent; wherever they are left is well.
std::unique_ptr<ErrorSpace> make_error_space(system::ConstrainedEquations& equations, const system::State& start,
                                             double tolerance);

}  // namespace rubato::integrate
