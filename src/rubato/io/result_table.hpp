#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rubato::io {

/// A column of a table of results: numbers, or words where any of its fields is none.
struct ResultColumn {
  std::string name;             ///< "mass.position [m]"
  std::vector<double> numbers;  ///< NaN where the field is empty [rows]; empty where these are words
  std::vector<std::string> words;

  bool is_text() const { return !words.empty(); }
};

/// A table as CsvSink writes it.
struct ResultTable {
  std::vector<ResultColumn> columns;
  std::size_t rows = 0;

  const ResultColumn* find(const std::string& name) const;  ///< nullptr: not there
};

/// Throws InvalidInput for a file that cannot be read, or whose rows are not as long as its header.
ResultTable read_result_table(const std::filesystem::path& file);

/// The tables in a folder and those below it, as paths relative to it, in order; without what a run moved to `former/`,
/// with what a run that was killed left of others (`response.csv.partial`).
/// Throws InvalidInput for what is no folder, has no tables, or is being written by a run.
std::vector<std::filesystem::path> result_tables(const std::filesystem::path& folder);

}  // namespace rubato::io
