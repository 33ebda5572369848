#pragma once

#include <rubato/results/journal.hpp>
#include <rubato/results/sink.hpp>

#include <atomic>
#include <string>
#include <utility>
#include <vector>

namespace rubato::analysis {

/// Hears how far an analysis is. Called often (every few milliseconds of work), so it must be cheap.
class Progress {
 public:
  virtual ~Progress() = default;
  /// @param what  the analysis's name   @param unit  what is counted ("steps", "points")
  virtual void begin(const std::string& what, double total, const std::string& unit) = 0;
  virtual void advance(double done) = 0;
  virtual void end() = 0;
};

/// What an analysis is given besides its description: where results go, who hears of progress, and a flag that asks it
/// to stop at the next accepted step (Ctrl-C).
struct RunContext {
  results::Sink& sink;
  Progress& progress;
  const std::atomic<bool>& stop;
  int threads = 0;                      ///< at most so many, and one a core; 0: one a core
  results::Journal* journal = nullptr;  ///< where finished pieces are kept; those in it are not computed again
};

enum class RunStatus { done, failed, interrupted };

/// What became of an analysis. `message` says, for a failure, when, where and what to try.
struct RunReport {
  RunStatus status = RunStatus::done;
  std::string message;
  std::vector<std::pair<std::string, std::string>> statistics;  ///< steps, factorisations, ...: kept with the results
  std::vector<std::string> warnings = {};                       ///< what the user should know of results that are there
  std::vector<std::string> findings = {};  ///< what was asked for, where it fits a line: an optimum
};

}  // namespace rubato::analysis
