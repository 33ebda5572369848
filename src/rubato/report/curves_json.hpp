#pragma once

#include <rubato/report/curves.hpp>

#include <string>

namespace rubato::report {

/// How much of a table of curves goes into a report.
struct CurveExtent {
  std::size_t labels = 8;            ///< the first so many along a dimension
  std::size_t exact_up_to = 100;     ///< numbers of tables of at most so many rows have twelve digits
  std::size_t whole_up_to = 12'000;  ///< tables of at most so many rows are shown whole
  std::size_t numbers = 400'000;     ///< longer ones: about so many numbers,
  std::size_t curves = 200;          ///< of so many curves, evenly spread,
  std::size_t least_buckets = 16;    ///< each by the extremes of no fewer buckets
  std::size_t flagged = 400;         ///< rows that did not converge: the first so many
  std::size_t peaks = 4000;          ///< curves whose largest amplitude is told, evenly spread
};

/// The table as a JSON object like that of table_json.hpp; `overview` holds the curves one after another, and besides
///
///   "curves": {"abscissa": variable, "keys": [variable, ...], "count": int, "starts": [first point of each curve
///   shown,
///              ..., points], "ordinals": [which curve of the table]},
///   "maxima": [[largest of each label], ...],
///   "statuses": null or {"variable", "counts": [rows of each category], "columns": [[column, ...], ...]},
///   "peaks": null or {"variable", "keys": [[of each curve], ...], "abscissa": [[label], ...], "value": [[label], ...]}
///
/// where the columns of `statuses` are the rows whose `status` is not its first category (converged), and the peaks are
/// the largest `amplitude` of each label over each curve with the abscissa where it stands. Curves too long to be shown
/// whole are given by their Envelope. Each variable is read once through, in pieces.
std::string curves_json(const TableSource& table, const CurveLayout& layout, const CurveExtent& extent = {});

}  // namespace rubato::report
