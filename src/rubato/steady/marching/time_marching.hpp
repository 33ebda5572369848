#pragma once

#include <rubato/steady/marching/marching_options.hpp>
#include <rubato/steady/marching/orbit_search.hpp>
#include <rubato/steady/undamped_resonance.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace rubato::steady {

/// Steady responses by marching a method until the response repeats (see docs/theory/time-marching.md).
///
/// The step is chosen by error: the response is found with N and with N/2 steps a period, and with a method of order p
/// (2 at most: transitions of sliders fall between the samples) the amplitudes A differ from the exact ones by about
/// |A_N - A_N/2| / (2^p - 1). N grows until that is below the tolerance, and shrinks again at the next point. Because
/// two numbers of steps may err alike by chance, the first point of a sweep is found with 3N/4 and 2N steps too (what
/// they say is remembered, and falls slowly), and all points with 3N/4 where a method is so accurate without
/// transitions (exponential, Runge-Kutta of order 3 and 4) that chance is most of its error. Steps too few for the
/// ringing of the modes after transitions agree on what is wrong: what rings beyond their reach adds to the error (see
/// unresolved_ringing). Explicit methods keep to nine tenths of their stable step.
///
/// The error stated against the true one, on 1,000 random models each (tests/support/random_model.hpp), single points
/// at a tolerance of 1e-3: generalized-alpha at most 0.51 of what is said, exponential 0.59.
///
/// Status: converged; not_converged (no repetition within max_periods, or max_steps too few for the tolerance);
/// subharmonic and quasi_periodic, found where nothing is extrapolated; unbounded where it does not repeat and the
/// loads meet a resonance without damping (UndampedResonance); drifting where it repeats but for a displacement (of
/// structures of up to 300 coordinates). `error` is that of the step and of the rest of the transient together; NaN
/// where it cannot be estimated. Work with the sums of a ledger: average acceleration closes the balance of energy to
/// round-off.
class TimeMarchingSolver final : public SteadySolver {
 public:
  /// The system must outlive the solver. Throws InvalidInput for the method `exact`, for a method without a stable
  /// step, and for options out of range.
  TimeMarchingSolver(const system::LocallyNonlinear& system, TimeMarchingOptions options, SteadyRequest request);
  ~TimeMarchingSolver() override;

  /// Throws InvalidInput where the given number of steps is below least_steps.
  void solve(const system::Excitation& excitation, SteadyStart start, SteadyResponse& response) override;
  /// 16 for small models and methods of the alpha family or the exponential one, else 1. The lanes share their step.
  int lanes() const override;
  void solve_lanes(std::span<const system::Excitation> excitations, SteadyStart start,
                   std::span<SteadyResponse> responses) override;
  /// Of the last point solved (the last of a list).
  Waveform waveform(int points) const override;
  void forget() override;

  /// Fewest steps a period that the stability of the method allows at a frequency; 1 for unconditional methods.
  int least_steps(double angular_frequency) const;
  /// Steps a period of the last point.
  int steps() const { return steps_; }

 private:
  struct Place;
  struct Engine;
  int first_steps(const Engine& engine, std::span<const system::Excitation> excitations) const;
  bool solve_with(Engine& engine, std::span<const system::Excitation> excitations, SteadyStart start,
                  std::span<SteadyResponse> responses);
  void start_states(Engine& engine, std::span<const system::Excitation> excitations, SteadyStart start,
                    LaneArray& states) const;
  /// Completes the errors of responses by that of the step, which are also written times N^p (< 0: not known).
  void estimate(Engine& engine, std::span<const system::Excitation> excitations, SteadyStart start, int steps,
                const LaneArray& states, std::span<SteadyResponse> responses, std::span<double> step_errors) const;
  /// Errors of the step, times N^p, by comparison with the responses found with other steps. Raises those given.
  bool compare(Engine& engine, std::span<const system::Excitation> excitations, SteadyStart start, int steps,
               int other_steps, const LaneArray& states, std::span<const SteadyResponse> responses,
               std::span<double> errors) const;
  /// Responses with a given number of steps, from `states`, which become the starts of their periods. `is_full`: with
  /// all that was asked for, else amplitudes alone.
  void find(Engine& engine, std::span<const system::Excitation> excitations, SteadyStart start, int steps, bool is_full,
            LaneArray& states, std::span<SteadyResponse> responses) const;
  bool release_offsets(const Engine& engine, Index lane, const system::Excitation& excitation,
                       const SteadyResponse& response, LaneArray& states) const;

  /// Whether the loads carry a motion off for ever, whatever the march took it for.
  bool is_unbounded(const system::Excitation& excitation, SteadyStatus found);

  const system::LocallyNonlinear& system_;
  TimeMarchingOptions options_;
  SteadyRequest request_, amplitudes_;
  double longest_step_;
  double resolved_frequency_;  ///< up to which the steps that are chosen resolve the modes [rad/s]
  int order_;
  bool transitions_rule_;  ///< the error comes from transitions between the samples more than from the method
  Vector slider_stiffness_;
  Matrix unseen_;                               // rigid motions that no contact sees [n x any]
  Matrix free_;                                 ///< motions of a structure that floats [n x any]
  std::optional<UndampedResonance> resonance_;  ///< once asked for
  std::unique_ptr<Engine> lanes_, steppers_;    // lanes_ may be null
  const Engine* last_ = nullptr;
  int steps_ = 0;
};

}  // namespace rubato::steady
