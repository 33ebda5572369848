#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// What the subcommands do once their options are read. Each returns the exit status: 0 done, 1 results differ, 2 the
// study or the options are wrong, 3 the mathematics or the output failed, 130 interrupted. Faults of the user's world
// leave as InvalidInput.
namespace rubato::app {

inline constexpr int exit_done = 0, exit_differs = 1, exit_wrong = 2, exit_failed = 3, exit_interrupted = 130;

struct StudyOptions {
  std::filesystem::path study;
  std::vector<std::string> set;   ///< PARAM=VALUE
  std::vector<std::string> only;  ///< names of analyses
};

struct RunOptions {
  StudyOptions study;
  std::filesystem::path folder;  ///< empty: results/ beside the study
  int jobs = 0;                  ///< analyses at a time, and threads of a sweep; 0: one analysis, on all cores
  bool resume = false;           ///< go on where an interrupted run stopped
  bool yes = false;              ///< run sweeps of any size
  bool vtk = false;              ///< also write the motion of structures for ParaView
  bool quiet = false;
  std::string command;  ///< as it was called, for the provenance
};

struct CompareOptions {
  std::filesystem::path first, second;  ///< folders of results
  double tolerance = 1e-6;              ///< of differences over the largest value of their column [-]
  bool all = false;                     ///< tell every column, equal ones too
};

int run(const RunOptions& options);
int check(const StudyOptions& options);
/// Prints which analysis takes which law.
int list_laws();
int list_methods();
int show_method(const std::string& name, const std::vector<std::string>& parameters, bool csv);
int list_examples();
/// Prints how far two results are from one another. 0: within the tolerance; 1: beyond it, or one of them lacks
/// something.
int compare(const CompareOptions& options);
int copy_example(const std::string& name, const std::filesystem::path& folder);

}  // namespace rubato::app
