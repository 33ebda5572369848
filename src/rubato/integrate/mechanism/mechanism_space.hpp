#pragma once

#include <rubato/integrate/estimators/error_space.hpp>
#include <rubato/system/mechanism.hpp>

#include <memory>

namespace rubato::integrate {

/// What estimators ask of a mechanism, which must outlive it. Errors are measured by its reference value, or by that of
/// one metre and one radian in every coordinate; frequencies by the slope of the forces, those of the constraints
/// included, along the motion. Configurations have no size of their own.
std::unique_ptr<ErrorSpace> make_error_space(const system::Mechanism& mechanism);

}  // namespace rubato::integrate
