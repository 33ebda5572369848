#pragma once

#include <filesystem>

namespace rubato::io {

/// Makes the folder for results ready: creates it, writes and removes a probe, and compares the free space with what is
/// expected. Throws OutputError, naming the folder and the remedy, before anything is computed.
void prepare_output_folder(const std::filesystem::path& folder, double expected_bytes);

/// `text: REASON` for a failed write, with the reason of the operating system, and the free space where it has run out.
std::string write_failure(const std::filesystem::path& file, int error_number);

}  // namespace rubato::io
