#pragma once

#include <rubato/numerics/interval.hpp>

#include <array>

namespace rubato::numerics {

/// The Taylor coefficients f^(k)/k! of a function of t, each an interval that holds all its values while t runs through
/// an interval: forward differentiation by recurrences (Griewank and Walther 2008, chapter 13; Moore, Kearfott and
/// Cloud 2009, chapter 9).
struct IntervalSeries {
  static constexpr int most = 6;
  std::array<Interval, most + 1> c{};  ///< of order 0, 1, ...

  /// Derivative of an order k.
  Interval derivative(int k) const {
    double factorial = 1.0;
    for (int i = 2; i <= k; ++i) factorial *= i;
    return factorial * c[static_cast<std::size_t>(k)];
  }
};

/// Functions of series up to an order n <= IntervalSeries::most; what lies above is left as it is.
/// What has no value for all t of the interval is empty; what has none for some is that of the others, with derivatives
/// that may be anything.
namespace series {

IntervalSeries constant(double value);
/// t in an interval.
IntervalSeries time(const Interval& t);
IntervalSeries sum(const IntervalSeries& a, const IntervalSeries& b, int n);
IntervalSeries difference(const IntervalSeries& a, const IntervalSeries& b, int n);
IntervalSeries product(const IntervalSeries& a, const IntervalSeries& b, int n);
IntervalSeries quotient(const IntervalSeries& a, const IntervalSeries& b, int n);
IntervalSeries scaled(double factor, const IntervalSeries& a, int n);
IntervalSeries power(const IntervalSeries& base, const IntervalSeries& exponent, int n);
IntervalSeries angle(const IntervalSeries& y, const IntervalSeries& x, int n);  ///< atan2

IntervalSeries sin(const IntervalSeries& a, int n);
IntervalSeries cos(const IntervalSeries& a, int n);
IntervalSeries tan(const IntervalSeries& a, int n);
IntervalSeries asin(const IntervalSeries& a, int n);
IntervalSeries acos(const IntervalSeries& a, int n);
IntervalSeries atan(const IntervalSeries& a, int n);
IntervalSeries sinh(const IntervalSeries& a, int n);
IntervalSeries cosh(const IntervalSeries& a, int n);
IntervalSeries tanh(const IntervalSeries& a, int n);
IntervalSeries asinh(const IntervalSeries& a, int n);
IntervalSeries acosh(const IntervalSeries& a, int n);
IntervalSeries atanh(const IntervalSeries& a, int n);
IntervalSeries log(const IntervalSeries& a, int n);
IntervalSeries log2(const IntervalSeries& a, int n);
IntervalSeries log10(const IntervalSeries& a, int n);
IntervalSeries exp(const IntervalSeries& a, int n);
IntervalSeries sqrt(const IntervalSeries& a, int n);

/// Either of two, which one is not known.
IntervalSeries either(const IntervalSeries& a, const IntervalSeries& b, int n);
/// With derivatives from order k on that may be anything: of what jumps (k = 1) or has a kink (k = 2).
IntervalSeries unknown_from(IntervalSeries a, int k, int n);

}  // namespace series

}  // namespace rubato::numerics
