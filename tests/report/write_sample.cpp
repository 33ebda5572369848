#include <rubato/report/write_report.hpp>

#include "report/sample_results.hpp"

#include <filesystem>

/// Writes results.nc and report.html of a sample study into a folder: what the browser test opens.
int main(int, char** arguments) {
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);
  rubato::test::write_sample_results(folder / "results.nc");
  rubato::report::write_report(folder / "results.nc", folder / "report.html");
}
