#pragma once

#include <filesystem>
#include <string>

namespace rubato::io {

/// What the writers leave free on a disk [bytes]: enough to close results.nc in good order and to write the report of
/// what was computed (2.3 MB with the scripts it embeds). A disk with less counts as full.
inline constexpr double disk_reserve = 8.0 * 1024 * 1024;

/// Creates the folder for results where there is none. Throws InvalidInput for one that cannot be made, naming the
/// folder and the remedy, and OutputError for a full disk. Whether it can be written into FolderLock tells.
void make_output_folder(const std::filesystem::path& folder);

/// Compares the free space with what is expected and the reserve. Throws OutputError where the disk has no room.
void require_disk_space(const std::filesystem::path& folder, double expected_bytes);

/// The name under which a file is begun that is to replace another of its name only once it can be written:
/// `FILE.partial`; its own name where that is no file (a link, a device).
std::filesystem::path partial_name(const std::filesystem::path& file);

/// `FILE: REASON; REMEDY` for a failed write, with the reason of the operating system, and the free space where it has
/// run out.
std::string write_failure(const std::filesystem::path& file, int error_number);

/// Whether the disk of `file` can take `growth` more bytes and keep the reserve.
bool has_disk_space(const std::filesystem::path& file, double growth);

/// Whether the process may make `file` larger by `growth` bytes (RLIMIT_FSIZE).
bool may_grow(const std::filesystem::path& file, double growth);

}  // namespace rubato::io
