#include <rubato/integrate/constrained/first_zero.hpp>

#include <algorithm>

namespace rubato::integrate {
namespace {

/// Cubic through values and slopes at both ends of [0, 1].
double cubic(double x, double y0, double slope0, double y1, double slope1) {
  const double rest = 1.0 - x;
  return rest * rest * ((1.0 + 2.0 * x) * y0 + x * slope0) + x * x * ((1.0 + 2.0 * rest) * y1 - rest * slope1);
}

}  // namespace

FirstZero first_zero(double least, double y0, double slope0, double y1, double slope1) {
  constexpr int parts = 8;
  FirstZero zero;
  double low = least, at_low = cubic(least, y0, slope0, y1, slope1), most = 0.0;
  for (int part = 1; part <= parts; ++part) {
    const double high = std::max(least, static_cast<double>(part) / parts);
    const double at_high = part == parts ? y1 : cubic(high, y0, slope0, y1, slope1);
    if (at_high < 0.0 && at_high < at_low && zero.at > 1.0) {
      double left = low, right = high;
      for (int k = 0; k < 50 && at_low > 0.0; ++k) {
        const double middle = 0.5 * (left + right);
        (cubic(middle, y0, slope0, y1, slope1) > 0.0 ? left : right) = middle;
      }
      zero.at = std::min(at_low > 0.0 ? right : low, 1.0);
    }
    if (at_high < most) {
      most = at_high;
      zero.seen = high;
    }
    low = high;
    at_low = at_high;
  }
  if (y1 < 0.0) zero.seen = 1.0;
  return zero;
}

}  // namespace rubato::integrate
