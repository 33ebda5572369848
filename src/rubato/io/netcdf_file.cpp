#include <rubato/core/error.hpp>
#include <rubato/io/netcdf_file.hpp>
#include <rubato/io/output_folder.hpp>

#include <fmt/format.h>
#include <netcdf.h>

#include <cerrno>
#include <cstdio>

namespace rubato::io {
namespace {

// What HDF5 adds when it closes the file, beyond the data: its indices of chunks, headers and attributes. Measured with
// forty variables: 60 kB.
constexpr double closing_bytes = 256.0 * 1024;

}  // namespace

NetcdfFile::NetcdfFile(std::filesystem::path path) : path_(partial_name(path)), name_(std::move(path)) {
  errno = 0;
  if (const int status = nc_create(path_.c_str(), NC_NETCDF4 | NC_CLOBBER, &id_); status != NC_NOERR) {
    const int reason = errno;
    std::error_code ignored;
    if (path_ != name_) std::filesystem::remove(path_, ignored);
    errno = reason;
    check(status);
  }
  is_open_ = true;
  is_published_ = path_ == name_;
  known_ = KnownFile(path_);
}

NetcdfFile::~NetcdfFile() {
  if (is_open_) nc_close(id_);
  if (path_ == name_) return;
  try {
    if (has_worth_ && !has_failed_) publish();
  } catch (const OutputError&) {
    // A destructor cannot say so; whoever needs to know has closed it.
  }
  std::error_code ignored;
  if (path_ != name_) std::filesystem::remove(path_, ignored);
}

void NetcdfFile::check(int status) {
  if (status == NC_NOERR) return;
  has_failed_ = true;
  const int system_error = errno;
  // HDF5 hides the reason; the operating system's, where there is one, says more.
  std::string message = write_failure(name_, system_error);
  if (system_error == 0) message += fmt::format(" ({})", nc_strerror(status));
  throw OutputError(message);
}

int NetcdfFile::group(int parent, const std::string& name) {
  int id = 0;
  if (nc_inq_grp_ncid(parent, name.c_str(), &id) != NC_NOERR) check(nc_def_grp(parent, name.c_str(), &id));
  return id;
}

void NetcdfFile::attribute(int group, int variable, const std::string& name, const std::string& text) {
  errno = 0;
  check(nc_put_att_text(group, variable, name.c_str(), text.size(), text.data()));
}

void NetcdfFile::make_room(double bytes) {
  const auto fits = [&] {
    return has_disk_space(path_, pending_ + bytes) && may_grow(path_, pending_ + bytes + closing_bytes);
  };
  if (!fits() && pending_ > 0.0) sync();  // some of what is pending may be in the file already and counted twice
  if (!has_disk_space(path_, pending_ + bytes)) throw OutputError(write_failure(name_, ENOSPC));
  if (!may_grow(path_, pending_ + bytes + closing_bytes)) throw OutputError(write_failure(name_, EFBIG));
  pending_ += bytes;
}

void NetcdfFile::sync() {
  errno = 0;
  check(nc_sync(id_));
  pending_ = 0.0;
}

void NetcdfFile::publish() {
  if (path_ == name_ || (!has_worth_ && std::filesystem::exists(name_))) return;
  if (std::rename(path_.c_str(), name_.c_str()) != 0) throw OutputError(write_failure(name_, errno));
  path_ = name_;
  is_published_ = true;
  known_ = KnownFile(path_);
}

bool NetcdfFile::is_there() {
  const std::lock_guard lock(mutex_);
  return known_.is_there();
}

void NetcdfFile::close() {
  if (!is_open_) return;
  is_open_ = false;
  errno = 0;
  check(nc_close(id_));
  publish();
}

}  // namespace rubato::io
