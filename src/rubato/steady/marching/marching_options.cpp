#include <rubato/steady/marching/marching_options.hpp>

#include <rubato/core/error.hpp>
#include <rubato/integrate/stability.hpp>
#include <rubato/integrate/stepper.hpp>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::steady {
namespace {

// Chung and Hulbert 1993, eq. 13: saves running the step on a ladder of frequencies.
bool is_known_to_be_stable(const integrate::Method& method) {
  const auto* alpha = std::get_if<integrate::GeneralizedAlpha>(&method.formula);
  return alpha && alpha->alpha_m <= alpha->alpha_f && alpha->alpha_f <= 0.5 && amplitude_order(method) == 2 &&
         alpha->beta >= 0.25 + 0.5 * (alpha->alpha_f - alpha->alpha_m);
}

}  // namespace

void check_options(const TimeMarchingOptions& options, const system::LocallyNonlinear& system) {
  if (std::holds_alternative<integrate::Exact>(options.method.formula))
    throw InvalidInput(
        "solver = \"time_marching\" needs a method with a step; \"exact\" has none: take another one, or solver = "
        "\"periodic\", which uses the exact flow");
  if (!(options.tolerance > 0.0 && options.tolerance < 1.0))
    throw InvalidInput(fmt::format("tolerance must lie between 0 and 1, got {}", options.tolerance));
  if (!(options.periodicity >= 0.0 && options.periodicity < 1.0))
    throw InvalidInput(fmt::format("periodicity must lie in [0, 1), got {}", options.periodicity));
  if (options.steps_per_period < 0)
    throw InvalidInput(fmt::format("steps_per_period must not be negative, got {}", options.steps_per_period));
  if (options.max_periods < 1)
    throw InvalidInput(fmt::format("max_periods must be at least 1, got {}", options.max_periods));
  if (std::holds_alternative<integrate::Exponential>(options.method.formula))
    integrate::make_stepper(options.method, system);
}

double longest_step(const integrate::Method& method, const system::LocallyNonlinear& system) {
  if (is_known_to_be_stable(method)) return std::numeric_limits<double>::infinity();
  const integrate::ModelStability stability = integrate::stability_of(method, system);
  if (!(stability.step > 0.0))
    throw InvalidInput(fmt::format(
        "the method {} has no stable step for this model (mode {}, {:.6g} rad/s, damping ratio {:.3g}): take an "
        "implicit one, such as generalized_alpha",
        method.name, stability.mode, stability.angular_frequency, stability.damping_ratio));
  constexpr double margin = 0.9;
  return margin * stability.step;
}

double highest_frequency(const system::LocallyNonlinear& system) {
  constexpr Index largest = 200;
  if (system.size() > largest) return std::numeric_limits<double>::infinity();
  const Vector squares = Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(Matrix(system.stuck_stiffness()),
                                                                          Matrix(system.mass()), Eigen::EigenvaluesOnly)
                             .eigenvalues();
  return std::sqrt(std::max(0.0, squares[squares.size() - 1]));
}

int amplitude_order(const integrate::Method& method) {
  if (const auto* alpha = std::get_if<integrate::GeneralizedAlpha>(&method.formula))
    return std::abs(alpha->gamma - (0.5 - alpha->alpha_m + alpha->alpha_f)) < 1e-9 ? 2 : 1;
  if (const auto* explicit_method = std::get_if<integrate::RungeKutta>(&method.formula))
    return std::clamp(explicit_method->tableau.order, 1, 2);
  return 2;
}

}  // namespace rubato::steady
