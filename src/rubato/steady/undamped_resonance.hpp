#pragma once

#include <rubato/steady/dynamic_stiffness.hpp>
#include <rubato/steady/steady_solver.hpp>

#include <optional>

namespace rubato::steady {

/// Tells whether loads meet a resonance without damping of the structure without its sliders, and give it more than
/// friction can take. All routes to a steady response ask here before they say `unbounded`.
///
/// A motion phi resonates at w where (K - w^2 M) phi = 0 and C phi = 0, to round-off (DynamicStiffness::free_motions).
/// With the amplitude a the load gives it pi a |phi^T f| a period, and friction takes 4 a sum_j |b_j^T phi| limit_j at
/// most, b_j^T x the displacement of slider j. Where the load gives more the motion grows for ever. At w = 0 the load
/// must exceed what the sliders hold, |phi^T f| > sum_j |b_j^T phi| limit_j. A workspace: one a thread.
class UndampedResonance {
 public:
  /// The system must outlive it.
  explicit UndampedResonance(const system::LocallyNonlinear& system);

  /// @param load    [n] [N], at one frequency
  /// @param limits  of the sliders [m] [N]
  bool is_driven_beyond_friction(double angular_frequency, const ComplexVector& load, const Vector& limits);
  /// Whether a constant load carries the structure off for ever where sliders are none: no spring resists it, though a
  /// damper may bound the speed.
  /// @param load  [n] [N]
  bool is_carried_off(const Vector& load);
  /// Whether any of the loads is.
  bool is_driven_beyond_friction(const system::Excitation& excitation);

 private:
  Matrix motions_at(double angular_frequency);
  const Matrix& rigid_motions();

  const system::LocallyNonlinear& system_;
  DynamicStiffness stiffness_;
  std::optional<Matrix> rigid_;    ///< motions that no spring resists, once asked for
  std::optional<Matrix> at_rest_;  ///< those that no damper resists either
};

/// Whether a load has a part in a motion that round-off does not explain.
bool drives(const Vector& motion, const ComplexVector& load);

/// Makes a response infinite: its status is `unbounded`, amplitudes are infinite, phases and works no numbers.
void make_unbounded(const SteadyRequest& request, Index sliders, SteadyResponse& response);

}  // namespace rubato::steady
