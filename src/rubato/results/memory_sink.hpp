#pragma once

#include <rubato/results/sink.hpp>

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rubato::results {

/// A table kept in memory. The values of a block lie together, so that others can look at them without a copy.
struct MemoryTable {
  TableLayout layout;
  std::vector<std::vector<double>> values;  ///< of each block [rows x width], row by row
  std::size_t rows = 0;
};

/// What an analysis wrote.
struct MemoryAnalysis {
  std::string name;
  std::string status = "unfinished";  ///< "done", "failed", "interrupted" once it is concluded
  std::string message;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< statistics, warnings, findings
  std::vector<std::shared_ptr<MemoryTable>> tables;             ///< in the order in which they were opened
};

/// Keeps results in memory. Tables may be written by several threads, one each; they are to be read when all writers
/// are closed.
class MemorySink final : public Sink {
 public:
  /// @param analyses  their names, in the order in which they are kept
  explicit MemorySink(const std::vector<std::string>& analyses);

  std::unique_ptr<RowWriter> open(const TableLayout& layout) override;
  /// What is empty leaves what an earlier conclusion said.
  void conclude(const std::string& analysis, const std::string& status, const std::string& message,
                const std::vector<std::pair<std::string, std::string>>& attributes) override;

  const std::vector<MemoryAnalysis>& analyses() const { return analyses_; }

 private:
  MemoryAnalysis& analysis(const std::string& name);

  std::mutex mutex_;
  std::vector<MemoryAnalysis> analyses_;
};

/// Hands results to another sink, as the analyses did. Throws what that throws.
void write(std::span<const MemoryAnalysis> analyses, Sink& sink);

}  // namespace rubato::results
