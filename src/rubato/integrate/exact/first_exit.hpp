#pragma once

#include <span>

namespace rubato::integrate {

/// The first s in (0, length] at which a polynomial sum_k c_k s^k leaves the band from lower to upper, to round-off; a
/// negative number if it does not. Excursions that begin and end between two samples are found by the extremum between
/// them. A polynomial that starts on an edge of the band, or within round-off beyond it, is taken as moving inward.
/// @param coefficients  at most 32
/// @param length        such that the polynomial turns at most once in an eighth of it
double first_exit(std::span<const double> coefficients, double lower, double upper, double length);

/// Widens [low, high] to the values that a polynomial takes over [0, length]; same conditions.
void include_range(std::span<const double> coefficients, double length, double& low, double& high);

/// sum_k c_k s^k
double polynomial(std::span<const double> coefficients, double s);

}  // namespace rubato::integrate
