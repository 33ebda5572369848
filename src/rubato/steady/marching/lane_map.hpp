#pragma once

#include <rubato/integrate/method.hpp>
#include <rubato/steady/marching/period_map.hpp>

#include <memory>

namespace rubato::steady {

/// The map of a method of the alpha family or of the exponential one for small models, several points side by side: in
/// the modes of the structure without sliders, where a step couples two or three numbers only (all of them where the
/// damping couples the modes). The matrices of a step are read off the steppers of the catalogue, run on unit states
/// and unit loads, so that each formula exists once. Null where the method is another one, or the model has more than
/// 16 coordinates or sliders. The system must outlive it; the request says what records hold.
std::unique_ptr<PeriodMap> make_lane_map(const integrate::Method& method, const system::LocallyNonlinear& system,
                                         const SteadyRequest& request);

}  // namespace rubato::steady
