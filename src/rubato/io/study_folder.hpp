#pragma once

#include <rubato/core/error.hpp>
#include <rubato/io/source_files.hpp>

#include <filesystem>
#include <string>

namespace rubato::io {

/// The folder of a study: whatever other file the study names is read through it, and noted. Private to io.
class StudyFolder {
 public:
  /// @param files  where what is read is noted; may be null
  explicit StudyFolder(std::filesystem::path path, SourceFiles* files = nullptr)
      : path_(std::move(path)), files_(files) {}

  /// The text of a file. Throws InvalidInput at `where` if it cannot be read or is larger than `limit` [bytes]; `what`
  /// says what it is ("the table").
  std::string read(const std::string& file, const Location& where, std::uintmax_t limit, const std::string& what) const;
  /// Where a file lies, seen from where the study was named: for messages.
  std::string place_of(const std::string& file) const;

 private:
  std::filesystem::path path_;
  SourceFiles* files_;
};

}  // namespace rubato::io
