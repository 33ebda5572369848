#include "commands.hpp"

#include <rubato/io/compare_results.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::app {
namespace {

using io::ColumnDifference, io::TableComparison;

constexpr std::size_t most_columns = 20;  // of a table, unless all are asked for

bool is_within(const ColumnDifference& column, double tolerance) { return column.relative <= tolerance; }

std::string line_of(const TableComparison& table, const ColumnDifference& column, std::size_t width, double tolerance) {
  const char* const mark = is_within(column, tolerance) ? " " : "*";
  if (!column.told.empty()) return fmt::format("{} {:<{}}  {}", mark, column.column, width, column.told);
  std::string line =
      fmt::format("{} {:<{}}  {:>9.2e}  {:>9.2e}", mark, column.column, width, column.relative, column.largest);
  if (column.largest > 0.0)
    line += table.is_history ? fmt::format("  t = {:.6g} s", column.at) : fmt::format("  row {:.0f}", column.at);
  if (column.interpolation > 0.0) line += fmt::format("  (interpolation: about {:.0e})", column.interpolation);
  return line;
}

/// Returns whether it is within the tolerance, or does not count.
bool print_table(const TableComparison& table, const CompareOptions& options) {
  const double tolerance = table.not_counted.empty() ? options.tolerance : std::numeric_limits<double>::infinity();
  auto columns = table.columns;
  std::stable_sort(columns.begin(), columns.end(),
                   [](const auto& a, const auto& b) { return a.relative > b.relative; });
  const bool is_equal = columns.empty() || columns.front().relative == 0.0;
  if (is_equal && table.gaps.empty() && table.notes.empty() && !options.all) {
    fmt::print("{}: equal\n", table.table);
    return true;
  }
  fmt::print("{}{}\n", table.table,
             table.not_counted.empty() ? "" : fmt::format(" ({}; it does not count)", table.not_counted));
  for (const std::string& gap : table.gaps) fmt::print("{} {}\n", table.not_counted.empty() ? "*" : " ", gap);
  for (const std::string& note : table.notes) fmt::print("  {}\n", note);
  if (columns.empty()) return table.gaps.empty() || !table.not_counted.empty();
  std::size_t width = 6, told = 0;
  for (const ColumnDifference& column : columns) width = std::max(width, column.column.size());
  fmt::print("  {:<{}}  {:>9}  {:>9}  at\n", "column", width, "relative", "largest");
  for (const ColumnDifference& column : columns) {
    if (!options.all && (column.relative == 0.0 || told == most_columns)) break;
    fmt::print("{}\n", line_of(table, column, width, tolerance));
    ++told;
  }
  if (told < columns.size()) {
    const ColumnDifference& next = columns[told];
    fmt::print("  {} more column{}, {}\n", columns.size() - told, columns.size() - told == 1 ? "" : "s",
               next.relative == 0.0 ? "equal" : fmt::format("at most {:.2e}; --all tells them", next.relative));
  }
  return !table.not_counted.empty() || (table.gaps.empty() && is_within(columns.front(), tolerance));
}

}  // namespace

int compare(const CompareOptions& options) {
  const auto tables = io::compare_results(options.first, options.second);
  std::size_t beyond = 0;
  bool steps_differ = false;
  const TableComparison* worst_table = nullptr;
  const ColumnDifference* worst = nullptr;
  for (const TableComparison& table : tables) {
    if (!print_table(table, options)) ++beyond;
    if (!table.not_counted.empty()) {
      steps_differ = steps_differ || !table.gaps.empty() ||
                     std::any_of(table.columns.begin(), table.columns.end(),
                                 [](const ColumnDifference& column) { return column.relative > 0.0; });
      continue;
    }
    for (const ColumnDifference& column : table.columns)
      if (column.relative > (worst ? worst->relative : 0.0)) {
        worst = &column;
        worst_table = &table;
      }
  }
  const std::string most = !worst ? (steps_differ ? "no column that counts differs" : "no column differs")
                           : !worst->told.empty()
                               ? fmt::format("entries differ in \"{}\" of {}", worst->column, worst_table->table)
                               : fmt::format("the largest difference is {:.2e}, \"{}\" of {}", worst->relative,
                                             worst->column, worst_table->table);
  if (beyond == 0)
    fmt::print("\nwithin {:g}: {} table{}; {}\n", options.tolerance, tables.size(), tables.size() == 1 ? "" : "s",
               most);
  else
    fmt::print("\nbeyond {:g}: {} of {} table{} (*); {}\n", options.tolerance, beyond, tables.size(),
               tables.size() == 1 ? "" : "s", most);
  return beyond == 0 ? exit_done : exit_differs;
}

}  // namespace rubato::app
