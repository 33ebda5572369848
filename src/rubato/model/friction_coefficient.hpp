#pragma once

#include <rubato/model/description.hpp>
#include <rubato/model/laws/law.hpp>

#include <memory>
#include <string>

namespace rubato::model {

/// Whether a formula has a name in it.
bool names(const std::string& formula, const std::string& name);

/// Whether a coefficient of friction is a formula of the rate at which the ends slide.
inline bool depends_on_rate(const Quantity& coefficient) { return names(coefficient.expression, "rate"); }

/// Whether what presses on a slider stays the same.
bool has_constant_load(const SliderDescription& slider);

/// A slider as a law, with a coefficient of friction that is a number or a formula of `rate` [m/s].
///
/// Throws InvalidInput, at its place, where the formula is faulty or negative at a speed of up to 1 km/s.
/// @param stiffness  kT > 0 [N/m]
/// @param part       its name for messages: slider "foot"
std::shared_ptr<const Law> build_slider_law(const SliderDescription& slider, double stiffness,
                                            const numerics::Parameters& parameters, const std::string& part);

}  // namespace rubato::model
