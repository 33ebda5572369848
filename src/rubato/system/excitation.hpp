#pragma once

#include <rubato/core/complex.hpp>
#include <rubato/core/types.hpp>
#include <rubato/system/locally_nonlinear.hpp>

#include <optional>
#include <vector>

namespace rubato::system {

/// Re(amplitude exp(i order omega t)), with omega the fundamental angular frequency.
struct LoadHarmonic {
  int order = 1;            ///< >= 1
  ComplexVector amplitude;  ///< [n] [N]
};

/// What drives a structure with sliders at one point of a frequency response. All of it may change from point to point
/// while the structure (M, C, K, where the sliders are and their stiffness) stays:
///
///   f(t) = constant + sum of Re(amplitude_k exp(i k omega t)),   |fc_j| <= limit_j
struct Excitation {
  double angular_frequency = 0.0;       ///< fundamental omega of all loads [rad/s], > 0: the period is 2 pi / omega
  Vector constant;                      ///< static loads [n] [N]
  std::vector<LoadHarmonic> harmonics;  ///< rising orders, each once
  Vector limits;                        ///< mu N of each slider [m] [N], >= 0

  double period() const;  ///< [s]
  /// The loads of half a period later are the opposite ones: nothing static, odd harmonics only.
  bool is_half_wave_symmetric() const;
};

/// The largest frequency of which all the given ones (> 0) are multiples, up to its 64th, to 1e-10 relative. Nothing
/// where there is none: the loads have no common period.
std::optional<double> common_fundamental(const std::vector<double>& frequencies);

/// The same; throws InvalidInput where there is none.
double fundamental_of(const std::vector<double>& frequencies);

/// The order of a frequency over a fundamental, or 0 where it is no multiple up to the 64th.
int order_over(double frequency, double fundamental);

/// The excitation of a system: its loads with their common period, and the limits of its sliders. A load of zero
/// frequency is static. Throws InvalidInput where there is no harmonic load, for loads that are no harmonic functions
/// of time, and for frequencies without a common period (up to the 64th harmonic of a fundamental).
Excitation excitation_of(const system::LocallyNonlinear& system);

}  // namespace rubato::system
