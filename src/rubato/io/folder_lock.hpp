#pragma once

#include <rubato/io/known_file.hpp>

#include <filesystem>
#include <string>

namespace rubato::io {

/// Holds a folder of results for this process: a lock on the file `.rubato-lock` in it. The operating system lets go of
/// the lock when the process ends, however it ends; a file that is left there locks nobody out.
class FolderLock {
 public:
  /// Throws OutputError where another process holds the folder, with its number where it is known, or where the disk is
  /// full, and InvalidInput for a folder in which nothing can be written. Where the file system keeps no locks nothing
  /// is thrown, and warning() says so.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Why other processes are not kept out; empty where they are.
  const std::string& warning() const { return warning_; }
  /// What has become of the folder since: "was deleted or moved", "was emptied"; empty where it is as it was.
  std::string loss() const;

 private:
  void note_owner();

  std::filesystem::path path_;
  std::string warning_;
  int file_ = -1;
  KnownFile folder_known_, file_known_;
};

/// Who writes into a folder of results now, for a message: "another run is writing here (process 1234)"; empty where
/// nobody does, as far as locks tell.
std::string writer_of(const std::filesystem::path& folder);

}  // namespace rubato::io
