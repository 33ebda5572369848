#include <rubato/io/known_file.hpp>

#include <sys/stat.h>

#include <cerrno>
#include <utility>

namespace rubato::io {

KnownFile::KnownFile(std::filesystem::path path) : path_(std::move(path)) {
  struct stat status {};
  if (::stat(path_.c_str(), &status) != 0) return;
  device_ = status.st_dev;
  number_ = status.st_ino;
}

bool KnownFile::is_there() const {
  if (number_ == 0) return true;
  struct stat status {};
  if (::stat(path_.c_str(), &status) == 0) return status.st_dev == device_ && status.st_ino == number_;
  return errno != ENOENT && errno != ENOTDIR;  // a file system may be out of reach for a while
}

}  // namespace rubato::io
