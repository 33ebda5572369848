#pragma once

#include <rubato/analysis/packed_numbers.hpp>
#include <rubato/steady/steady_solver.hpp>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace rubato::analysis {

/// What became of a point: the statuses of the solvers, and one for parameters that no model can have.
enum class PointStatus { converged, not_converged, subharmonic, quasi_periodic, unbounded, impossible, drifting };
inline constexpr std::size_t point_statuses = 7;

/// The words of the column `status`, by PointStatus.
const std::vector<std::string>& status_words();
PointStatus point_status(steady::SteadyStatus status);

/// How often something is to be said, and the first place that it is to be said of (a number; -1: none).
struct Tally {
  double count = 0.0, first = -1.0;

  void note(double place);
  void add(const Tally& other);
};

/// What became of the points of a sweep, or of the values of a curve.
struct StatusCounts {
  std::array<Tally, point_statuses> by_status{};
  Tally negative_loads;  ///< places with a negative normal load
  Tally excursions;      ///< places where a mechanism leaves the small motions about its equilibrium

  const Tally& of(PointStatus status) const { return by_status[static_cast<std::size_t>(status)]; }
  Tally& of(PointStatus status) { return by_status[static_cast<std::size_t>(status)]; }
  double total() const;
  void add(const StatusCounts& other);

  /// Appends the numbers to a list, and reads them back.
  void pack(std::vector<double>& values) const;
  void unpack(PackedNumbers& values);
  /// Adds words and numbers of the statuses that occurred, converged ones in any case.
  void describe(std::vector<std::pair<std::string, std::string>>& statistics) const;
};

}  // namespace rubato::analysis
