#include <rubato/integrate/exact/first_exit.hpp>
#include <rubato/integrate/exact/processor_clones.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace rubato::integrate {
namespace {

constexpr std::size_t samples = 8, most_terms = 32;

struct Point {
  double at = 0.0, value = 0.0, slope = 0.0;
};

// Even and odd terms apart, so that their recurrences do not wait for each other: p = E(s^2) + s O(s^2).
Point evaluate(std::span<const double> c, double s) {
  const double square = s * s;
  double even = 0.0, odd = 0.0, even_slope = 0.0, odd_slope = 0.0;
  std::size_t k = c.size();
  if (k % 2 == 1) even = c[--k];
  for (; k > 0; k -= 2) {
    even_slope = even_slope * square + even;
    odd_slope = odd_slope * square + odd;
    even = even * square + c[k - 2];
    odd = odd * square + c[k - 1];
  }
  return {s, even + s * odd, odd + 2.0 * s * (even_slope + s * odd_slope)};
}

// How far the terms can carry it at most; even and odd ones apart, so that their sums do not wait for each other.
bool stays_inside(std::span<const double> c, double lower, double upper, double length) {
  const double square = length * length;
  double power = length, fall = 0.0, rise = 0.0, even_fall = 0.0, even_rise = 0.0;
  std::size_t k = 1;
  for (; k + 1 < c.size(); k += 2, power *= square) {
    const double odd = c[k] * power, even = c[k + 1] * (power * length);
    fall += std::min(odd, 0.0);
    rise += std::max(odd, 0.0);
    even_fall += std::min(even, 0.0);
    even_rise += std::max(even, 0.0);
  }
  if (k < c.size()) (c[k] < 0.0 ? fall : rise) += c[k] * power;
  return c[0] + (fall + even_fall) > lower && c[0] + (rise + even_rise) < upper;
}

// All samples side by side: the recurrences of one would wait for each other.
struct Samples {
  typedef double Lanes __attribute__((vector_size(samples * sizeof(double))));
  Lanes at, value{}, slope{};
  Point operator[](std::size_t i) const { return {at[i], value[i], slope[i]}; }
};

RUBATO_CLONES void sample(const double* c, std::size_t terms, double length, Samples& result) {
  Samples::Lanes at, even{}, odd{}, even_slope{}, odd_slope{};
  for (std::size_t i = 0; i < samples; ++i) at[i] = length * static_cast<double>(i + 1) / samples;
  const Samples::Lanes square = at * at;
  std::size_t k = terms;
  if (k % 2 == 1) even = c[--k] - even;
  for (; k > 0; k -= 2) {
    even_slope = even_slope * square + even;
    odd_slope = odd_slope * square + odd;
    even = even * square + c[k - 2];
    odd = odd * square + c[k - 1];
  }
  result = {at, even + at * odd, odd + 2.0 * at * (even_slope + at * odd_slope)};
}

// Where the cubic with the values and slopes of both ends vanishes, nearly: three steps of Newton from the secant.
double cubic_guess(const Point& low, const Point& high) {
  const double width = high.at - low.at, rise = high.value - low.value;
  const double first = width * low.slope, last = width * high.slope;
  const double square = 3.0 * rise - 2.0 * first - last, cube = first + last - 2.0 * rise;
  double x = -low.value / rise;
  for (int i = 0; i < 3; ++i) {
    const double value = ((cube * x + square) * x + first) * x + low.value;
    const double slope = (3.0 * cube * x + 2.0 * square) * x + first;
    const double next = x - value / slope;
    if (!(next > 0.0 && next < 1.0)) break;
    x = next;
  }
  return low.at + x * width;
}

// Newton inside a bracket, bisection where it leaves it: the value is not negative at low, and negative at high. A step
// of Newton that is small, and as small against the one before as quadratic convergence makes it, leaves an error of
// step^3/before^2.
double zero(std::span<const double> c, double low, double high, double s) {
  if (!(s > low && s < high)) s = 0.5 * (low + high);
  double before = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Point p = evaluate(c, s);
    double next = s - p.value / p.slope;
    const double step = std::abs(next - s);
    if (step <= 1e-16 * high) return s;
    (p.value < 0.0 ? high : low) = s;
    const bool inside = next > low && next < high;  // also where the slope is zero
    if (inside && step <= 1e-8 * high && step * step * step <= 1e-17 * high * before * before) return next;
    if (!inside) next = 0.5 * (low + high);
    if (high - low <= 1e-16 * high) return next;
    before = inside ? step : 0.0;
    s = next;
  }
  return s;
}

