#pragma once

#include <rubato/numerics/formula.hpp>

#include <string>
#include <variant>
#include <vector>

namespace rubato::model {

/// amplitude * cos(angular_frequency * t + phase)
struct HarmonicLaw {
  double amplitude = 0.0;
  double angular_frequency = 0.0;  ///< [rad/s]
  double phase = 0.0;              ///< [rad]
};

struct FormulaLaw {
  numerics::Formula formula;  ///< of t [s]
};

/// Linear interpolation; times do not decrease, and two equal times are a jump with a value on either side.
struct TableLaw {
  enum class Beyond { error, zero, hold };  ///< before the first row and after the last
  std::vector<double> times;                ///< [s]
  std::vector<double> values;
  Beyond beyond = Beyond::error;  ///< error: an analysis refuses to run beyond the table before it starts
  std::string source;             ///< the file, for messages
};

/// A derivative of a formula with respect to t: how a support moves.
struct FormulaDerivative {
  numerics::Formula formula;
  int order = 0;  ///< 0, 1 or 2
};

/// A derivative of the natural cubic spline through the rows of a table, whose acceleration is continuous: how a
/// support moves. Beyond the rows it stands still.
struct SplineLaw {
  std::vector<double> times;       ///< rising, at least two [s]
  std::vector<double> values;      ///< at the rows
  std::vector<double> curvatures;  ///< second derivatives at the rows, zero at both ends
  int order = 0;                   ///< 0, 1 or 2
  bool holds_beyond = false;       ///< else an analysis refuses to run beyond the table
  std::string source;              ///< the file, for messages
};

using TimeLaw = std::variant<HarmonicLaw, FormulaLaw, TableLaw, FormulaDerivative, SplineLaw>;

/// The spline through the rows of a table (de Boor 1978, chapter 4), of order 0.
SplineLaw spline_through(const TableLaw& table);

/// Which limit to take where a law jumps.
enum class Side { left, right };

/// The value of a table at t; where `beyond` is error, the nearest row's (analyses check the range beforehand).
double value(const TableLaw& table, double t, Side side = Side::right);
double value(const TimeLaw& law, double t, Side side = Side::right);

}  // namespace rubato::model
