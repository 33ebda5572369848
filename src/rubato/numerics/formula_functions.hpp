#pragma once

#include <rubato/numerics/interval_series.hpp>
#include <rubato/numerics/time_derivatives.hpp>

#include <array>
#include <string>

namespace rubato::numerics {

/// A function of one number that formulas know.
struct FormulaFunction {
  const char* name;
  double (*value)(double);
  TimeDerivatives (*derivatives)(double);  ///< with its derivatives with respect to the number
  IntervalSeries (*over_interval)(const IntervalSeries&, int order);
};

const std::array<FormulaFunction, 18>& formula_functions();

/// Whether a name is one of these, or of those that branch or take several numbers (abs, sign, rint, atan2, min, max,
/// sum, avg): a parameter cannot bear it.
bool is_function(const std::string& name);

}  // namespace rubato::numerics