// Where p crosses an edge of the band on its way from inside at `low` to outside at `high`. sign = 1 for the upper
// edge.
double crossing(std::span<const double> c, double edge, double sign, Point low, Point high) {
  // The margin to the edge, a polynomial that becomes negative.
  std::array<double, most_terms> storage;
  for (std::size_t k = 0; k < c.size(); ++k) storage[k] = -sign * c[k];
  storage[0] = std::max(0.0, storage[0] + sign * edge);  // beyond the edge by round-off
  std::span<const double> margin(storage.data(), c.size());
  low = {low.at, sign * (edge - low.value), -sign * low.slope};
  high = {high.at, sign * (edge - high.value), -sign * high.slope};
  if (low.at == 0.0 && !(margin[0] > 0.0)) {
    // It starts at the edge and rises from zero first: without the factors s it starts above.
    double power = 1.0;
    while (margin.size() > 2 && margin[0] == 0.0) {
      margin = margin.subspan(1);
      high.slope -= high.value / high.at;
      power *= high.at;
    }
    high.value /= power;
    high.slope /= power;
    low = {0.0, margin[0], margin[1]};
    if (!(margin[0] > 0.0)) {  // outward by round-off: a point where it is inside is not the start
      low.at = 0.5 * high.at;
      while (low.at > 1e-14 * high.at && evaluate(margin, low.at).value < 0.0) low.at *= 0.5;
      low = evaluate(margin, low.at);
      if (low.value < 0.0) return low.at;
    }
  }
  return zero(margin, low.at, high.at, cubic_guess(low, high));
}

// Where the slope of p vanishes, which is positive at `low` and negative at `high`, or the reverse.
double extremum(std::span<const double> c, const Point& low, const Point& high) {
  std::array<double, most_terms> slope;
  const double sign = low.slope > 0.0 ? 1.0 : -1.0;
  for (std::size_t k = 0; k + 1 < c.size(); ++k) slope[k] = sign * static_cast<double>(k + 1) * c[k + 1];
  const double secant = low.at + (high.at - low.at) * low.slope / (low.slope - high.slope);
  return zero({slope.data(), c.size() - 1}, low.at, high.at, secant);
}

}  // namespace

double polynomial(std::span<const double> c, double s) {
  double value = 0.0;
  for (std::size_t k = c.size(); k-- > 0;) value = value * s + c[k];
  return value;
}

double first_exit(std::span<const double> c, double lower, double upper, double length) {
  assert(!c.empty() && c.size() <= most_terms);
  if (stays_inside(c, lower, upper, length)) return -1.0;
  Samples sampled;
  sample(c.data(), c.size(), length, sampled);
  Point low{0.0, c[0], c.size() > 1 ? c[1] : 0.0};
  for (std::size_t i = 0; i < samples; ++i) {
    const Point high = sampled[i];
    for (const double sign : {1.0, -1.0}) {
      const double edge = sign > 0.0 ? upper : lower;
      if (std::isinf(edge)) continue;
      if (sign * (edge - high.value) < 0.0) return crossing(c, edge, sign, low, high);
      if (!(sign * low.slope > 0.0 && sign * high.slope < 0.0)) continue;
      const Point peak = evaluate(c, extremum(c, low, high));
      if (sign * (edge - peak.value) < 0.0) return crossing(c, edge, sign, low, peak);
    }
    low = high;
  }
  return -1.0;
}

void include_range(std::span<const double> c, double length, double& low, double& high) {
  if (c.empty()) return;
  Samples sampled;
  sample(c.data(), c.size(), length, sampled);
  Point before{0.0, c[0], c.size() > 1 ? c[1] : 0.0};
  low = std::min(low, before.value);
  high = std::max(high, before.value);
  for (std::size_t i = 0; i < samples; ++i) {
    const Point next = sampled[i];
    low = std::min(low, next.value);
    high = std::max(high, next.value);
    if (before.slope * next.slope < 0.0) {
      // Where the tangents of both ends meet lies beyond the extremum between them.
      const double meet =
          (next.value - before.value - next.slope * (next.at - before.at)) / (before.slope - next.slope);
      const double bound = before.value + before.slope * meet;
      if (before.slope > 0.0 ? bound > high : bound < low) {
        const double extreme = polynomial(c, extremum(c, before, next));
        low = std::min(low, extreme);
        high = std::max(high, extreme);
      }
    }
    before = next;
  }
}

}  // namespace rubato::integrate
