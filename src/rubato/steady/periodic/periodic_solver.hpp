#pragma once

#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/integrate/exact/flow_derivative.hpp>
#include <rubato/steady/periodic/orbit.hpp>
#include <rubato/steady/steady_solver.hpp>

#include <Eigen/LU>

#include <vector>

namespace rubato::steady {

struct PeriodicOptions {
  double tolerance = 1e-12;   ///< of the residual: |y(T) - y(0)| over |y(0)|, see PeriodicSolver
  int most_iterations = 200;  ///< of Newton, from each start that is tried
  int most_periods = 4000;    ///< marched where Newton alone does not come nearer, likewise
};

/// The periodic orbit itself, by shooting: Newton's method on
///
///   P(y) - y = 0,   y = (q, v, fc) at t = 0,
///
/// with P the exact flow over a period and its exact derivative (ExactFlow, FlowDerivative); over half a period, with
/// P(y) + y = 0, where loads and start are half-wave symmetric. Points continue from those before by extrapolation in
/// the frequency; the first starts from one harmonic with equivalent stiffness and damping of the sliders, and so does
/// a point to which those before do not lead. Where Newton does not come nearer, the flow itself is followed for some
/// periods: with damping it always does.
///
/// A structure that sliders alone hold may walk: P(y) = y + (phi, 0, 0) with phi a motion that no spring resists and
/// every slider that sees it slips along. Newton's steps leave such motions in place and the residual does not count
/// them, so that a walk is found as an orbit is. No other motion is steady then: friction, damping and springs never
/// part two motions, and the walk goes on. A structure that floats, some motions of which nothing
/// resists, does not drift and lies on average where it was installed.
///
/// A slider that never slips leaves its offset fc - kT u free: it is the one that SteadyStart asks for, or the nearest
/// with which it does not slip.
///
/// The residual is the larger of |(dq, dv/omega)| over |(q, v/omega)| in the norm of the mass, and of |dfc| over the
/// limit. The error is Newton's next correction.
class PeriodicSolver final : public SteadySolver {
 public:
  /// Throws InvalidInput for more than 300 coordinates. The system must outlive the solver; its loads do not matter.
  PeriodicSolver(const system::LocallyNonlinear& system, SteadyRequest request, PeriodicOptions options = {});

  /// Throws InvalidInput where a period is too long beside the fastest motion of the structure for its pieces to be
  /// kept.
  void solve(const system::Excitation& excitation, SteadyStart start, SteadyResponse& response) override;
  Waveform waveform(int points) const override;
  void forget() override;

  /// The state at t = 0 of the last orbit.
  const system::State& state() const { return start_; }

 private:
  class Recorder;
  struct Shooting;
  struct Known {
    double angular_frequency = 0.0;
    long serial = 0;
    Vector limits, y;
  };
  void take_start(const system::Excitation& excitation, SteadyStart start);
  void guess(const system::Excitation& excitation);
  void predict(const system::Excitation& excitation);
  void march_from_rest(const system::Excitation& excitation);
  bool march(const system::Excitation& excitation, int periods);
  bool pass(const system::Excitation& excitation);
  double residual(const system::Excitation& excitation);
  void factorise();
  Matrix open_motions() const;
  void hold_rigid_motions();
  void place_free_motions(const system::Excitation& excitation);
  bool is_pushed_away(const system::Excitation& excitation) const;
  Vector along_unseen(const Vector& position) const;
  double drift(const system::Excitation& excitation) const;
  void measure(const system::Excitation& excitation, SteadyResponse& response);
  double most_pieces() const;
  void require_memory(const system::Excitation& excitation) const;
  bool correct();
  bool iterate(const system::Excitation& excitation, SteadyResponse& response);
  bool iterate_from_elsewhere(const system::Excitation& excitation, SteadyResponse& response);
  bool move_offsets(const system::Excitation& excitation);
  double size_of(const system::Excitation& excitation, const Vector& y) const;
  double observed_size(const Vector& y) const;
  void put(const Vector& y, const system::Excitation& excitation);
  void remember(const system::Excitation& excitation);
  void forget_others(const system::Excitation& excitation);
  double scaled_size(const Vector& y, double omega) const;

  const system::LocallyNonlinear& system_;
  SteadyRequest request_;
  PeriodicOptions options_;
  Index n_, m_;
  integrate::ExactFlow flow_;
  integrate::FlowDerivative derivative_;
  Orbit orbit_;
  system::State start_, end_;                  // of a pass
  Vector y_, difference_, correction_, best_;  // (q, v, fc) at the start; P(y) - y; Newton's step from best_
  Vector right_side_;
  Vector wanted_offset_, centre_;  // of sliders that never slip; of all, at the last point
  Matrix matrix_;
  double fastest_ = 0.0;  // natural frequency without sliders [rad/s]
  Vector drift_;          // part of P(y) - y along open motions [n] [m]; the difference is without it
  Matrix rigid_;          // motions without stiffness but for the sliders, phi^T M phi = 1 [n x r]
  Matrix unseen_;         // of these, those that no slider and no stop sees [n x any]
  Matrix free_;           // of these, in the same way, those that no slider sees and no dashpot resists [n x any]
  Eigen::PartialPivLU<Matrix> factors_;
  bool factors_are_of_orbit_ = false;
  bool near_factors_ = false;        // the last pass was made after a full step with these factors
  std::vector<Known> known_;         // points before, from which the next is extrapolated
  std::vector<Vector> differences_;  // divided differences of theirs
  long serial_ = 0;
  bool half_ = false;
  system::Excitation last_;
};

}  // namespace rubato::steady
