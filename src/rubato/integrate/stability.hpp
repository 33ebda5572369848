#pragma once

#include <rubato/integrate/method.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <optional>
#include <string>

namespace rubato::integrate {

/// What a method makes of one free mode q'' + 2 zeta omega q' + omega^2 q = 0 in a step. The eigenvalues are those of
/// the step itself, run on unit states: there is no second formula that could differ from it.
struct ModeResponse {
  double spectral_radius = 0.0;  ///< largest |eigenvalue| of the step
  /// (numerical period - true period) / true period; nothing where the numerical solution does not oscillate
  std::optional<double> period_elongation;
  /// damping ratio that the method adds (or takes); nothing where the numerical solution does not oscillate
  std::optional<double> numerical_damping;
};

/// @param omega_h  angular frequency times step, > 0 [-]   @param zeta  damping ratio >= 0 [-]
ModeResponse mode_response(const Method& method, double omega_h, double zeta = 0.0);

/// Largest omega h at which an undamped mode does not grow: infinity if unconditional, 0 if none. Closed forms for
/// Newmark (Hughes 1987, 9.1.2) and for Runge-Kutta (|R(i y)| <= 1 along the imaginary axis), by bisection for the
/// rest.
double stability_limit(const Method& method);

/// Spectral radius of an undamped mode as omega h goes to infinity; infinity where it grows without bound.
double spectral_radius_at_infinity(const Method& method);

/// Largest step at which no mode of a model grows, with the mode that sets it.
struct ModelStability {
  double step = 0.0;               ///< [s]; infinity if unconditional
  double angular_frequency = 0.0;  ///< of the mode that sets it [rad/s]
  double damping_ratio = 0.0;      ///< of that mode [-]
  Index mode = 0;                  ///< its number from 1, by rising frequency
  std::string largest_coordinate;  ///< where that mode moves most
};

/// For the modes with all sliders stuck, each with the damping phi^T C phi of its own. Where C couples them, explicit
/// Runge-Kutta is judged by the eigenvalues of the coupled structure (up to 200 coordinates); the limit of the other
/// methods does not fall by damping.
/// Up to 1,000 coordinates all modes are looked at, beyond the highest one only.
ModelStability stability_of(const Method& method, const system::LocallyNonlinear& system);

}  // namespace rubato::integrate
