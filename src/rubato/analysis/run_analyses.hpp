#pragma once

#include <rubato/analysis/prepared_study.hpp>
#include <rubato/analysis/run_context.hpp>
#include <rubato/results/sink.hpp>

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace rubato::analysis {

/// What the analyses of a study are run with. The functions are given the place of an analysis among those of the
/// prepared study, and are called from the threads that run.
struct RunSetup {
  results::Sink& sink;
  const std::atomic<bool>& stop;  ///< asks all of them to stop
  int jobs = 0;                   ///< analyses at a time, and threads of a sweep; 0: one analysis, on all cores
  /// Who hears how far an analysis is; `has_neighbours` where several run at a time.
  std::function<std::unique_ptr<Progress>(std::size_t analysis, bool has_neighbours)> progress;
  /// Where an analysis keeps finished pieces; empty, or null for some: nowhere.
  std::function<results::Journal*(std::size_t analysis)> journal = {};
  /// Hears what became of an analysis; `is_refused` where its results could not be written.
  std::function<void(std::size_t analysis, const RunReport& report, bool is_refused)> tell = {};
};

/// Runs the analyses of a study, several at a time; each writes tables of its own, so that the results do not depend on
/// how many. What goes wrong with one is in its report. After an interrupt, and where results cannot be written, those
/// that have not begun are left.
/// @return the report of each analysis; none where it has not begun
std::vector<std::optional<RunReport>> run_analyses(const PreparedStudy& study, const RunSetup& setup);

/// Notes with the results what the analyses could not: that a write was refused, that they were not reached.
/// @return the status of the first analysis that was not done; `done` where none is
RunStatus note_unfinished(const PreparedStudy& study, const std::vector<std::optional<RunReport>>& reports,
                          results::Sink& sink);

}  // namespace rubato::analysis
