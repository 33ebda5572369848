#pragma once

#include <rubato/report/table_source.hpp>

#include <string>

namespace rubato::report {

/// How much of a table goes into a report.
struct Extent {
  std::size_t labels = 32;         ///< at most so many along a dimension: see shown_labels
  std::size_t whole_up_to = 6000;  ///< tables of at most so many rows are shown whole
  std::size_t buckets = 2000;      ///< longer ones: extremes in so many buckets,
  std::size_t window_rows = 4000;  ///< and the last so many rows as they are
};

/// The table as a JSON object:
///
///   {"name", "row_dimension", "rows", "attributes": {...},
///    "variables": [{"name", "unit", "description", "dimension", "labels", "label_count", "categories"}, ...],
///    "overview": [[column, ...], ...], "is_envelope": bool,
///    "window": null or [[column, ...], ...], "window_first_row": int,
///    "key_numbers": null or [null or [[largest, rms, late_amplitude, time_of_largest, last], ...], ...],
///    "reactions": null or as reactions_json tells}
///
/// `overview` and `window` hold, for each variable, one column for each label shown. Where `is_envelope`, the columns
/// are Envelope::points() and that of the first variable holds the row coordinates they stand at. Key numbers are
/// formed for the labelled variables of tables whose row dimension is `time`, from all rows. The table is read once
/// through, in pieces, and its window once more.
std::string table_json(const TableSource& table, const Extent& extent = {});

/// {"name": "value", ...}; a longer value is cut after so many bytes and ends in "...".
std::string attributes_json(const Attributes& attributes, std::size_t longest = 4096);

}  // namespace rubato::report
