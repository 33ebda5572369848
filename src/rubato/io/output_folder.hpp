#pragma once

#include <filesystem>
#include <string>

namespace rubato::io {

/// What the writers leave free on a disk [bytes]: enough to close results.nc in good order and to write the report of
/// what was computed (2.3 MB with the scripts it embeds). A disk with less counts as full.
inline constexpr double disk_reserve = 8.0 * 1024 * 1024;

/// Makes the folder for results ready: creates it, writes and removes a probe, and compares the free space with what is
/// expected and the reserve. Throws, before anything is computed, InvalidInput for a folder that cannot be made or
/// written into, and OutputError where the disk has no room, naming the folder and the remedy.
void prepare_output_folder(const std::filesystem::path& folder, double expected_bytes);

/// `FILE: REASON; REMEDY` for a failed write, with the reason of the operating system, and the free space where it has
/// run out.
std::string write_failure(const std::filesystem::path& file, int error_number);

/// Whether the disk of `file` can take `growth` more bytes and keep the reserve.
bool has_disk_space(const std::filesystem::path& file, double growth);

/// Whether the process may make `file` larger by `growth` bytes (RLIMIT_FSIZE).
bool may_grow(const std::filesystem::path& file, double growth);

}  // namespace rubato::io
