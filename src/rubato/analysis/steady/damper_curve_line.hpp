#pragma once

#include <rubato/analysis/steady/damper_curve_tables.hpp>
#include <rubato/analysis/steady/damper_peaks.hpp>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rubato::analysis {

/// What is to be said of the values of a curve, which are numbered over all lines.
struct DamperCurveCounts : StatusCounts {
  double solves = 0.0;
  double unconverged_samples = 0.0;  ///< of scans
  double without_optimum = 0.0;      ///< lines
  Tally at_ends;                     ///< values whose largest objective lies at an end of the frequencies
  Tally walks;                       ///< values at which the structure drifts at some frequencies

  void add(const DamperCurveCounts& other);
};

/// The rows of one line of the sweep, table by table.
struct DamperLineResult {
  long line = 0;
  bool is_whole = true;  ///< false: interrupted, and the rows are those of the first values
  std::vector<double> main, linear, peaks, optimum;
  DamperCurveCounts counts;

  /// As one list of numbers, and back, for the journal. Throws InvalidInput for the list of another line.
  std::vector<double> packed() const;
  static DamperLineResult unpacked(long line, const DamperCurveTables& tables, std::span<const double> values);
};

/// What one value of the parameter has given.
struct DamperValue {
  bool is_done = false;
  std::vector<Peak> peaks;
  steady::SteadyResponse response;
  PointStatus status = PointStatus::not_converged;
  std::vector<PointStatus> peak_status;  ///< of each peak; empty where they were not asked for
  std::vector<double> peak_error;        ///< of the amplitudes there, relative
  DamperPeaks::Scan scan;
  bool moves_far = false;  ///< of a mechanism: beyond small motions
  std::optional<steady::SteadyDiscretisation> discretisation;
  std::optional<std::array<std::optional<Peak>, 2>> limits;  ///< free and stuck, where they were asked for
};

/// Solves one value; `with_peaks`: also the response at each lower peak; `with_limits`: also the linear limits.
DamperValue solve_value(DamperPeaks& family, double parameter, bool with_peaks, bool with_limits);

/// The rows of a line from its values, and its optimum.
DamperLineResult finish_line(const DamperCurvePlan& plan, const DamperCurveTables& tables, long line,
                             const std::vector<DamperValue>& values, DamperPeaks& family);

}  // namespace rubato::analysis
