#pragma once

#include <rubato/steady/dynamic_stiffness.hpp>
#include <rubato/steady/linear/modal_stiffness.hpp>
#include <rubato/steady/steady_solver.hpp>

namespace rubato::steady {

/// By which route a sweep of linear responses goes.
struct LinearSweep {
  /// Expected number of frequencies. From 20 on, a structure beyond 3,000 coordinates goes by its modes with residual
  /// vectors (ModalStiffness) where its factors fill in: a factorisation costs more than a few dozen substitutions
  /// then.
  Index points = 1;
  double highest = 0.0;  ///< largest frequency times the highest order of the loads [rad/s]; 0: unknown, no modes
  double tolerance =
      1e-9;  ///< of the modes: relative error of the largest displacement; beyond it a point goes directly
};

/// The steady response of a structure whose sliders are springs (stuck) or removed (free): one solution of the dynamic
/// stiffness a harmonic,
///
///   (K - (k omega)^2 M + i k omega C) x_k = f_k,   K x_0 = constant
///
/// with K of the stuck sliders included; other laws enter with their slopes at rest. With all sliders stuck or none
/// these are the two limits between which friction works. Limits and start of an excitation mean nothing here: a stuck
/// slider keeps offset zero.
///
/// A resonance without damping (within the round-off of the matrices) has the status `unbounded`: amplitudes and
/// harmonics of what resonates are infinite, phases are no numbers. So is a static load on a body that nothing holds.
/// Where dampers bound the motion and round-off of stiff parts hides it all the same, the status is `not_converged`.
class LinearResponse final : public SteadySolver {
 public:
  /// @param stuck  of each slider [m]
  LinearResponse(const system::LocallyNonlinear& system, StuckSliders stuck, SteadyRequest request,
                 const LinearSweep& sweep = {});

  void solve(const system::Excitation& excitation, SteadyStart start, SteadyResponse& response) override;
  Waveform waveform(int points) const override;
  void forget() override;

  /// x_0 [n] and x_k of each order of the loads, at the point solved last.
  const Vector& mean() const { return mean_; }
  const std::vector<system::LoadHarmonic>& harmonics() const { return harmonics_; }
  /// Whether the sweep goes by modes.
  bool goes_by_modes() const { return modal_.has_value(); }

 private:
  /// How far a solution is determined.
  struct Doubt {
    ComplexVector uncertainty;  // [n]; empty: exact
    double least = 0.0;         // smaller uncertainties are no part of a resonance
    bool is_resonant = false;
    bool is_lost = false;  // damped, and yet round-off: stiff parts hide the digits of the soft ones
    double of(const SteadyRequest::Observed& observed) const;
    bool is_infinite(const SteadyRequest::Observed& observed, double value) const;
  };
  double solve_order(int order, const ComplexVector& force, ComplexVector& x, Doubt& doubt);
  void observe(const system::Excitation& excitation, SteadyResponse& response) const;

  system::LocallyNonlinear system_;
  StuckSliders stuck_;
  SteadyRequest request_;
  DynamicStiffness stiffness_;
  std::optional<ModalStiffness> modal_;
  double omega_ = 0.0;
  Vector mean_;
  std::vector<system::LoadHarmonic> harmonics_;
  Doubt mean_doubt_;
  std::vector<Doubt> doubts_;  // of each harmonic
};

/// A limit: all sliders stuck, or all removed; other laws as with_linear_laws() has them.
LinearResponse limit(const system::LocallyNonlinear& system, bool stuck, SteadyRequest request,
                     const LinearSweep& sweep = {});
LinearResponse free_limit(const system::LocallyNonlinear& system, SteadyRequest request, const LinearSweep& sweep = {});
LinearResponse stuck_limit(const system::LocallyNonlinear& system, SteadyRequest request,
                           const LinearSweep& sweep = {});

}  // namespace rubato::steady
