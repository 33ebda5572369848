#include <rubato/integrate/exact/first_crossing.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace rubato::integrate {
namespace {

constexpr std::size_t samples = 8;

// Newton inside a bracket f(low) >= 0 > f(high), bisection where it leaves it.
double refine(std::span<const double> c, double low, double high) {
  double s = 0.5 * (low + high);
  for (int i = 0; i < 100; ++i) {
    const double value = polynomial(c, s);
    (value < 0.0 ? high : low) = s;
    const double slope = polynomial_slope(c, s);
    double next = slope != 0.0 ? s - value / slope : low;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == s || high - low <= 1e-16 * high) break;
    s = next;
  }
  return s;
}

// Where the slope, negative at low and positive at high, vanishes.
double lowest_point(std::span<const double> c, double low, double high) {
  for (int i = 0; i < 60 && high - low > 1e-16 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (polynomial_slope(c, middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double polynomial(std::span<const double> c, double s) {
  double value = 0.0;
  for (std::size_t k = c.size(); k-- > 0;) value = value * s + c[k];
  return value;
}

double polynomial_slope(std::span<const double> c, double s) {
  double value = 0.0;
  for (std::size_t k = c.size(); k-- > 1;) value = value * s + static_cast<double>(k) * c[k];
  return value;
}

double first_crossing(std::span<const double> c, double length) {
  // What the falling terms can take at most; and where terms are below round-off.
  double falling = 0.0, size = 0.0, power = 1.0;
  std::size_t terms = 1;
  for (std::size_t k = 0; k < c.size(); ++k, power *= length) {
    const double term = c[k] * power;
    if (k > 0 && term < 0.0) falling -= term;
    size = std::max(size, std::abs(term));
    if (std::abs(term) > 1e-18 * size) terms = k + 1;
  }
  if (c[0] > falling) return -1.0;
  c = c.first(terms);
  // All samples side by side: the recurrences of one would wait for each other.
  std::array<double, samples> at, value{}, slope{};
  for (std::size_t i = 0; i < samples; ++i) at[i] = length * static_cast<double>(i + 1) / samples;
  for (std::size_t k = terms; k-- > 0;)
    for (std::size_t i = 0; i < samples; ++i) {
      slope[i] = slope[i] * at[i] + value[i];
      value[i] = value[i] * at[i] + c[k];
    }
  double a = 0.0, slope_a = terms > 1 ? c[1] : 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    const double b = at[i], value_b = value[i], slope_b = slope[i];
    double high = -1.0;
    if (value_b < 0.0) {
      high = b;
    } else if (slope_a < 0.0 && slope_b > 0.0) {
      const double bottom = lowest_point(c, a, b);
      if (polynomial(c, bottom) < 0.0) high = bottom;
    }
    if (high > 0.0) {
      // From zero it rises first: a point where it is positive separates the crossing from the start.
      double low = a;
      if (a == 0.0 && !(c[0] > 0.0)) {
        low = 0.5 * high;
        while (low > 1e-14 * length && polynomial(c, low) < 0.0) low *= 0.5;
        if (polynomial(c, low) < 0.0) return low;
      }
      return refine(c, low, high);
    }
    a = b;
    slope_a = slope_b;
  }
  return -1.0;
}

}  // namespace rubato::integrate
