#pragma once

#include <rubato/system/excitation.hpp>

#include <span>

namespace rubato::steady {

/// Half of the peak to peak of Re(sum of coefficient_j exp(i order_j theta)) over a turn of theta: the largest and the
/// least value are refined from samples by Newton, to round-off.
/// @param orders  rising, >= 1   @param coefficients  of each order
double half_peak_to_peak(std::span<const int> orders, std::span<const std::complex<double>> coefficients);

}  // namespace rubato::steady
