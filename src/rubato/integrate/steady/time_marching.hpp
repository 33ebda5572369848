#pragma once

#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/steady/orbit_search.hpp>

#include <memory>
#include <vector>

namespace rubato::integrate {

struct TimeMarchingOptions {
  /// Any method of the catalogue with a step.
  Method method = make_method("generalized_alpha", {{"rho_inf", 0.9}});
  int steps_per_period = 0;  ///< 0: chosen so that the error of the amplitude stays below the tolerance
  double tolerance = 1e-3;   ///< of the amplitude, against the largest observed [-]
  double periodicity = 0.0;  ///< of the states one period apart, relative [-]; 0: a hundredth of the tolerance
  int max_periods = 1000;    ///< of one march
  int max_steps = 1 << 15;   ///< in a period, where they are chosen
  bool extrapolates = true;  ///< see PeriodExtrapolation; never used with SteadyStart::rest
};

/// Steady responses by marching a method until the response repeats (see docs/theory/time-marching.md).
///
/// The step is chosen by error: the response is found with N and with N/2 steps a period, and with a method of order p
/// (2 at most: transitions of sliders fall between the samples) the amplitudes A differ from the exact ones by about
/// |A_N - A_N/2| / (2^p - 1). N grows until that is below the tolerance, and shrinks again at the next point. Explicit
/// methods keep to nine tenths of their stable step.
///
/// Status: converged; not_converged (no repetition within max_periods, or max_steps too few for the tolerance);
/// subharmonic and quasi_periodic, found where nothing is extrapolated; unbounded where the motion grows in proportion
/// to time. `error` is that of the step and of the rest of the transient together; NaN where it cannot be estimated.
class TimeMarchingSolver final : public SteadySolver {
 public:
  /// The system must outlive the solver. Throws InvalidInput for the method `exact`, for a method without a stable
  /// step, and for options out of range.
  TimeMarchingSolver(const system::LocallyNonlinear& system, TimeMarchingOptions options, SteadyRequest request);
  ~TimeMarchingSolver() override;

  /// Throws InvalidInput where the given number of steps is below least_steps.
  void solve(const Excitation& excitation, SteadyStart start, SteadyResponse& response) override;
  Waveform waveform(int points) const override;
  void forget() override;

  /// Fewest steps a period that the stability of the method allows at a frequency; 1 for unconditional methods.
  int least_steps(double angular_frequency) const;
  /// Steps a period of the last point.
  int steps() const { return steps_; }

 private:
  struct Memory;
  int first_steps(const Excitation& excitation) const;
  void start_states(const Excitation& excitation, SteadyStart start, LaneArray& states);
  void find(const Excitation& excitation, SteadyStart start, int steps, LaneArray& states, SteadyResponse& response);
  bool release_offsets(const Excitation& excitation, const SteadyResponse& response, LaneArray& states) const;

  const system::LocallyNonlinear& system_;
  TimeMarchingOptions options_;
  SteadyRequest request_;
  double stable_step_;
  int order_;
  Vector slider_stiffness_;
  std::unique_ptr<PeriodMap> map_;
  std::vector<PeriodRecord> records_;
  std::unique_ptr<Memory> memory_;
  int steps_ = 0;
};

}  // namespace rubato::integrate
