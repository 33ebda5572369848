#pragma once

#include <rubato/analysis/samples/campbell.hpp>
#include <rubato/analysis/samples/sample_result.hpp>
#include <rubato/analysis/samples/samples_plan.hpp>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Columns that stay, and numbers of other columns on their way into them.
class LaidColumns {
 public:
  LaidColumns() = default;
  explicit LaidColumns(std::vector<results::Block> blocks);

  const std::vector<results::Block>& blocks() const { return blocks_; }
  std::size_t width() const { return width_; }
  /// Rows of other columns in the order of these: NaN where they lack one.
  /// @param left_out  is set to the name of a column that has no place here
  std::vector<double> laid(const std::vector<results::Block>& from, const std::vector<double>& rows,
                           std::string& left_out) const;

 private:
  std::vector<results::Block> blocks_;
  std::map<std::string, std::size_t> places_;  ///< by label and variable
  std::size_t width_ = 0;
};

/// Writes samples in their order: the main table, a row a sample, `histories` or `modes` with all rows of each where
/// they are kept, and at the end `failures`, `statistics` of random samples and `crossings` of engine orders. The
/// columns of the first sample that is done are those of all.
class SampleTables {
 public:
  /// All must outlive this.
  SampleTables(const std::string& name, const SamplesPlan& plan, results::Sink& sink);

  /// Whether the columns are known.
  bool is_laid() const { return has_columns_; }
  /// Takes the columns of a sample that is done. Throws InvalidInput where a swept parameter has the name of one.
  void lay(const SampleResult& sample);
  /// Writes a sample, and sets its numbers in the order of the columns. Columns are those of this sample where none are
  /// known. After a sample that was interrupted nothing is written: there would be a gap.
  void write(SampleResult& sample);
  /// Writes what is known at the end only.
  void finish();

  long written() const { return written_; }
  double count_of(SampleStatus status) const { return counts_[static_cast<std::size_t>(status)]; }
  /// What went wrong with samples, and what was warned of, in a few lines.
  std::vector<std::string> warnings() const;
  std::vector<std::string> findings() const;
  /// Of the first sample that is not done: "at k = -1: ..."
  std::string first_reason() const;

 private:
  struct Failure {
    long number;
    SampleStatus status;
    std::string reason;
  };
  struct Told {
    long first = 0;
    double count = 0.0;
  };

  void order(SampleResult& sample);
  void note(const SampleResult& sample);
  void open_main();
  void write_row(const SampleResult& sample);
  void write_failures();
  void write_statistics();

  const std::string& name_;
  const SamplesPlan& plan_;
  results::Sink& sink_;
  bool has_columns_ = false, has_gap_ = false;
  LaidColumns columns_, row_columns_;
  std::vector<SampleResult> pending_;  ///< came before the columns were known
  std::unique_ptr<results::RowWriter> main_, rows_;
  std::optional<Campbell> campbell_;
  std::vector<std::string> modes_;
  std::vector<std::vector<double>> samples_;  ///< key numbers of random samples, by column
  std::vector<Failure> failures_;
  std::vector<std::string> texts_;  ///< of warnings, in the order in which they came
  std::map<std::string, Told> told_;
  double untold_ = 0.0;  ///< warnings beyond those
  std::string left_out_;
  long left_out_of_ = 0;
  long written_ = 0;
  std::array<double, 3> counts_{};
};

}  // namespace rubato::analysis
