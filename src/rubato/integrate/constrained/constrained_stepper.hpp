#pragma once

#include <rubato/integrate/method.hpp>
#include <rubato/integrate/stepper.hpp>
#include <rubato/system/constrained_system.hpp>

#include <memory>

namespace rubato::integrate {

/// How far Newton's method goes in a step.
struct NewtonPlan {
  double tolerance = 1e-10;  ///< of the error left in the positions, in the mass norm over `reference` [-]
  double reference = 0.0;    ///< l [m sqrt(kg)]; 0: the system's, or of one metre and radian in every coordinate
  int most_iterations = 20;
  /// Removes G v + dg/dt from the velocities at the end of each step, with the factors at hand. Constraints on
  /// positions leave it of second order; a step much shorter than the last turns what is left into accelerations of its
  /// size over the step, which an error per unit of time never accepts.
  bool projects_velocities = false;
  /// Ends no step in a configuration in which more rows repeat each other than at the start (bars in line): positions
  /// are hardly held there, by the square of the angle over the share E, and accelerations of a step take what is left.
  /// Such a step is singular; one of another length ends before it or beyond.
  bool avoids_singular_ends = false;
};

/// The generalized-alpha step of a system with constraints on positions (index 3; Arnold and Bruels 2007; on
/// rotations Bruels, Cardona and Arnold 2012):
///
///   M a1 + f(q1, v1, t1) + G(q1)^T multiplier1 = 0,   g(q1) = 0
///   (1 - alpha_m) A1 + alpha_m A0 = (1 - alpha_f) a1 + alpha_f a0
///   dq = h v0 + h^2 ((1/2 - beta) A0 + beta A1),  q1 = q0 retracted by dq,  v1 = v0 + h ((1 - gamma) A0 + gamma A1)
///
/// a is the acceleration of equilibrium at the ends, A the auxiliary one. Newton's unknowns are positions and
/// multipliers times beta h^2 (1 - alpha_f)/(1 - alpha_m): rows of M and G are then of one size whatever the step
/// (Bottasso, Dopico and Trainelli 2008). Factors are kept while each iteration removes nine tenths of the error.
/// Friction that follows a reaction is part of the equations: mu times the multipliers of the same instant, with their
/// slopes beside G^T. Phases of locks and of friction stay as they are.
///
/// Throws InvalidInput for a method of another family and, with constraints, for one that does not damp: of
/// spectral radius 1 at infinite frequency the multipliers oscillate without end. With velocities projected such a
/// method serves as long as nothing grows (beta >= 1/4).
/// @param force  accept such a method nevertheless
std::unique_ptr<Stepper> make_stepper(const Method& method, const system::ConstrainedSystem& system,
                                      const NewtonPlan& plan = {}, bool force = false);

/// The same with equations that are lent, as a march lends them to all that looks at its states between the steps.
std::unique_ptr<Stepper> make_stepper(const Method& method, system::ConstrainedEquations& equations,
                                      const NewtonPlan& plan = {}, bool force = false);

/// Throws what make_stepper() throws, and makes nothing.
void check_stepper(const Method& method, const system::ConstrainedSystem& system, const NewtonPlan& plan = {},
                   bool force = false);

/// The largest root of the step's characteristic polynomial for omega h -> infinity.
/// @param projects_velocities  of a step that removes the velocity that is left of such a motion (a constraint) at its
///                             end
double spectral_radius_at_infinity(const GeneralizedAlpha& method, bool projects_velocities = false);

}  // namespace rubato::integrate
