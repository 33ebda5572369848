#pragma once

#include <rubato/io/known_file.hpp>

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <mutex>
#include <string>

namespace rubato::io {

/// A netCDF-4 file open for writing. It is made under the name `FILE.partial`, and replaces a former file of its own
/// name only once it is worth it: with rows that have reached the disk, or what is as good. (A name that leads to
/// another place, as a link does, is written at once.)
///
/// HDF5 survives no failed write: what it holds in memory cannot be brought to the file any more, which then cannot be
/// read at all. So data that would not fit is refused before HDF5 sees it, and the file stays whole. Should a write
/// fail all the same, the file takes no more, and the process should end without HDF5's last attempt (std::_Exit).
class NetcdfFile {
 public:
  /// Throws OutputError.
  explicit NetcdfFile(std::filesystem::path path);
  ~NetcdfFile();
  NetcdfFile(const NetcdfFile&) = delete;
  NetcdfFile& operator=(const NetcdfFile&) = delete;

  int id() const { return id_; }
  bool has_failed() const { return has_failed_; }
  /// To be held through a sequence of calls: neither netCDF nor HDF5 may be entered by two threads.
  std::mutex& mutex() { return mutex_; }

  /// Throws OutputError, with the operating system's reason where there is one, unless `status` is NC_NOERR.
  void check(int status);
  /// The group of a name below `parent`, made where there is none.
  int group(int parent, const std::string& name);
  void attribute(int group, int variable, const std::string& name, const std::string& text);
  /// Announces `bytes` of data that follow; throws OutputError where they do not fit, and the file stays whole.
  void make_room(double bytes);
  /// Makes everything written so far readable on disk.
  void sync();
  /// From now on the file holds enough to replace a former file.
  void note_worth() { has_worth_ = true; }
  /// Takes its name, after a sync, unless there is a former file and too little to replace it.
  void publish();
  /// May be asked by any thread.
  bool is_published() const { return is_published_; }
  /// Whether its name still leads to this file.
  bool is_there();
  void close();

 private:
  std::filesystem::path path_, name_;  ///< where it is; where it goes
  KnownFile known_;
  std::mutex mutex_;
  int id_ = 0;
  double pending_ = 0.0;  ///< bytes announced since the last sync: they may not be in the file yet
  std::atomic<bool> is_published_{false};
  bool is_open_ = false, has_failed_ = false, has_worth_ = false;
};

}  // namespace rubato::io
