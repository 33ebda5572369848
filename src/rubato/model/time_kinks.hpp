#pragma once

#include <rubato/model/time_law.hpp>

#include <vector>

namespace rubato::model {

/// The times in (from, to) at which a law may jump or have a kink, rising.
struct Kinks {
  std::vector<double> rows;      ///< of tables: to the last bit
  std::vector<double> switches;  ///< of formulas: to round-off; the eighths of what lies between two of them as well
};
Kinks kinks(const TimeLaw& law, double from, double to);

/// The switches of a formula and the eighths of each piece between two of them: what is zero at both ends of a piece
/// may be something between them, and a step has to see it.
std::vector<double> with_eighths(const std::vector<double>& switches);

}  // namespace rubato::model
