#pragma once

#include <rubato/analysis/steady/damper_curve_plan.hpp>
#include <rubato/analysis/steady/frequency_response_tables.hpp>
#include <rubato/analysis/steady/optimum.hpp>
#include <rubato/results/sink.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rubato::analysis {

/// Columns whose names the parameters of a damper curve cannot bear.
std::vector<std::string> damper_curve_columns();

/// The tables of a damper curve. Each row begins with the values of the swept parameters.
///
/// Main: the parameter, where over frequency the objective is largest, the response there, and how far to trust it.
/// `linear`: the largest amplitudes of both linear limits. `peaks`: every peak, by a number that follows it along the
/// parameter. `optimum`: in the columns of the main table, and what certifies it. `bands` of random samples:
/// percentiles of the objective.
class DamperCurveTables {
 public:
  DamperCurveTables(const std::string& name, const DamperCurvePlan& plan, const StudyInput& input);

  const results::TableLayout& main() const { return main_; }
  const results::TableLayout& linear() const { return linear_; }
  const results::TableLayout& peaks() const { return peaks_; }
  const results::TableLayout& optimum() const { return optimum_; }
  const results::TableLayout& bands() const { return bands_; }

  /// Appends the row of a value of the parameter. `top`: its highest peak; nothing where there is none.
  void add(std::span<const double> line, double parameter, const std::optional<Peak>& top, std::size_t peaks,
           const steady::SteadyResponse& response, PointStatus status, std::vector<double>& rows) const;
  void add_limits(std::span<const double> line, double parameter, const std::optional<Peak>& free,
                  const std::optional<Peak>& stuck, std::vector<double>& rows) const;
  void add_peak(std::span<const double> line, double parameter, long number, const Peak& peak, double error,
                PointStatus status, std::vector<double>& rows) const;
  void add_optimum(std::span<const double> line, const Optimum& optimum, const steady::SteadyResponse& response,
                   std::vector<double>& rows) const;

  /// The place of the objective in a row of the main table.
  std::size_t objective() const { return objective_; }

 private:
  void add_response(const std::optional<Peak>& top, const steady::SteadyResponse& response,
                    std::vector<double>& rows) const;

  bool is_amplitude_;
  std::size_t observed_ = 0, sliders_ = 0, objective_ = 0;
  std::vector<Index> laws_;  ///< and blocks, in the order of the columns
  results::TableLayout main_, linear_, peaks_, optimum_, bands_;
};

}  // namespace rubato::analysis
