#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rubato::io {

/// A file that a study names, as it was when it was read.
struct SourceFile {
  std::string name;  ///< as the study has it
  std::uint64_t checksum = 0;
};

using SourceFiles = std::vector<SourceFile>;  ///< in the order of reading

}  // namespace rubato::io
