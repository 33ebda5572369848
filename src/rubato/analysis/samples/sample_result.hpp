#pragma once

#include <rubato/analysis/samples/key_numbers.hpp>

#include <span>
#include <string>
#include <vector>

namespace rubato::analysis {

enum class SampleStatus { done, failed, impossible };

/// The words of the column `status`: failed where the mathematics did, impossible where no such model can be.
inline const std::vector<std::string> sample_statuses{"done", "failed", "impossible"};

/// What became of one sample of a sweep.
struct SampleResult {
  long number = 0;  ///< from 0
  bool is_whole = true;
  SampleStatus status = SampleStatus::done;
  std::string reason;                 ///< of one that is not done
  std::vector<std::string> warnings;  ///< the first few texts
  double warning_count = 0.0;
  /// Of one that is done: its key numbers, and the rows of its main table where they are kept. As soon as they are
  /// written, and in the journal, their order is that of the tables of the sweep.
  KeyNumbers numbers;
  std::vector<results::Block> row_blocks;
  std::vector<double> rows;

  /// As one list of numbers, and back, for the journal. Throws InvalidInput for the list of another sample.
  std::vector<double> packed() const;
  static SampleResult unpacked(long number, std::span<const double> values);
};

}  // namespace rubato::analysis
