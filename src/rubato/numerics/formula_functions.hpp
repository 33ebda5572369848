#pragma once

#include <rubato/numerics/interval_series.hpp>
#include <rubato/numerics/time_derivatives.hpp>

#include <array>
#include <string>

namespace rubato::numerics {

/// What the opposite arguments make of a value: the same, f(-x) = f(x), or the opposite, f(-x) = -f(x). Of zero both;
/// neither where nothing is known.
struct Parity {
  bool is_even = false, is_odd = false;
};

/// A function of one number that formulas know.
struct FormulaFunction {
  const char* name;
  double (*value)(double);
  TimeDerivatives (*derivatives)(double);  ///< with its derivatives with respect to the number
  IntervalSeries (*over_interval)(const IntervalSeries&, int order);
  Parity parity;
};

const std::array<FormulaFunction, 18>& formula_functions();

/// Whether a name is one of these, or of those that branch or take several numbers (abs, sign, rint, atan2, min, max,
/// sum, avg): a parameter cannot bear it.
bool is_function(const std::string& name);

}  // namespace rubato::numerics
