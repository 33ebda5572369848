#pragma once

#include <rubato/results/sink.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>

namespace rubato::io {

/// `ANALYSIS.csv` and `ANALYSIS.TABLE.csv` in a folder: a header with units, numbers in the shortest form that reads
/// back to the same bits. Blocks that follow one another over the same labels are interleaved: all of the first label,
/// then all of the second. A value that is not there is an empty field. Throws OutputError.
///
/// A table begins under the name `FILE.partial`. It replaces a former one of its name when something has been written,
/// and `may_replace` agrees then, or when the sink is closed.
class CsvSink final : public results::Sink {
 public:
  /// @param may_replace  asked from the threads that write; empty: always
  explicit CsvSink(std::filesystem::path folder, std::function<bool()> may_replace = {});
  ~CsvSink() override;
  std::unique_ptr<results::RowWriter> open(const results::TableLayout& layout) override;
  void conclude(const std::string&, const std::string&, const std::string&,
                const std::vector<std::pair<std::string, std::string>>&) override {}
  /// Once all tables are closed: those that still wait for it take their names, or are removed.
  void close();
  /// The names of the files that have taken their names.
  std::set<std::string> written() const;

 private:
  struct Register;
  class Writer;
  std::filesystem::path folder_;
  std::shared_ptr<Register> register_;
};

}  // namespace rubato::io
