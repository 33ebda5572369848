#include <rubato/integrate/exact/first_exit.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace rubato::integrate {
namespace {

constexpr std::size_t samples = 8, most_terms = 32;

struct Values {
  double value, slope;
};

Values evaluate(std::span<const double> c, double s) {
  Values v{0.0, 0.0};
  for (std::size_t k = c.size(); k-- > 0;) {
    v.slope = v.slope * s + v.value;
    v.value = v.value * s + c[k];
  }
  return v;
}

double curvature(std::span<const double> c, double s) {
  double value = 0.0;
  for (std::size_t k = c.size(); k-- > 2;) value = value * s + static_cast<double>(k * (k - 1)) * c[k];
  return value;
}

// Newton inside a bracket, bisection where it leaves it. `f(s)` gives a value and its derivative; the value is not
// negative at low, and negative at high.
template <class F>
double refine(const F& f, double low, double high, double s) {
  if (!(s > low && s < high)) s = 0.5 * (low + high);
  for (int i = 0; i < 100; ++i) {
    const Values v = f(s);
    (v.value < 0.0 ? high : low) = s;
    double next = v.slope != 0.0 ? s - v.value / v.slope : low;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - s) <= 1e-16 * high || high - low <= 1e-16 * high) return next;
    s = next;
  }
  return s;
}

/// The margin to one edge of the band: `sign` * (edge - p), a polynomial that becomes negative where p leaves.
class Margin {
 public:
  Margin(std::span<const double> c, double edge, double sign) : size_(c.size()) {
    for (std::size_t k = 0; k < size_; ++k) c_[k] = -sign * c[k];
    c_[0] += sign * edge;
    if (c_[0] < 0.0) c_[0] = 0.0;  // beyond the edge by round-off
  }
  std::span<const double> terms() const { return {c_.data(), size_}; }

  /// Its zero in (a, high], where it is negative at high and, but for a = 0, not at a.
  double zero(double a, double high) const {
    const double at_low = a == 0.0 ? c_[0] : evaluate(terms(), a).value, at_high = evaluate(terms(), high).value;
    double low = a;
    if (a == 0.0 && !(c_[0] > 0.0)) {  // it rises from zero first: a point where it is positive is not the start
      low = 0.5 * high;
      while (low > 1e-14 * high && evaluate(terms(), low).value < 0.0) low *= 0.5;
      if (evaluate(terms(), low).value < 0.0) return low;
    }
    const double secant = low == a ? a + (high - a) * at_low / (at_low - at_high) : 0.5 * (low + high);
    return refine([this](double s) { return evaluate(terms(), s); }, low, high, secant);
  }

 private:
  std::array<double, most_terms> c_;
  std::size_t size_;
};

// All samples side by side: the recurrences of one would wait for each other.
struct Samples {
  std::array<double, samples> at, value{}, slope{};
};
Samples sample(std::span<const double> c, double length) {
  Samples s;
  for (std::size_t i = 0; i < samples; ++i) s.at[i] = length * static_cast<double>(i + 1) / samples;
  for (std::size_t k = c.size(); k-- > 0;)
    for (std::size_t i = 0; i < samples; ++i) {
      s.slope[i] = s.slope[i] * s.at[i] + s.value[i];
      s.value[i] = s.value[i] * s.at[i] + c[k];
    }
  return s;
}

// Where the slope of p, of the sign -`sign` at high, vanishes.
double extremum(std::span<const double> c, double sign, double low, double slope_low, double high, double slope_high) {
  const double secant = low + (high - low) * slope_low / (slope_low - slope_high);
  return refine(
      [&](double s) {
        return Values{sign * evaluate(c, s).slope, sign * curvature(c, s)};
      },
      low, high, secant);
}

}  // namespace

double polynomial(std::span<const double> c, double s) {
  double value = 0.0;
  for (std::size_t k = c.size(); k-- > 0;) value = value * s + c[k];
  return value;
}

double first_exit(std::span<const double> c, double lower, double upper, double length) {
  assert(c.size() <= most_terms);
  // How far the terms can carry it at most; and from where on they are below round-off.
  double fall = 0.0, rise = 0.0, size = 0.0, power = 1.0;
  std::size_t terms = 1;
  for (std::size_t k = 0; k < c.size(); ++k, power *= length) {
    const double term = c[k] * power;
    if (k > 0) (term < 0.0 ? fall : rise) += term;
    size = std::max(size, std::abs(term));
    if (std::abs(term) > 1e-18 * size) terms = k + 1;
  }
  if (c[0] + fall > lower && c[0] + rise < upper) return -1.0;
  c = c.first(terms);

  const auto [at, value, slope] = sample(c, length);
  double a = 0.0, slope_a = terms > 1 ? c[1] : 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    for (const double sign : {1.0, -1.0}) {
      const double edge = sign > 0.0 ? upper : lower;
      if (std::isinf(edge)) continue;
      double high = -1.0;
      if (sign * (edge - value[i]) < 0.0) {
        high = at[i];
      } else if (sign * slope_a > 0.0 && sign * slope[i] < 0.0) {
        const double peak = extremum(c, sign, a, slope_a, at[i], slope[i]);
        if (sign * (edge - polynomial(c, peak)) < 0.0) high = peak;
      }
      if (high > 0.0) return Margin(c, edge, sign).zero(a, high);
    }
    a = at[i];
    slope_a = slope[i];
  }
  return -1.0;
}

void include_range(std::span<const double> c, double length, double& low, double& high) {
  if (c.empty()) return;
  const auto [at, value, slope] = sample(c, length);
  double a = 0.0, value_a = c[0], slope_a = c.size() > 1 ? c[1] : 0.0;
  low = std::min(low, value_a);
  high = std::max(high, value_a);
  for (std::size_t i = 0; i < samples; ++i) {
    low = std::min(low, value[i]);
    high = std::max(high, value[i]);
    if (slope_a * slope[i] < 0.0) {
      // Where the tangents of both ends meet lies beyond the extremum between them.
      const double sign = slope_a > 0.0 ? 1.0 : -1.0, width = at[i] - a;
      const double meet = (value[i] - value_a - slope[i] * width) / (slope_a - slope[i]);
      const double bound = value_a + slope_a * meet;
      if (sign > 0.0 ? bound > high : bound < low) {
        const double extreme = polynomial(c, extremum(c, sign, a, slope_a, at[i], slope[i]));
        low = std::min(low, extreme);
        high = std::max(high, extreme);
      }
    }
    a = at[i];
    value_a = value[i];
    slope_a = slope[i];
  }
}

}  // namespace rubato::integrate
