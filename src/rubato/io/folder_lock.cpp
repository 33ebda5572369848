#include <rubato/core/error.hpp>
#include <rubato/io/folder_lock.hpp>
#include <rubato/io/output_folder.hpp>

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace rubato::io {
namespace {

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

/// "process 1234", "process 1234 on castor"; empty where the owner has not said so.
std::string owner_in(int file) {
  std::array<char, 300> text{};
  if (::pread(file, text.data(), text.size() - 1, 0) <= 0) return {};
  std::string owner(text.data());
  owner = owner.substr(0, owner.find('\n'));
  const std::size_t blank = owner.find(' ');
  if (blank == std::string::npos || owner.find_first_not_of("0123456789") != blank) return {};
  const std::string number = owner.substr(0, blank), host = owner.substr(blank + 1);
  return "process " + number + (host.empty() || host == host_name() ? "" : " on " + host);
}

std::string writing(const std::string& owner) {
  return "another run is writing here" + (owner.empty() ? "" : " (" + owner + ")");
}

/// 0, or the number of the error.
/// @param kind  LOCK_EX, or LOCK_SH to see whether there is one
int try_lock(int file, int kind) {
  while (::flock(file, kind | LOCK_NB) != 0)
    if (errno != EINTR) return errno;
  return 0;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : path_(folder / ".rubato-lock") {
  // Who lets go of the lock removes the file: a lock on a file that has lost its name is none.
  for (int tries = 0; tries < 100; ++tries) {
    errno = 0;
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0 && (errno == ENOSPC || errno == EDQUOT)) throw OutputError(write_failure(path_, errno));
    if (file_ < 0)
      throw InvalidInput(fmt::format("{}: nothing can be written there: {}; choose another (-o DIR)", folder.string(),
                                     std::strerror(errno)));
    const int fault = try_lock(file_, LOCK_EX);
    if (fault == EWOULDBLOCK) {
      const std::string owner = owner_in(file_);
      ::close(file_);
      throw OutputError(
          fmt::format("{}: {}; wait for its end, or choose another folder (-o DIR)", folder.string(), writing(owner)));
    }
    if (fault != 0)
      warning_ = fmt::format("{}: this file system keeps no locks ({}): see that no other run writes there",
                             folder.string(), std::strerror(fault));
    struct stat held {};
    struct stat named {};
    if (::fstat(file_, &held) == 0 && ::stat(path_.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
        held.st_dev == named.st_dev)
      break;
    ::close(file_);
    file_ = -1;
  }
  if (file_ < 0) throw OutputError(fmt::format("{}: the folder cannot be locked; try again", folder.string()));
  folder_known_ = KnownFile(folder);
  file_known_ = KnownFile(path_);
  try {
    note_owner();
  } catch (...) {
    ::unlink(path_.c_str());
    ::close(file_);
    throw;
  }
}

FolderLock::~FolderLock() {
  if (file_known_.is_there()) ::unlink(path_.c_str());
  ::close(file_);
}

// For the message of whoever comes next.
void FolderLock::note_owner() {
  const std::string owner = fmt::format("{} {}\n", ::getpid(), host_name());
  errno = 0;
  if (::ftruncate(file_, 0) != 0 ||
      ::pwrite(file_, owner.data(), owner.size(), 0) != static_cast<ssize_t>(owner.size()))
    throw OutputError(write_failure(path_, errno));
}

std::string FolderLock::loss() const {
  if (!folder_known_.is_there()) return "was deleted or moved";
  return file_known_.is_there() ? "" : "was emptied";
}

std::string writer_of(const std::filesystem::path& folder) {
  const int file = ::open((folder / ".rubato-lock").c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return {};
  std::string writer = try_lock(file, LOCK_SH) == EWOULDBLOCK ? writing(owner_in(file)) : "";
  ::close(file);
  return writer;
}

}  // namespace rubato::io
