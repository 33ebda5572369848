#pragma once

#include <rubato/analysis/extremes.hpp>
#include <rubato/results/sink.hpp>

#include <map>
#include <string>
#include <vector>

namespace rubato::analysis {

/// What a sample of a sweep keeps of a table that its analysis writes.
enum class Kept { nothing, rows, last_row, extremes, extremes_and_rows };

/// What was kept of a table.
struct KeptTable {
  Kept kept = Kept::nothing;
  results::TableLayout layout;
  std::vector<double> rows;  ///< one after another; of `last_row` that one
  Extremes extremes;
};

/// Takes what the analysis of one sample writes, and keeps in memory what the sweep needs of it.
class SampleSink final : public results::Sink {
 public:
  /// @param kept  by name of the table, "" for the main one; others are not kept
  explicit SampleSink(std::map<std::string, Kept> kept) : kept_(std::move(kept)) {}

  std::unique_ptr<results::RowWriter> open(const results::TableLayout& layout) override;
  void conclude(const std::string&, const std::string&, const std::string&,
                const std::vector<std::pair<std::string, std::string>>&) override {}

  /// Null: the analysis has not opened it.
  const KeptTable* find(const std::string& table) const;

 private:
  std::map<std::string, Kept> kept_;
  std::map<std::string, KeptTable> tables_;
};

}  // namespace rubato::analysis
