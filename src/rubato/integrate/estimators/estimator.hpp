#pragma once

#include <rubato/integrate/method.hpp>
#include <rubato/integrate/stepper.hpp>
#include <rubato/numerics/formula_swings.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <memory>
#include <string>
#include <variant>
#include <vector>

// An estimator measures the error of a try and divides it by the tolerance. It decides nothing.
namespace rubato::integrate {

class ErrorSpace;

class Estimator {
 public:
  virtual ~Estimator() = default;

  /// Before the first step, and again where a load jumps: the acceleration in `start.auxiliary_acceleration` is that of
  /// equilibrium after the jump.
  virtual void start(const system::State& start) = 0;

  /// The error of a try from `from` to `to` over the tolerance; `from.auxiliary_acceleration` is prepared for steps of
  /// the length h. Nothing that it finds is remembered unless accept() follows.
  virtual double error(const system::State& from, const system::State& to, double h) = 0;

  /// The last try was accepted; `to` is where it led.
  virtual void accept(const system::State& to) = 0;

  /// The motion has a kink here (a slider has changed its state, a load its slope): differences across it mean nothing.
  virtual void forget() = 0;

  /// What error() divides by [-].
  virtual double tolerance() const { return 1e-3; }

  /// The error is proportional to h to this power on smooth problems.
  virtual int exponent() const = 0;

  /// A first step that should meet about half the tolerance, from the state given to start() [s]; infinity where
  /// nothing moves.
  virtual double first_step() const = 0;

  /// The size of the motion by which errors are measured now [m sqrt(kg)]; 0: another measure.
  virtual double size() const { return 0.0; }

  /// Solves that the estimator itself makes for one try, beside the stepper's.
  virtual int solves_a_try() const { return 0; }
  virtual int factorisations() const { return 0; }
};

/// The paper's estimator (Cardona and Cassano 1991, eq. 32), for methods that carry an acceleration:
///
///   e = h^2 / (6 K l) sqrt(da^T M da),   da = a1 - a0,   K = eps(0.6)
///   eps(Omega) = (1 + alpha) Omega^3 sqrt(1 + Omega^2/4) / (3 pi (1 + (1 + alpha) beta Omega^2))
///
/// TOL is the share of the response, relative to l, that modes with omega h > 0.6 may carry; the error of the solution
/// that it leaves depends on the problem. 1 + alpha is 1 - alpha_f; Wilson-theta counts as linear acceleration.
struct InertiaJump {
  double tolerance = 1e-3;
  double reference = 0.0;   ///< l [m sqrt(kg)]; 0: |q0|_M (eq. 30), which must then not vanish
  bool as_printed = false;  ///< eq. (13) with the misprint (1/2 - beta)^2 Omega^2 under the root
};

/// The leading local errors of the alpha family, per unit of time:
///
///   dq = (beta - 1/6 + d/2) h^3 q''',   dv = (gamma - 1/2 + d) h^2 q''' + c h^3 q'''',   d = alpha_m - alpha_f
///   c = d^2/2 + gamma d + gamma/2 + kappa - 1/6,   kappa = -d (1 - alpha_m - alpha_f)/2
///   e = sqrt(|dq|_M^2 + |dv|_M^2/omega^2) T / (h s)
///
/// and not less than C h^2 |q'''| T/(sqrt(2) s), with q''' and q'''' from differences of the auxiliary acceleration,
/// the size s of the response (the largest |q|_M so far, what its acceleration promises, or a tenth of what the loads
/// of the march do), the frequency omega = |q''''|/|q'''| averaged over about a period, and T the time over which
/// errors of q''' add up (DampingMemory).
///
/// These are errors of the phase of a motion. What is faster than omega_c = (2/(C h^2 T))^(1/3), with C h^2 omega^3 the
/// phase lost in a second, is out of phase before the end, and then errs by twice its amplitude 2 |q'''|/omega^3
/// however long it lasts. So methods of second order count the part x of q''' that is slower than omega_c (SlowPart),
/// and the whole of q''' for the step alone (1 for T/h), which sees an event before it has lasted.
///
/// Methods of first order count all of q''', and not less than what their errors of velocity (gamma - 1/2 + d) h^2 q'''
/// leave of the displacement in a free motion, without a frequency: from q'' less its mean.
///
/// TOL is the global error relative to s, on linear problems within a factor of ten.
struct LocalError {
  double tolerance = 1e-3;
};

/// The difference of two solutions of the same step. Explicit pairs: per step, since they carry on with the better
/// solution; Wilson-theta: against linear acceleration from the same state, per unit of time. Both are calibrated on
/// linear modes, so that TOL means the same as in LocalError.
struct Embedded {
  double tolerance = 1e-3;
};

using EstimatorKind = std::variant<InertiaJump, LocalError, Embedded>;

/// Binds an estimator to a method on a system; both and the stepper must outlive it.
/// @param duration  of the march [s]: errors per unit of time are shares of it
/// @param bounds    how the loads swing (StepPlan), for the size of what is to come
/// Throws InvalidInput, saying which would do, where the method lacks what the estimator reads, for a tolerance out of
/// its range, and for a reference value that is not positive.
std::unique_ptr<Estimator> make_estimator(const EstimatorKind& kind, const Method& method,
                                          const system::LocallyNonlinear& system, Stepper& stepper, double duration,
                                          const std::vector<numerics::StepBound>& bounds = {});

/// The same of other equations, for methods of the alpha family: the estimator keeps the space.
/// @param start  where the march starts: what `reference` = 0 measures by
std::unique_ptr<Estimator> make_estimator(const EstimatorKind& kind, const GeneralizedAlpha& method,
                                          std::unique_ptr<ErrorSpace> space, const system::State& start,
                                          double duration);

/// Whether the leading error of a step is of third order: inertia_jump measures no other. Wilson-theta and methods that
/// carry no acceleration: true, others refuse them.
bool is_of_second_order(const Method& method);

/// The estimator of a method unless another is asked for: `embedded` for pairs, and for Wilson-theta where no stop is,
/// else `local_error`.
EstimatorKind default_estimator(const Method& method, double tolerance, bool has_stops);

/// "inertia_jump", "local_error" or "embedded"
std::string name_of(const EstimatorKind& kind);

}  // namespace rubato::integrate
