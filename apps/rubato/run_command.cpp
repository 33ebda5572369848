#include "interrupt.hpp"
#include "prepared_study.hpp"
#include "progress_bar.hpp"

#include <rubato/core/error.hpp>
#include <rubato/io/output_folder.hpp>
#include <rubato/io/tee_sink.hpp>
#include <rubato/io/write_csv.hpp>
#include <rubato/io/write_netcdf.hpp>
#include <rubato/report/write_report.hpp>

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

namespace rubato::app {
namespace {

std::filesystem::path folder_of(const RunOptions& options) {
  if (!options.folder.empty()) return options.folder;
  const auto beside = options.study.study.parent_path();
  return (beside.empty() ? std::filesystem::path(".") : beside) / "results";
}

int worse(int a, int b) { return a == exit_done ? b : a; }

}  // namespace

int run(const RunOptions& options) {
  const PreparedStudy study = prepare(options.study);
  const std::filesystem::path folder = folder_of(options);
  int status = exit_done;
  try {
    io::prepare_output_folder(folder, study.expected_bytes());
    io::NetcdfSink netcdf(folder / "results.nc", {study.description.title, study.description.file,
                                                  study.description.text, options.command, io::utc_now()});
    io::CsvSink csv(folder);
    io::TeeSink sink({&netcdf, &csv});
    ProgressBar progress(options.quiet);
    analysis::RunContext context{sink, progress, stop_on_interrupt()};
    for (const auto& analysis : study.analyses) {
      analysis::RunReport report;
      try {
        report = analysis::run_analysis(analysis, study.system, study.parameters, context);
      } catch (const OutputError& fault) {  // what is written stays, and says why it ends
        fmt::print(stderr, "error: {}\n", fault.what());
        netcdf.conclude(analysis.name, "failed", fault.what(), {});
        status = exit_failed;
        break;
      }
      if (report.status == analysis::RunStatus::done) continue;
      fmt::print(stderr, "{}: analysis \"{}\" {}: {}\n", study.description.file, analysis.name,
                 report.status == analysis::RunStatus::failed ? "failed" : "stopped", report.message);
      status = worse(status, report.status == analysis::RunStatus::failed ? exit_failed : exit_interrupted);
      if (report.status == analysis::RunStatus::interrupted) break;
    }
    netcdf.close();
  } catch (const OutputError& fault) {
    fmt::print(stderr, "error: {}\n", fault.what());
    // HDF5 tries once more to write what it could not as the process ends, and crashes: leave without it.
    std::fflush(nullptr);
    std::_Exit(exit_failed);
  }
  try {
    report::write_report(folder / "results.nc", folder / "report.html");
  } catch (const std::exception& fault) {  // the results are safe; only their picture is missing
    fmt::print(stderr, "error: the report was not written: {}\n", fault.what());
    return worse(status, exit_failed);
  }
  if (!options.quiet) fmt::print("{}\n", (folder / "report.html").string());
  return status;
}

int check(const StudyOptions& options) {
  const PreparedStudy study = prepare(options);
  fmt::print("{}\n  {} coordinates, {} sliders\n", study.description.title, study.system.size(),
             study.system.slider_count());
  for (const auto& [name, value] : study.parameters) fmt::print("  {} = {}\n", name, value);
  for (std::size_t i = 0; i < study.analyses.size(); ++i)
    fmt::print("  {}: {}\n", study.analyses[i].name, study.outlines[i].summary);
  return exit_done;
}

}  // namespace rubato::app
