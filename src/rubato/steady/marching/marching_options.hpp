#pragma once

#include <rubato/integrate/catalogue.hpp>
#include <rubato/system/locally_nonlinear.hpp>

namespace rubato::steady {

struct TimeMarchingOptions {
  /// Any method of the catalogue with a step.
  integrate::Method method = integrate::make_method("generalized_alpha", {{"rho_inf", 0.9}});
  int steps_per_period = 0;  ///< 0: chosen so that the error of the amplitude stays below the tolerance
  double tolerance = 1e-3;   ///< of the amplitude, against the largest observed [-]
  double periodicity = 0.0;  ///< of the states one period apart, relative [-]; 0: a hundredth of the tolerance
  int max_periods = 1000;    ///< of one march
  int max_steps = 1 << 15;   ///< in a period, where they are chosen
  bool extrapolates = true;  ///< see OrbitExtrapolation; never used with SteadyStart::rest
  bool uses_lanes = true;    ///< small models in lanes (see make_lane_map), where the method allows
};

/// Throws InvalidInput for options out of range, for the method `exact`, and for one that the system is too large for.
void check_options(const TimeMarchingOptions& options, const system::LocallyNonlinear& system);

/// The longest step that a march takes: nine tenths of the stable one (of the modes with all sliders stuck), infinity
/// for unconditional methods. Throws InvalidInput where no step is stable.
double longest_step(const integrate::Method& method, const system::LocallyNonlinear& system);

/// The highest natural frequency with all sliders stuck [rad/s]; infinity for a large structure, where nobody asks.
double highest_frequency(const system::LocallyNonlinear& system);

/// Order in which amplitudes converge: that of the method, but no more than 2, because transitions of sliders fall
/// between the samples.
int amplitude_order(const integrate::Method& method);

}  // namespace rubato::steady
