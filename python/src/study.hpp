#pragma once

#include "task.hpp"

#include <rubato/analysis/prepared_study.hpp>
#include <rubato/analysis/run_analyses.hpp>
#include <rubato/results/memory_sink.hpp>

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <variant>
#include <vector>

// What Python calls, in terms of the library: nothing in here knows Python.
namespace rubato::python {

/// Values of parameters by name: numbers, or formulas of numbers ("2*pi").
using Settings = std::vector<std::pair<std::string, std::variant<double, std::string>>>;

/// A study that was read; what runs it shares the description.
struct Study {
  std::shared_ptr<const model::StudyDescription> description;
  std::filesystem::path folder;  ///< of the files that it names
};

Study read_study(const std::filesystem::path& file);
Study read_study_text(const std::string& text, const std::string& name, const std::filesystem::path& folder);

/// How far an analysis is.
struct Progress {
  std::string analysis;
  double done = 0.0, total = 0.0;
  std::string unit;  ///< "steps", "points"
};

/// What a run would do.
struct Outline {
  std::string title, summary;
  std::vector<std::string> facts, doubts;
  numerics::Parameters parameters;
  struct Analysis {
    std::string name, summary;
    std::vector<std::string> warnings;
  };
  std::vector<Analysis> analyses;
};

/// A study on its way from settings to results, or to its outline only.
class Run {
 public:
  Run(Study study, Settings settings, std::vector<std::string> only, int jobs, bool checks_only);

  bool wait(double seconds) { return task_->wait(seconds); }
  void stop() { task_->stop(); }
  /// Throws what the work threw. The next three are for afterwards.
  void require_success() { task_->require_success(); }
  const Outline& outline() const { return outline_; }
  const std::vector<results::MemoryAnalysis>& analyses() const;
  std::vector<std::pair<std::string, std::string>> warnings() const { return warnings_; }  ///< of which analysis, what

  std::vector<Progress> progress() const;
  /// results.nc, the tables as CSV and report.html, as the command writes them. Throws InvalidInput and OutputError.
  /// @param command  for the provenance
  void write(const std::filesystem::path& folder, const std::string& command) const;
  /// The page alone.
  void write_report(const std::filesystem::path& page, const std::string& command) const;

 private:
  class Listener;
  void work(const std::atomic<bool>& stop);
  void note_outline(const analysis::PreparedStudy& prepared);
  void run(const analysis::PreparedStudy& prepared, const std::atomic<bool>& stop);

  Study study_;
  Settings settings_;
  std::vector<std::string> only_;
  int jobs_;
  bool checks_only_;
  Outline outline_;
  std::unique_ptr<results::MemorySink> sink_;
  std::vector<std::pair<std::string, std::string>> warnings_;
  mutable std::mutex mutex_;  // guards progress_ and warnings_ while the work goes on
  std::vector<Progress> progress_;
  std::unique_ptr<Task> task_;  // last: it uses all of the above
};

}  // namespace rubato::python
