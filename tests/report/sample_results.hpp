#pragma once

#include <rubato/results/sink.hpp>

#include <filesystem>
#include <string>
#include <vector>

// A results file as a run leaves it, made without the analyses.
namespace rubato::test {

/// A netCDF-4 file of tables.
class ResultsFileWriter {
 public:
  explicit ResultsFileWriter(const std::filesystem::path& file);
  ~ResultsFileWriter();
  ResultsFileWriter(const ResultsFileWriter&) = delete;
  ResultsFileWriter& operator=(const ResultsFileWriter&) = delete;

  void set_attribute(const std::string& name, const std::string& value);
  /// @param rows  [rows][row_width]
  void add(const results::TableLayout& layout, const std::vector<std::vector<double>>& rows);

 private:
  int file_ = -1;
};

/// A study of five analyses: the under-platform damper (12,001 rows), one mass with a slider (whole), a method study,
/// an analysis that failed, and one of a kind that the report does not know, with hostile names.
void write_sample_results(const std::filesystem::path& file);

}  // namespace rubato::test
