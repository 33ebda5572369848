#pragma once

#include <rubato/core/types.hpp>

#include <span>

namespace rubato::integrate {

/// sum_k coefficients[k] s^k
double polynomial(std::span<const double> coefficients, double s);
/// Its derivative with respect to s.
double polynomial_slope(std::span<const double> coefficients, double s);

/// The first s in (0, length] at which a polynomial that is not negative just after 0 becomes negative, to round-off; a
/// negative number if there is none. Crossings that begin and end between two samples are found by the minimum between
/// them; a polynomial that starts at zero is taken as rising from there.
/// @param length  such that the polynomial turns at most once in an eighth of it
double first_crossing(std::span<const double> coefficients, double length);

}  // namespace rubato::integrate
