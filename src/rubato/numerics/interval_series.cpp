#include <rubato/numerics/interval_series.hpp>

#include <numbers>

namespace rubato::numerics::series {
namespace {

using S = IntervalSeries;
using std::size_t;

constexpr double pi = std::numbers::pi;

S all_empty(int n) {
  S result;
  for (int k = 0; k <= n; ++k) result.c[size_t(k)] = Interval::empty();
  return result;
}

/// The k-th coefficient of a product.
Interval coefficient(const S& a, const S& b, int k) {
  Interval sum{};
  for (int j = 0; j <= k; ++j) sum = sum + a.c[size_t(j)] * b.c[size_t(k - j)];
  return sum;
}

/// The k-th coefficient of y where y' = g a', of g up to k - 1.
Interval integrated(const S& g, const S& a, int k) {
  Interval sum{};
  for (int j = 1; j <= k; ++j) sum = sum + double(j) * (a.c[size_t(j)] * g.c[size_t(k - j)]);
  return (1.0 / k) * sum;
}

/// y with y' = g(t) a'(t).
S integral(const Interval& value, const S& g, const S& a, int n) {
  S y;
  y.c[0] = value;
  for (int k = 1; k <= n; ++k) y.c[size_t(k)] = integrated(g, a, k);
  return y;
}

/// Where part of the argument lies outside the domain of a function.
Interval within(const Interval& a, double low, double high) { return {std::max(a.low, low), std::min(a.high, high)}; }

template <class Function>
Interval rising(const Function& f, const Interval& a) {
  if (a.is_empty()) return Interval::empty();
  return known(f(a.low), f(a.high));
}

/// Whether k period + place lies in an interval for an integer k.
bool meets(const Interval& a, double place, double period) {
  return std::floor((a.high - place) / period) >= std::ceil((a.low - place) / period);
}

Interval sine(const Interval& a) {
  if (a.is_empty()) return Interval::empty();
  if (!(a.width() < 2.0 * pi)) return {-1.0, 1.0};
  const double first = std::sin(a.low), last = std::sin(a.high);
  return {meets(a, -0.5 * pi, 2.0 * pi) ? -1.0 : std::min(first, last),
          meets(a, 0.5 * pi, 2.0 * pi) ? 1.0 : std::max(first, last)};
}

Interval cosine(const Interval& a) {
  if (a.is_empty()) return Interval::empty();
  if (!(a.width() < 2.0 * pi)) return {-1.0, 1.0};
  const double first = std::cos(a.low), last = std::cos(a.high);
  return {meets(a, pi, 2.0 * pi) ? -1.0 : std::min(first, last), meets(a, 0.0, 2.0 * pi) ? 1.0 : std::max(first, last)};
}

Interval hyperbolic_cosine(const Interval& a) {
  if (a.is_empty()) return Interval::empty();
  const double first = std::cosh(a.low), last = std::cosh(a.high);
  return {a.has(0.0) ? 1.0 : std::min(first, last), std::max(first, last)};
}

/// Of a constant exponent.
Interval power_of(const Interval& a, double p) {
  if (a.is_empty() || std::isnan(p)) return Interval::empty();
  const bool is_integer = p == std::floor(p);
  const Interval x = is_integer ? a : within(a, 0.0, HUGE_VAL);
  if (x.is_empty()) return Interval::empty();
  if (p < 0.0 && x.low < 0.0 && x.high > 0.0)
    return std::fmod(p, 2.0) == 0.0 ? Interval{std::pow(x.size(), p), HUGE_VAL} : Interval::whole();
  const double first = std::pow(x.low, p), last = std::pow(x.high, p);
  const bool turns = x.has(0.0) && p > 0.0;
  const Interval ends = known(std::min(first, last), std::max(first, last));
  return turns ? hull(ends, {0.0, 0.0}) : ends;
}

/// a^p of a series whose value is not zero.
S power_by_recurrence(const S& a, double p, int n) {
  S y;
  y.c[0] = power_of(a.c[0], p);
  for (int k = 1; k <= n; ++k) {
    Interval sum{};
    for (int j = 1; j <= k; ++j) sum = sum + (j * p - (k - j)) * (a.c[size_t(j)] * y.c[size_t(k - j)]);
    y.c[size_t(k)] = (1.0 / k) * (sum / a.c[0]);
  }
  return y;
}

S to_power(const S& a, double p, int n) {
  if (power_of(a.c[0], p).is_empty()) return all_empty(n);
  constexpr double most_factors = 16.0;
  if (p == std::floor(p) && p >= 0.0 && p <= most_factors) {
    S y = constant(1.0);
    for (int i = 0; i < int(p); ++i) y = product(y, a, n);
    y.c[0] = common(y.c[0], power_of(a.c[0], p));
    return y;
  }
  if (!a.c[0].has(0.0)) return power_by_recurrence(a, p, n);
  S y;
  y.c[0] = power_of(a.c[0], p);
  return unknown_from(y, 1, n);
}

/// Of a function that is defined from `low` to `high`: y with y' = g(a) a', g = (sign (a^2 - of))^exponent.
template <class Function>
S by_square(const Function& value, const S& a, double low, double high, double sign, double of, double exponent,
            int n) {
  const Interval inside = within(a.c[0], low, high);
  if (a.c[0].is_empty() || inside.is_empty()) return all_empty(n);
  S part = a;
  part.c[0] = inside;
  S base = scaled(sign, product(part, part, n), n);
  base.c[0] = sign * (power_of(inside, 2.0) - Interval{of, of});
  base.c[0].low = std::max(base.c[0].low, 0.0);
  const S y = integral(value(inside), to_power(base, exponent, n), part, n);
  return inside.low == a.c[0].low && inside.high == a.c[0].high ? y : unknown_from(y, 1, n);
}

}  // namespace

S constant(double value) {
  S result;
  result.c[0] = std::isnan(value) ? Interval::empty() : Interval{value, value};
  return result;
}

S time(const Interval& t) {
  S result;
  result.c[0] = t;
  result.c[1] = {1.0, 1.0};
  return result;
}

S sum(const S& a, const S& b, int n) {
  S result;
  for (int k = 0; k <= n; ++k) result.c[size_t(k)] = a.c[size_t(k)] + b.c[size_t(k)];
  return result;
}

S difference(const S& a, const S& b, int n) {
  S result;
  for (int k = 0; k <= n; ++k) result.c[size_t(k)] = a.c[size_t(k)] - b.c[size_t(k)];
  return result;
}

S scaled(double factor, const S& a, int n) {
  S result;
  for (int k = 0; k <= n; ++k) result.c[size_t(k)] = factor * a.c[size_t(k)];
  return result;
}

S product(const S& a, const S& b, int n) {
  S result;
  for (int k = 0; k <= n; ++k) result.c[size_t(k)] = coefficient(a, b, k);
  return result;
}

S quotient(const S& a, const S& b, int n) {
  S result;
  for (int k = 0; k <= n; ++k) {
    Interval rest = a.c[size_t(k)];
    for (int j = 0; j < k; ++j) rest = rest - result.c[size_t(j)] * b.c[size_t(k - j)];
    result.c[size_t(k)] = rest / b.c[0];
  }
  return result;
}

S power(const S& base, const S& exponent, int n) {
  bool is_constant = exponent.c[0].low == exponent.c[0].high;
  for (int k = 1; k <= n; ++k) is_constant = is_constant && exponent.c[size_t(k)].size() == 0.0;
  if (is_constant) return to_power(base, exponent.c[0].low, n);
  if (base.c[0].high < 0.0 || base.c[0].is_empty() || exponent.c[0].is_empty()) return all_empty(n);
  const S result = exp(product(exponent, log(base, n), n), n);
  return base.c[0].low > 0.0 ? result : unknown_from(result, 0, n);
}

S angle(const S& y, const S& x, int n) {
  if (y.c[0].is_empty() || x.c[0].is_empty()) return all_empty(n);
  S result;
  const bool meets_cut = y.c[0].has(0.0) && x.c[0].low <= 0.0;
  if (meets_cut) {
    result.c[0] = {-pi, pi};
    return unknown_from(result, 1, n);
  }
  const double corners[] = {std::atan2(y.c[0].low, x.c[0].low), std::atan2(y.c[0].low, x.c[0].high),
                            std::atan2(y.c[0].high, x.c[0].low), std::atan2(y.c[0].high, x.c[0].high)};
  result.c[0] = {*std::min_element(corners, corners + 4), *std::max_element(corners, corners + 4)};
  // (x y' - y x')/(x^2 + y^2)
  S xx = product(x, x, n), yy = product(y, y, n), dx, dy;
  xx.c[0] = power_of(x.c[0], 2.0);
  yy.c[0] = power_of(y.c[0], 2.0);
  for (int k = 0; k < n; ++k) {
    dx.c[size_t(k)] = double(k + 1) * x.c[size_t(k + 1)];
    dy.c[size_t(k)] = double(k + 1) * y.c[size_t(k + 1)];
  }
  const S rate = quotient(difference(product(x, dy, n), product(y, dx, n), n), sum(xx, yy, n), n);
  for (int k = 1; k <= n; ++k) result.c[size_t(k)] = (1.0 / k) * rate.c[size_t(k - 1)];
  return result;
}

namespace {

/// s and c with s' = c a', c' = sign s a'.
void take_pair(const S& a, double sign, S& s, S& c, int n) {
  for (int k = 1; k <= n; ++k) {
    const Interval of_s = integrated(c, a, k), of_c = integrated(s, a, k);
    s.c[size_t(k)] = of_s;
    c.c[size_t(k)] = sign * of_c;
  }
}

/// y with y' = (1 + sign y^2) a'.
S tangent(const Interval& value, double sign, const S& a, int n) {
  S y, slope;
  y.c[0] = value;
  slope.c[0] = Interval{1.0, 1.0} + sign * power_of(value, 2.0);
  for (int k = 1; k <= n; ++k) {
    y.c[size_t(k)] = integrated(slope, a, k);
    slope.c[size_t(k)] = sign * coefficient(y, y, k);
  }
  return y;
}

}  // namespace

S sin(const S& a, int n) {
  S s, c;
  s.c[0] = sine(a.c[0]);
  c.c[0] = cosine(a.c[0]);
  take_pair(a, -1.0, s, c, n);
  return s;
}

S cos(const S& a, int n) {
  S s, c;
  s.c[0] = sine(a.c[0]);
  c.c[0] = cosine(a.c[0]);
  take_pair(a, -1.0, s, c, n);
  return c;
}

S tan(const S& a, int n) {
  if (!a.c[0].is_empty() && (!(a.c[0].width() < pi) || meets(a.c[0], 0.5 * pi, pi)))
    return unknown_from(constant(0.0), 0, n);
  return tangent(rising([](double x) { return std::tan(x); }, a.c[0]), 1.0, a, n);
}

S asin(const S& a, int n) {
  const auto value = [](const Interval& x) { return rising([](double y) { return std::asin(y); }, x); };
  return by_square(value, a, -1.0, 1.0, -1.0, 1.0, -0.5, n);
}

S acos(const S& a, int n) {
  const S s = asin(a, n);
  return difference(constant(0.5 * pi), s, n);
}

S atan(const S& a, int n) {
  const auto value = [](const Interval& x) { return rising([](double y) { return std::atan(y); }, x); };
  return by_square(value, a, -HUGE_VAL, HUGE_VAL, 1.0, -1.0, -1.0, n);
}

S sinh(const S& a, int n) {
  S s, c;
  s.c[0] = rising([](double x) { return std::sinh(x); }, a.c[0]);
  c.c[0] = hyperbolic_cosine(a.c[0]);
  take_pair(a, 1.0, s, c, n);
  return s;
}

S cosh(const S& a, int n) {
  S s, c;
  s.c[0] = rising([](double x) { return std::sinh(x); }, a.c[0]);
  c.c[0] = hyperbolic_cosine(a.c[0]);
  take_pair(a, 1.0, s, c, n);
  return c;
}

S tanh(const S& a, int n) {
  return tangent(rising([](double x) { return std::tanh(x); }, a.c[0]), -1.0, a, n);
}

S asinh(const S& a, int n) {
  const auto value = [](const Interval& x) { return rising([](double y) { return std::asinh(y); }, x); };
  return by_square(value, a, -HUGE_VAL, HUGE_VAL, 1.0, -1.0, -0.5, n);
}

S acosh(const S& a, int n) {
  const auto value = [](const Interval& x) { return rising([](double y) { return std::acosh(y); }, x); };
  return by_square(value, a, 1.0, HUGE_VAL, 1.0, 1.0, -0.5, n);
}

S atanh(const S& a, int n) {
  const auto value = [](const Interval& x) { return rising([](double y) { return std::atanh(y); }, x); };
  return by_square(value, a, -1.0, 1.0, -1.0, 1.0, -1.0, n);
}

S log(const S& a, int n) {
  const Interval inside = within(a.c[0], 0.0, HUGE_VAL);
  if (a.c[0].is_empty() || inside.is_empty() || !(inside.high > 0.0)) return all_empty(n);
  S y;
  y.c[0] = rising([](double x) { return std::log(x); }, inside);
  if (!(a.c[0].low > 0.0)) return unknown_from(y, 1, n);
  for (int k = 1; k <= n; ++k) {
    Interval sum{};
    for (int j = 1; j < k; ++j) sum = sum + double(j) * (y.c[size_t(j)] * a.c[size_t(k - j)]);
    y.c[size_t(k)] = (a.c[size_t(k)] - (1.0 / k) * sum) / a.c[0];
  }
  return y;
}

S log2(const S& a, int n) { return scaled(std::numbers::log2e, log(a, n), n); }

S log10(const S& a, int n) { return scaled(std::numbers::log10e, log(a, n), n); }

S exp(const S& a, int n) {
  S y;
  y.c[0] = rising([](double x) { return std::exp(x); }, a.c[0]);
  for (int k = 1; k <= n; ++k) y.c[size_t(k)] = integrated(y, a, k);
  return y;
}

S sqrt(const S& a, int n) { return to_power(a, 0.5, n); }

S either(const S& a, const S& b, int n) {
  S result;
  for (int k = 0; k <= n; ++k) result.c[size_t(k)] = hull(a.c[size_t(k)], b.c[size_t(k)]);
  return result;
}

S unknown_from(S a, int k, int n) {
  for (; k <= n; ++k) a.c[size_t(k)] = Interval::whole();
  return a;
}

}  // namespace rubato::numerics::series
