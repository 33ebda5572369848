#pragma once

#include <rubato/analysis/steady/damper_curve_plan.hpp>
#include <rubato/analysis/steady/frequency_response_tables.hpp>
#include <rubato/analysis/steady/optimum.hpp>
#include <rubato/analysis/steady/parametric_excitation.hpp>
#include <rubato/steady/steady_route.hpp>

#include <array>
#include <atomic>
#include <memory>
#include <span>
#include <vector>

namespace rubato::analysis {

/// The objective over frequency and over the parameter of a damper curve, for one line of its sweep: amplitudes of what
/// is observed, or the friction work of all sliders. What it answers for a value of the parameter does not depend on
/// the values asked for before. One a thread.
class DamperPeaks final : public PeakFamily {
 public:
  /// @param stop  asks to give up: then there are no peaks
  DamperPeaks(const DamperCurvePlan& plan, const StudyInput& input, const steady::SteadySolvers& solvers,
              const std::atomic<bool>& stop);

  /// Goes on to a line of the sweep.
  void take_line(long line);

  std::vector<Peak> peaks(double parameter) override;
  std::optional<Peak> follow(double parameter, const Peak& known) override;

  /// Amplitudes of a linear limit: of the structure without sliders, or with all of them stuck. An infinite one where
  /// the loads meet a resonance without damping.
  std::vector<Peak> limit_peaks(double parameter, bool is_stuck);

  /// The whole response at a peak, with the discretisation of the last `peaks`. Its status says what became of it:
  /// where it is truncated, and errs or differs from the peak by more than the tolerance, it is not converged.
  const steady::SteadyResponse& response_at(double parameter, const Peak& peak);

  /// How a mechanism leaves the small motions about its equilibrium in the last `response_at`; empty where it does not.
  std::string excursion() const;

  /// With what the response behind the last `peaks` was truncated; unset where it is not.
  const std::optional<steady::SteadyDiscretisation>& discretisation() const { return held_; }
  /// From now on all values are solved with one discretisation, so that they can be differentiated over the parameter;
  /// nothing: each value with its own.
  void share(const std::optional<steady::SteadyDiscretisation>& shared);
  /// What the response needs at a place of the curve to come within the tolerance; nothing where it does not.
  std::optional<steady::SteadyDiscretisation> needed_at(double parameter, double angular_frequency);

  /// What became of the points that were solved for the last `peaks`: how many of each status, and where the first was
  /// that did not converge.
  struct Scan {
    std::array<long, point_statuses> by_status{};
    double first_unbounded = 0.0;  ///< [rad/s]
    std::string reason;            ///< why there is no model at a point; empty where there is
    bool has_negative_load = false;
    double negative_load = 0.0;  ///< [N]
    std::size_t negative_slider = 0;
  };
  const Scan& scan() const { return scan_; }
  /// How many amplitudes there are.
  std::size_t observed() const { return plan_.observed.size(); }
  /// Points solved since it was made.
  double solves() const { return solves_; }

 private:
  bool take(double parameter, bool begins_afresh);
  bool take_point(double angular_frequency);
  void require_structure(double point);
  bool evaluate(steady::SteadySolver& solver, double angular_frequency, Vector& values);
  PeakRange range();
  PeakRange range_with_extremes();
  std::vector<Peak> peaks_between(const PeakRange& range);
  void hold(const std::optional<steady::SteadyDiscretisation>& held, bool with_error = false);
  bool approach(double angular_frequency, double side);
  void include_what_is_needed(double angular_frequency, std::optional<steady::SteadyDiscretisation>& sum);

  const DamperCurvePlan& plan_;
  const StudyInput& input_;
  const steady::SteadySolvers& make_;
  const std::atomic<bool>& stop_;

  ParametricExcitation drive_;
  std::vector<double> values_;  ///< of the swept parameters, and the curve's own
  std::unique_ptr<SteadyModel> structure_;
  std::vector<double> structure_values_;  ///< what it was built with
  std::unique_ptr<steady::SteadySolver> solver_, coarse_, free_, stuck_;
  Vector natural_;  ///< natural frequencies of both limits [rad/s]
  system::Excitation excitation_;
  steady::SteadyResponse response_;
  Vector objective_;                                    ///< of the coarse scan
  std::vector<std::pair<double, double>> high_places_;  ///< extremes of the coarse scan: frequency and objective
  std::optional<steady::SteadyDiscretisation> held_;
  bool is_shared_ = false;  ///< what is held, by all values
  Scan scan_;
  double solves_ = 0.0;
};

}  // namespace rubato::analysis
