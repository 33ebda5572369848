#pragma once

#include <rubato/results/sink.hpp>

#include <filesystem>

namespace rubato::io {

/// `ANALYSIS.csv` and `ANALYSIS.TABLE.csv` in a folder: a header with units, numbers in the shortest form that reads
/// back to the same bits. Blocks that follow one another over the same labels are interleaved: all of the first label,
/// then all of the second. A value that is not there is an empty field. Throws OutputError.
class CsvSink final : public results::Sink {
 public:
  explicit CsvSink(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::unique_ptr<results::RowWriter> open(const results::TableLayout& layout) override;
  void conclude(const std::string&, const std::string&, const std::string&,
                const std::vector<std::pair<std::string, std::string>>&) override {}

 private:
  std::filesystem::path folder_;
};

}  // namespace rubato::io
