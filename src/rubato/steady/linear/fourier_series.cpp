#include <rubato/steady/linear/fourier_series.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace rubato::steady {
namespace {

struct Derivatives {
  double value = 0.0, first = 0.0, second = 0.0;
};

Derivatives at(double theta, std::span<const int> orders, std::span<const std::complex<double>> coefficients) {
  Derivatives d;
  for (std::size_t j = 0; j < orders.size(); ++j) {
    const double k = orders[j];
    const std::complex<double> z = coefficients[j] * std::polar(1.0, k * theta);
    d.value += z.real();
    d.first -= k * z.imag();
    d.second -= k * k * z.real();
  }
  return d;
}

}  // namespace

double half_peak_to_peak(std::span<const int> orders, std::span<const std::complex<double>> coefficients) {
  if (orders.empty()) return 0.0;
  if (orders.size() == 1) return std::abs(coefficients[0]);
  // Between samples this close no extremum is missed by more than what a refinement of its neighbours finds.
  const int samples = 16 * orders.back();
  const double step = 2.0 * std::numbers::pi / samples;
  std::vector<Derivatives> d;
  for (int i = 0; i < samples; ++i) d.push_back(at(i * step, orders, coefficients));
  double high = d[0].value, low = d[0].value;
  for (int i = 0; i < samples; ++i) {
    const auto& now = d[static_cast<std::size_t>(i)];
    const auto& next = d[static_cast<std::size_t>((i + 1) % samples)];
    high = std::max(high, now.value);
    low = std::min(low, now.value);
    if ((now.first > 0.0) == (next.first > 0.0)) continue;
    // The slope changes its sign here: Newton on it, kept between the samples by bisection.
    double from = i * step, to = from + step, theta = from + 0.5 * step;
    for (int iteration = 0; iteration < 60; ++iteration) {
      const Derivatives here = at(theta, orders, coefficients);
      high = std::max(high, here.value);
      low = std::min(low, here.value);
      ((here.first > 0.0) == (now.first > 0.0) ? from : to) = theta;
      double better = theta - here.first / here.second;
      if (!(better > from && better < to)) better = 0.5 * (from + to);
      if (std::abs(better - theta) <= 1e-9 * step) break;  // the value is flat there: its error is the square
      theta = better;
    }
  }
  return 0.5 * (high - low);
}

}  // namespace rubato::steady
