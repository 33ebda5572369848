#pragma once

#include <filesystem>

namespace rubato::report {

/// Draws the results of a study as one HTML page that opens offline.
///
/// Its size is bounded whatever the length of the results: long tables are shown as the extremes of 2000 buckets and,
/// for phase portraits and hysteresis loops, their last 4000 rows; the first 32 labels of a dimension are drawn.
/// The page replaces `html` in one move when it is complete.
///
/// @param results_nc  what a NetcdfSink wrote: complete, failed or interrupted; left unchanged
/// @throws InvalidInput when `results_nc` cannot be read, OutputError when `html` cannot be written
void write_report(const std::filesystem::path& results_nc, const std::filesystem::path& html);

}  // namespace rubato::report
