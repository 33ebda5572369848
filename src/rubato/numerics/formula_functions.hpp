#pragma once

#include <rubato/numerics/interval_series.hpp>
#include <rubato/numerics/time_formula.hpp>

#include <array>

namespace rubato::numerics {

/// A function of one number that formulas know.
struct FormulaFunction {
  const char* name;
  TimeDerivatives (*of)(double);  ///< with its derivatives with respect to the number
  IntervalSeries (*over_interval)(const IntervalSeries&, int order);
};

const std::array<FormulaFunction, 18>& formula_functions();

}  // namespace rubato::numerics
