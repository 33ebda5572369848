#pragma once

#include <rubato/numerics/butcher_tableau.hpp>

#include <string>
#include <variant>

namespace rubato::integrate {

/// Explicit Runge-Kutta step on (q, v).
struct RungeKutta {
  numerics::ButcherTableau tableau;
};

/// The generalized-alpha step (Chung and Hulbert 1993, with the forces of both ends weighted, Arnold and Bruels 2007):
///
///   (1 - alpha_m) M A1 + alpha_m M A0 + (1 - alpha_f) F1 + alpha_f F0 = 0,   F = C v + K q + B fc - f(t)
///   q1 = q0 + h v0 + h^2 ((1/2 - beta) A0 + beta A1),   v1 = v0 + h ((1 - gamma) A0 + gamma A1)
///
/// Newmark: alpha_m = alpha_f = 0. HHT: alpha_m = 0, alpha_f = -alpha. WBZ: alpha_f = 0.
struct GeneralizedAlpha {
  double alpha_m = 0.0, alpha_f = 0.0, beta = 0.25, gamma = 0.5;
};

/// Linear acceleration over theta h, evaluated at h (Wilson, Farhoomand and Bathe 1973).
struct WilsonTheta {
  double theta = 1.4;
};

/// The exact linear propagator over a step, slider forces linear in time.
struct Exponential {};

/// The event-driven flow: no step.
struct Exact {};

struct Method {
  std::string name;
  std::variant<RungeKutta, GeneralizedAlpha, WilsonTheta, Exponential, Exact> formula;
};

}  // namespace rubato::integrate
