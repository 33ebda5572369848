#pragma once

#include <rubato/analysis/steady/frequency_response_plan.hpp>
#include <rubato/analysis/steady/status_counts.hpp>
#include <rubato/results/sink.hpp>

#include <array>
#include <span>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Percentiles that are kept of random samples.
inline constexpr std::array<int, 5> band_percents{5, 25, 50, 75, 95};

/// Columns whose names a swept parameter cannot bear.
std::vector<std::string> reserved_columns();

/// Where a row belongs: the values of its line, the direction and the frequency.
struct RowPlace {
  std::span<const double> line;
  bool is_downwards = false;
  double angular_frequency = 0.0;  ///< of the excitation parameter [rad/s]
};

/// The main table, a row a point: the swept parameters, the direction (where both are asked for), `angular_frequency`,
/// `fundamental` (where it is another), what is observed, the sliders, the laws, the works, and how far to trust it.
class ResponseTable {
 public:
  ResponseTable(const std::string& name, const FrequencyResponsePlan& plan, const StudyInput& input);
  const results::TableLayout& layout() const { return layout_; }
  std::size_t width() const { return width_; }
  /// The place of the first amplitude in a row.
  std::size_t amplitudes() const { return amplitudes_; }
  /// Appends the row of a point to `rows`.
  void add(const RowPlace& place, double fundamental, const steady::SteadyResponse& response,
           std::vector<double>& rows) const;
  /// Appends the row of a point that no model can have.
  void add_impossible(const RowPlace& place, std::vector<double>& rows) const;

 private:
  void add_place(const RowPlace& place, std::vector<double>& rows) const;

  results::TableLayout layout_;
  std::size_t width_ = 0, amplitudes_ = 0;
  std::vector<Index> sliders_, laws_;  ///< in the order of the columns
  bool has_direction_ = false, has_fundamental_ = false, shows_first_parts_ = false;
};

/// Table `linear`: amplitudes and phases of the two linear limits, without sliders and with all of them stuck, for
/// every combination of the parameters on which they depend.
class LinearTable {
 public:
  LinearTable(const std::string& name, const FrequencyResponsePlan& plan);
  const results::TableLayout& layout() const { return layout_; }
  std::size_t width() const { return width_; }
  void add(const RowPlace& place, const steady::SteadyResponse& free, const steady::SteadyResponse& stuck,
           std::vector<double>& rows) const;

 private:
  results::TableLayout layout_;
  std::vector<bool> is_linear_;
  std::size_t width_ = 0;
};

/// Table `waveforms`: what is observed over a period, with force and relative displacement of each slider (its loop).
class WaveformTable {
 public:
  WaveformTable(const std::string& name, const FrequencyResponsePlan& plan, const StudyInput& input);
  const results::TableLayout& layout() const { return layout_; }
  std::size_t width() const { return width_; }
  void add(const RowPlace& place, const steady::Waveform& waveform, std::vector<double>& rows) const;

 private:
  results::TableLayout layout_;
  std::vector<Observed> observed_;
  std::vector<Index> sliders_;  ///< in the order of the columns
  bool has_direction_ = false;
  std::size_t width_ = 0;
};

/// Table `bands` of random samples: percentiles of the amplitudes over the samples, at each frequency, and how many
/// samples have no amplitude there.
class BandTable {
 public:
  BandTable(const std::string& name, const FrequencyResponsePlan& plan);
  const results::TableLayout& layout() const { return layout_; }
  /// Takes the amplitudes [observed] of one sample at one step of the line.
  void take(std::size_t step, std::span<const double> amplitudes);
  /// Writes every row.
  void write(results::RowWriter& writer);

 private:
  results::TableLayout layout_;
  const FrequencyResponsePlan& plan_;
  std::vector<std::vector<double>> values_;  ///< by step and observed
  std::vector<double> missing_;              ///< by step
};

}  // namespace rubato::analysis
