#pragma once

#include <rubato/io/result_table.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace rubato::io {

/// How far a column of one table is from that of another.
struct ColumnDifference {
  std::string column;
  double largest = 0.0;   ///< max |a - b|, in the unit of the column
  double relative = 0.0;  ///< over the largest value of the column in either table; infinite: words differ [-]
  double at = 0.0;        ///< the row of it, counted from 1, or of histories its time [s]; of words always the row
  std::string told = {};  ///< of words, and of numbers that one of them lacks: how many, and the first
  /// Of interpolated rows: about what interpolation by straight lines adds to `relative` [-].
  double interpolation = 0.0;
};

struct TableComparison {
  std::string table;  ///< "response.csv"
  std::vector<ColumnDifference> columns;
  std::vector<std::string> gaps;   ///< what one of them lacks: the table, columns, rows
  std::vector<std::string> notes;  ///< how rows were matched, where that is not one by one
  bool is_history = false;         ///< `at` is a time
  std::string not_counted;         ///< why differences are no failure, of `ANALYSIS.steps.csv`; empty: they count
};

/// Compares what both tables have.
///
/// Rows are matched one by one where both have as many. Histories (a first column `time [s]` that rises, and numbers
/// only) of different times are compared at the times of the shorter table, the other one interpolated by straight
/// lines. Of other tables with unequal numbers of rows those are compared that agree in what was asked for: the first
/// column, or all up to `angular_frequency [rad/s]`, of modes up to `mode`, of damper curves up to the parameter.
///
/// A difference is relative to the largest value of the column in either table, or to 1e-13 of the largest of its
/// quantity in the table (`position [m]` of all), below which a column is round-off; that of the `residue [J]` of an
/// energy ledger to the largest energy there. Phases differ by less than pi.
TableComparison compare_tables(const std::string& name, const ResultTable& a, const ResultTable& b);

/// All tables of two folders of results. Throws InvalidInput for folders without tables.
std::vector<TableComparison> compare_results(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace rubato::io
