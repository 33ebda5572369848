#pragma once

#include <rubato/io/provenance.hpp>
#include <rubato/results/sink.hpp>

#include <filesystem>
#include <memory>

namespace rubato::io {

class NetcdfFile;

/// One netCDF-4 file: a group an analysis, a subgroup a named table. Rows are along an unlimited dimension with its
/// coordinate variable; the names along `coordinate` and `slider` are string variables of the same name, so that xarray
/// labels them. Words are numbers with flag_values and flag_meanings (blanks in a word become underscores).
///
/// Rows are buffered to about a megabyte and reach the disk at least once a second, so that memory does not grow and
/// what was computed stays readable after an interrupt. Tables may be written by several threads, one each.
///
/// Throws OutputError. Rows that would not fit on the disk, or into the size that a file may have, are refused before
/// they are written, so that the file stays readable and can be concluded and closed.
///
/// A former file of the same name is replaced when the first rows have been written, or an analysis is done: a run that
/// cannot write, or is stopped before it has anything to write, leaves it.
class NetcdfSink final : public results::Sink {
 public:
  NetcdfSink(const std::filesystem::path& path, const Provenance& provenance);
  ~NetcdfSink() override;
  /// Makes the group of an analysis, so that groups have the order of these calls; its status is "unfinished" until it
  /// is concluded, as a killed process leaves it.
  void expect(const std::string& analysis);
  std::unique_ptr<results::RowWriter> open(const results::TableLayout& layout) override;
  void conclude(const std::string& analysis, const std::string& status, const std::string& message,
                const std::vector<std::pair<std::string, std::string>>& attributes) override;
  /// Closes the file; throws OutputError where what is buffered cannot be written.
  void close();
  /// Whether it has taken the place of a former file, or there was none.
  bool is_published() const;
  /// Whether the file's name still leads to it: not where somebody has removed it.
  bool is_there() const;
  /// Whether a write has failed in spite of that: the file may be unreadable, and HDF5 crashes as the process ends
  /// unless it ends by std::_Exit.
  bool has_failed() const;

 private:
  std::shared_ptr<NetcdfFile> file_;
};

}  // namespace rubato::io
