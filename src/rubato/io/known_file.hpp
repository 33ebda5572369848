#pragma once

#include <filesystem>

namespace rubato::io {

/// A file as it was met, to be known again under its name.
class KnownFile {
 public:
  KnownFile() = default;
  /// Of what has this name now.
  explicit KnownFile(std::filesystem::path path);
  /// Whether its name still leads to it. A file that was never there is not missed.
  bool is_there() const;

 private:
  std::filesystem::path path_;
  unsigned long long device_ = 0, number_ = 0;  ///< its inode; 0: there was none
};

}  // namespace rubato::io
