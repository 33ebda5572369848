#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::numerics {

/// All numbers from `low` to `high`, ends included; what has no number at all is empty, and its ends are NaN.
///
/// Operations give an interval that holds every result of theirs (Moore, Kearfott and Cloud 2009, chapters 2 and 5),
/// but for round-off: ends are not rounded outward.
struct Interval {
  double low = 0.0, high = 0.0;

  static Interval empty() {
    return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  }
  static Interval whole() { return {-HUGE_VAL, HUGE_VAL}; }
  bool is_empty() const { return !(low <= high); }
  bool has(double x) const { return low <= x && x <= high; }
  double width() const { return high - low; }
  /// The largest magnitude in it.
  double size() const { return std::max(std::abs(low), std::abs(high)); }
};

/// As it is, or the whole line where an end of it is not known (infinity less infinity).
inline Interval known(double low, double high) {
  return {std::isnan(low) ? -HUGE_VAL : low, std::isnan(high) ? HUGE_VAL : high};
}

inline Interval hull(const Interval& a, const Interval& b) {
  if (a.is_empty()) return b;
  if (b.is_empty()) return a;
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

/// What both hold; `a` where round-off leaves nothing.
inline Interval common(const Interval& a, const Interval& b) {
  const Interval both{std::max(a.low, b.low), std::min(a.high, b.high)};
  return both.is_empty() ? a : both;
}

inline Interval operator-(const Interval& a) { return {-a.high, -a.low}; }

inline Interval operator+(const Interval& a, const Interval& b) {
  if (a.is_empty() || b.is_empty()) return Interval::empty();
  return known(a.low + b.low, a.high + b.high);
}

inline Interval operator-(const Interval& a, const Interval& b) { return a + (-b); }

inline Interval operator*(const Interval& a, const Interval& b) {
  if (a.is_empty() || b.is_empty()) return Interval::empty();
  const auto times = [](double x, double y) { return x == 0.0 || y == 0.0 ? 0.0 : x * y; };
  const double p = times(a.low, b.low), q = times(a.low, b.high), r = times(a.high, b.low), s = times(a.high, b.high);
  return {std::min(std::min(p, q), std::min(r, s)), std::max(std::max(p, q), std::max(r, s))};
}

inline Interval operator*(double a, const Interval& b) {
  if (a == 0.0) return b.is_empty() ? b : Interval{};
  return a > 0.0 ? Interval{a * b.low, a * b.high} : Interval{a * b.high, a * b.low};
}

inline Interval operator/(const Interval& a, const Interval& b) {
  if (a.is_empty() || b.is_empty() || (b.low == 0.0 && b.high == 0.0)) return Interval::empty();
  if (b.low < 0.0 && b.high > 0.0) return Interval::whole();
  const double from = b.high == 0.0 ? -HUGE_VAL : 1.0 / b.high, to = b.low == 0.0 ? HUGE_VAL : 1.0 / b.low;
  return a * Interval{from, to};
}

}  // namespace rubato::numerics
