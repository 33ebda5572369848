#pragma once

#include <string>

namespace rubato::io {

/// Where results come from: kept with them.
struct Provenance {
  std::string title;
  std::string study_file;
  std::string study_text;
  std::string command;  ///< as it was called, parameters included
  std::string date;     ///< UTC, ISO 8601
};

/// Now, as `2026-01-31T12:00:00Z`.
std::string utc_now();

}  // namespace rubato::io
