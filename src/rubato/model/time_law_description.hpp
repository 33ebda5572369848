#pragma once

#include <rubato/model/quantity.hpp>

#include <string>
#include <variant>
#include <vector>

// Laws of time, as the user wrote them. Part of model/description.hpp.
namespace rubato::model {

/// amplitude * cos(angular_frequency * t + phase)
struct HarmonicDescription {
  Quantity amplitude;          ///< of either sign
  Quantity angular_frequency;  ///< [rad/s]; `frequency` [Hz] of the file is turned into it by the factor below
  Quantity phase;              ///< [rad]
  bool frequency_in_hertz = false;
};

/// A formula of t and of the parameters.
struct TimeFormulaDescription {
  Quantity formula;  ///< `expression` is never empty
};

/// Linear interpolation between the rows of a CSV file (already read; time in the first column, increasing; two rows of
/// the same time are a jump).
struct TableDescription {
  enum class Beyond { error, zero, hold };  ///< what holds before the first row and after the last
  std::string file;
  std::vector<double> times;  ///< [s]
  std::vector<double> values;
  Beyond beyond = Beyond::error;
  Location where;
};

using TimeLawDescription = std::variant<HarmonicDescription, TimeFormulaDescription, TableDescription>;

}  // namespace rubato::model
