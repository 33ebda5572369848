#pragma once

#include <rubato/results/sink.hpp>

#include <span>
#include <string>
#include <vector>

namespace rubato::analysis {

/// The least and the largest value of each column with the first times of both, and the last value; NaN where a column
/// has no number. The first column is the time.
struct Extremes {
  std::vector<double> least, time_of_least, largest, time_of_largest, last;

  void take(std::span<const double> row);
};

/// Writes the table `extremes` of an analysis: a row a column of numbers, as LABEL.VARIABLE, with its unit, its least
/// and its largest value and their times.
/// @param of  the layout of the rows that were taken
void write_extremes(const results::TableLayout& of, const Extremes& extremes, results::Sink& sink);

}  // namespace rubato::analysis
