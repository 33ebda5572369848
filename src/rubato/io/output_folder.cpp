#include <rubato/core/error.hpp>
#include <rubato/io/output_folder.hpp>
#include <rubato/io/provenance.hpp>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <sys/resource.h>

#include <cerrno>
#include <cstring>
#include <ctime>

namespace rubato::io {

std::string utc_now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

std::filesystem::path partial_name(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  std::error_code fault;
  const fs::file_status status = fs::symlink_status(file, fault);
  if (fs::exists(status) && !fs::is_regular_file(status)) return file;
  return file.string() + ".partial";
}

std::string write_failure(const std::filesystem::path& file, int error_number) {
  std::error_code fault;
  const auto space = std::filesystem::space(file.has_parent_path() ? file.parent_path() : ".", fault);
  if (error_number == ENOSPC || (!fault && space.available < (1u << 16)))
    return fmt::format("{}: the disk is full; free some space or write elsewhere (-o DIR)", file.string());
  const std::string reason = error_number != 0 ? std::strerror(error_number) : "the write failed";
  return fmt::format("{}: {}; write elsewhere (-o DIR)", file.string(), reason);
}

namespace {

std::string size_text(double bytes) {
  if (bytes < 1e9) return fmt::format("{:.3g} MB", bytes / 1e6);
  return bytes < 1e12 ? fmt::format("{:.3g} GB", bytes / 1e9) : fmt::format("{:.3g} TB", bytes / 1e12);
}

}  // namespace

void make_output_folder(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code fault;
  if (fs::exists(folder, fault) && !fs::is_directory(folder, fault))
    throw InvalidInput(fmt::format("{}: exists and is no folder; choose another (-o DIR)", folder.string()));
  fs::create_directories(folder, fault);
  if (fault.value() == ENOSPC) throw OutputError(write_failure(folder, ENOSPC));
  if (fault)
    throw InvalidInput(
        fmt::format("{}: the folder cannot be made: {}; choose another (-o DIR)", folder.string(), fault.message()));
}

void require_disk_space(const std::filesystem::path& folder, double expected_bytes) {
  std::error_code fault;
  const auto space = std::filesystem::space(folder, fault);
  if (!fault && expected_bytes + disk_reserve > static_cast<double>(space.available))
    throw OutputError(fmt::format(
        "{}: the results may take {} and {} are free; observe less (observe = [...]), of a transient write fewer rows "
        "(output = {{ interval = ... }}), or write elsewhere (-o DIR)",
        folder.string(), size_text(expected_bytes + disk_reserve), size_text(static_cast<double>(space.available))));
}

bool has_disk_space(const std::filesystem::path& file, double growth) {
  std::error_code fault;
  const auto space = std::filesystem::space(file.has_parent_path() ? file.parent_path() : ".", fault);
  return fault || static_cast<double>(space.available) >= growth + disk_reserve;
}

bool may_grow(const std::filesystem::path& file, double growth) {
  rlimit limit{};
  if (getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return true;
  std::error_code fault;
  const auto size = std::filesystem::file_size(file, fault);
  return fault || static_cast<double>(size) + growth <= static_cast<double>(limit.rlim_cur);
}

}  // namespace rubato::io
