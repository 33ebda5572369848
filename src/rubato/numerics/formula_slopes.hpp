#pragma once

#include <rubato/numerics/time_formula.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rubato::numerics {

/// The derivatives of a formula with respect to values that change with what moves, such as the angle of a joint and
/// its rate: exact but for round-off, as TimeFormula's by t are, and of the branch that is taken. Evaluates without
/// allocating; may be used by several threads at once.
class FormulaSlopes {
 public:
  /// Throws InvalidInput as Expression does, and for a function whose derivative is not known.
  /// @param others  the names of those values
  FormulaSlopes(std::string text, const Parameters& parameters, std::vector<std::string> others)
      : formula_(std::move(text), parameters, std::move(others)) {}

  /// @param other   by which of the values, a number in the order of the constructor
  /// @param t       [s]
  /// @param values  of all of them, in that order
  double operator()(std::size_t other, double t, std::span<const double> values) const;

 private:
  TimeFormula formula_;
};

}  // namespace rubato::numerics
