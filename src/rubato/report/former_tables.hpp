#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace rubato::report {

/// The tables that the results file of a folder tells of, as CSV files; none where there is no such file.
std::vector<std::string> tables_in(const std::filesystem::path& folder);

/// Which files were moved, and which could not be.
struct SetAside {
  std::vector<std::string> moved, left;
};

/// Tables of a former run that the new one has not written go to the folder `former`, so that the tables, results.nc
/// and the report are of one run. What Rubato did not write stays where it is.
/// @param former   what tables_in() told before the run
/// @param written  what the run wrote
SetAside set_former_aside(const std::vector<std::string>& former, const std::set<std::string>& written,
                          const std::filesystem::path& folder);

}  // namespace rubato::report
