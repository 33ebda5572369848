#pragma once

#include <fmt/format.h>

#include <numbers>
#include <string>

namespace rubato::analysis {

/// "angular_frequency = 7.5 rad/s", and in a study that excites by a frequency in hertz " (1.194 Hz)" behind it.
/// @param excitation_factor  value of the excitation's parameter over the angular frequency: 1, or 1/(2 pi) in hertz
inline std::string frequency_text(double angular_frequency, double excitation_factor) {
  const std::string text = fmt::format("angular_frequency = {:.9g} rad/s", angular_frequency);
  if (excitation_factor == 1.0) return text;
  return text + fmt::format(" ({:.6g} Hz)", 0.5 * angular_frequency / std::numbers::pi);
}

}  // namespace rubato::analysis
