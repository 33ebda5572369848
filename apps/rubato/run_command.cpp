#include "folder_watch.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "prepared_study.hpp"
#include "progress_bar.hpp"

#include <rubato/analysis/run_analyses.hpp>
#include <rubato/core/error.hpp>
#include <rubato/io/folder_lock.hpp>
#include <rubato/io/journal_file.hpp>
#include <rubato/io/output_folder.hpp>
#include <rubato/io/tee_sink.hpp>
#include <rubato/io/write_csv.hpp>
#include <rubato/io/write_netcdf.hpp>
#include <rubato/model/finite_elements/check_finite_elements.hpp>
#include <rubato/model/finite_elements/reduction.hpp>
#include <rubato/report/former_tables.hpp>
#include <rubato/report/write_report.hpp>
#include <rubato/report/write_vtk.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <set>

namespace rubato::app {
namespace {

using analysis::PreparedStudy;
using analysis::RunReport;
using analysis::RunStatus;

std::filesystem::path folder_of(const RunOptions& options) {
  if (!options.folder.empty()) return options.folder;
  const auto beside = options.study.study.parent_path();
  return (beside.empty() ? std::filesystem::path(".") : beside) / "results";
}

/// Sweeps that nobody would wait for are more often slips of the hand.
void require_points(const PreparedStudy& study, const RunOptions& options) {
  constexpr double most_points = 1e6;
  for (std::size_t i = 0; i < study.analyses.size(); ++i) {
    const double points = study.planned[i].outline.points;
    const auto& task = study.analyses[i];
    if (points > most_points && !options.yes)
      throw InvalidInput(task.where,
                         fmt::format("analysis \"{}\": the sweep has {:.6g} points, more than a million; say "
                                     "--yes if that is meant",
                                     task.name, points));
  }
}

/// What a resumed run writes anew, or need not write: the tables of the interrupted run, and the pieces in its
/// journals.
double bytes_replaced(const PreparedStudy& study, const std::filesystem::path& folder) {
  double bytes = 0.0;
  std::error_code fault;
  for (const auto& entry : std::filesystem::directory_iterator(folder, fault)) {
    const std::string name = entry.path().filename().string(), first = name.substr(0, name.find('.'));
    const bool is_of_study = std::any_of(study.analyses.begin(), study.analyses.end(),
                                         [&](const auto& analysis) { return analysis.name == first; });
    if (!is_of_study && name != "results.nc") continue;
    const std::uintmax_t size = entry.file_size(fault);
    if (!fault) bytes += static_cast<double>(size);
  }
  return bytes;
}

/// One journal an analysis that can resume, none for the others.
using Journals = std::vector<std::unique_ptr<io::JournalFile>>;

Journals open_journals(const PreparedStudy& study, const io::SourceFiles& files, const RunOptions& options,
                       const std::filesystem::path& folder) {
  Journals journals(study.analyses.size());
  for (std::size_t i = 0; i < journals.size(); ++i) {
    const auto& task = study.analyses[i];
    if (study.planned[i].outline.points == 0.0) continue;
    const auto fingerprint = io::fingerprint_of(*study.description, files, study.overrides, task.name);
    journals[i] = std::make_unique<io::JournalFile>(folder / (task.name + ".resume"), fingerprint, options.resume);
  }
  return journals;
}

void tell_of_damage(const Journals& journals, bool quiet) {
  for (const auto& journal : journals)
    if (journal && !journal->damage().empty() && !(quiet && journal->is_cut_short()))
      tell((journal->is_cut_short() ? "--resume: " : "warning: --resume: ") + journal->damage());
}

/// Tells which analyses begin anew, which --resume does not say: only sweeps go on where they stopped.
void tell_what_begins_anew(const PreparedStudy& study, const Journals& journals) {
  std::vector<std::string> others, sweeps;
  for (std::size_t i = 0; i < journals.size(); ++i) {
    if (journals[i] && journals[i]->finished() > 0) continue;
    (journals[i] ? sweeps : others).push_back("\"" + study.analyses[i].name + "\"");
  }
  const auto tell_of = [](const std::vector<std::string>& names, const char* why) {
    if (!names.empty())
      tell(fmt::format("--resume: {} begin{} anew: {}", fmt::join(names, ", "), names.size() == 1 ? "s" : "", why));
  };
  tell_of(others, "only sweeps go on where they stopped");
  tell_of(sweeps, "no interrupted run left points of it");
}

/// What is said of an analysis that has ended.
void tell_of(const model::AnalysisDescription& task, const std::string& file, const RunReport& report, bool quiet,
             bool can_resume) {
  if (!quiet)
    for (const std::string& finding : report.findings) tell(fmt::format("{}: {}", task.name, finding));
  for (const std::string& warning : report.warnings)
    tell(fmt::format("{}: warning: analysis \"{}\": {}", file, task.name, warning));
  if (report.status != RunStatus::done)
    tell(fmt::format("{}: analysis \"{}\" {}: {}{}", file, task.name,
                     report.status == RunStatus::failed ? "failed" : "stopped", report.message,
                     can_resume ? "; the same command with --resume goes on from there" : ""));
}

std::vector<std::optional<RunReport>> run_all(const PreparedStudy& study, const RunOptions& options,
                                              results::Sink& sink, const Journals& journals, FolderWatch& watch) {
  analysis::RunSetup setup{sink, stop_on_interrupt(), options.jobs, [&](std::size_t, bool has_neighbours) {
                             return std::make_unique<ProgressBar>(options.quiet, has_neighbours);
                           }};
  setup.journal = [&](std::size_t i) { return journals[i].get(); };
  setup.tell = [&](std::size_t i, const RunReport& report, bool is_refused) {
    const bool can_resume =
        (report.status == RunStatus::interrupted || is_refused) && journals[i] && watch.loss().empty();
    tell_of(study.analyses[i], study.description->file, report, options.quiet, can_resume);
  };
  return analysis::run_analyses(study, setup);
}

int exit_status_of(RunStatus status) {
  return status == RunStatus::done ? exit_done : status == RunStatus::failed ? exit_failed : exit_interrupted;
}

/// So that the tables, results.nc and the report are of one run.
void set_former_aside(const std::vector<std::string>& former, const std::set<std::string>& written,
                      const std::filesystem::path& folder, bool quiet) {
  const auto [moved, left] = report::set_former_aside(former, written, folder);
  if (!moved.empty() && !quiet)
    tell(fmt::format("tables of a former run, which these results do not have, were moved to {}: {}",
                     (folder / "former").string(), fmt::join(moved, ", ")));
  if (!left.empty())
    tell(fmt::format("warning: {} still holds tables of a former run, which these results do not have: {}",
                     folder.string(), fmt::join(left, ", ")));
}

/// For ParaView. Returns false, and says why, where it was not written; the results are safe.
bool write_motion(const std::filesystem::path& folder) {
  try {
    if (report::write_vtk(folder / "results.nc", folder / "vtk") == 0)
      tell(
          "--vtk: no analysis holds the motion of a whole structure (nodes, and all that is observed); nothing is "
          "written");
    return true;
  } catch (const std::exception& fault) {
    tell(fmt::format("error: the files for ParaView were not written: {}", reason_of(fault)));
    return false;
  }
}

/// Values of the model that are hardly meant, and what is doubtful of a finite element model.
/// @return what a finite element model is, for people
std::vector<std::string> tell_doubts(const PreparedStudy& study) {
  const auto findings = analysis::findings_of(study);
  for (const auto& [where, message] : findings.doubts)
    tell(fmt::format("{}:{}:{}: warning: {}", where.file, where.line, where.column, message));
  return findings.facts;
}

}  // namespace

int run(const RunOptions& options) {
  const CommandStudy command = prepare(options.study);
  const PreparedStudy& study = *command.prepared;
  (void)tell_doubts(study);
  analysis::require_memory(study);
  require_points(study, options);
  const std::filesystem::path folder = folder_of(options);
  int status = exit_done;
  std::vector<std::string> former;
  std::set<std::string> written;
  bool stays_former = false;
  std::optional<io::FolderLock> lock;
  (void)stop_on_interrupt();  // from here on a file that may not grow is an error of its write
  try {
    io::make_output_folder(folder);
    lock.emplace(folder);
    if (!lock->warning().empty()) {
      tell("warning: " + lock->warning());
      setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);  // HDF5 would lock its file too, and refuse to write
    }
    former = report::tables_in(folder);
    io::require_disk_space(folder, study.expected_bytes() - (options.resume ? bytes_replaced(study, folder) : 0.0));
    io::NetcdfSink netcdf(folder / "results.nc", {study.description->title, study.description->file,
                                                  study.description->text, options.command, io::utc_now()});
    for (const auto& analysis : study.analyses) netcdf.expect(analysis.name);
    const Journals journals = open_journals(study, command.files, options, folder);
    tell_of_damage(journals, options.quiet);
    if (options.resume && !options.quiet) tell_what_begins_anew(study, journals);
    // Tables replace former ones when results.nc does, so that all are of one run.
    io::CsvSink csv(folder, [&] { return netcdf.is_published(); });
    io::TeeSink sink({&netcdf, &csv});
    FolderWatch watch([&] {
      const std::string loss = lock->loss();
      return loss.empty() && !netcdf.is_there() ? "has lost its results.nc" : loss;
    });
    const auto reports = run_all(study, options, sink, journals, watch);
    if (const std::string loss = watch.loss(); !loss.empty())
      throw OutputError(fmt::format("{}: the folder {} while the run wrote into it; the run ends here, without results",
                                    folder.string(), loss));
    status = exit_status_of(analysis::note_unfinished(study, reports, netcdf));
    netcdf.close();
    csv.close();
    written = csv.written();
    stays_former = !netcdf.is_published();
    for (const auto& journal : journals)
      if (journal && status == exit_done) journal->remove();
  } catch (const OutputError& fault) {
    tell(fmt::format("error: {}", reason_of(fault)));
    lock.reset();
    // HDF5 tries once more to write what it could not as the process ends, and crashes: leave without it.
    std::fflush(nullptr);
    std::_Exit(exit_failed);
  }
  if (stays_former) {
    tell(fmt::format("{}: nothing was written; the former results stay", folder.string()));
    return status;
  }
  set_former_aside(former, written, folder, options.quiet);
  if (options.vtk && !write_motion(folder) && status == exit_done) status = exit_failed;
  try {
    report::write_report(folder / "results.nc", folder / "report.html");
  } catch (const std::exception& fault) {  // the results are safe; only their picture is missing
    tell(fmt::format("error: the report was not written: {}", reason_of(fault)));
    return status == exit_done ? exit_failed : status;
  }
  if (!options.quiet) fmt::print("{}\n", (folder / "report.html").string());
  return status;
}

int check(const StudyOptions& options) {
  const CommandStudy command = prepare(options);
  const PreparedStudy& study = *command.prepared;
  const std::vector<std::string> facts = tell_doubts(study);
  fmt::print("{}\n  {}\n", study.description->title, study.kind->summary());
  for (const std::string& fact : facts) fmt::print("  [model] {}\n", fact);
  if (const auto& elements = study.description->model.finite_elements) {
    constexpr Index first = 6;
    if (const std::string text = model::first_frequencies(*elements, first); !text.empty())
      fmt::print("  [model] {}\n", text);
    if (elements->reduction)
      for (const std::string& fact : model::facts_of(*elements->reduction)) fmt::print("  [reduction] {}\n", fact);
  }
  for (const auto& [name, value] : study.parameters) fmt::print("  {} = {}\n", name, value);
  for (std::size_t i = 0; i < study.analyses.size(); ++i) {
    fmt::print("  {}: {}\n", study.analyses[i].name, study.planned[i].outline.summary);
    for (const std::string& warning : study.planned[i].outline.warnings)
      tell(fmt::format("{}: warning: analysis \"{}\": {}", study.description->file, study.analyses[i].name, warning));
  }
  return exit_done;
}

}  // namespace rubato::app
