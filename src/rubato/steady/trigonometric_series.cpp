#include <rubato/steady/trigonometric_series.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::steady {
namespace {

using std::numbers::pi;

// Safeguarded Newton for a root of `function` (value, slope) in [low, high], where it has the sign of `at_low` at low.
template <class Function>
Complex root_between(double low, double high, double at_low, double guess, double& angle, Function&& function) {
  double x = std::clamp(guess, low, high);
  Complex z;
  for (int iteration = 0; iteration < 60; ++iteration) {
    z = unit(x);
    const auto [value, slope] = function(z);
    if (value == 0.0) break;
    ((value > 0.0) == (at_low > 0.0) ? low : high) = x;
    double next = x - value / slope;
    if (!(next > low && next < high)) {
      // At the end of the bracket Newton may point outwards by round-off: then this is the root.
      if (std::abs(next - x) <= 4e-16 * (1.0 + std::abs(x))) break;
      next = 0.5 * (low + high);
    }
    const double step = std::abs(next - x);
    x = next;
    if (step <= 4e-16 * (1.0 + std::abs(x))) break;
    // Newton doubles the digits: a step this small leaves the next below round-off, and turns z by itself.
    if (step <= 1e-8 && high - low > 4.0 * step) {
      z = unit(x);
      break;
    }
  }
  angle = x;
  return z;
}

}  // namespace

SeriesValue evaluate(const Orders& orders, const Complex* coefficients, Complex z) {
  const Complex factor = orders.stride == 1 ? z : product(z, z);
  SeriesValue sum;
  for (int i = 0; i < orders.count; ++i) {
    const Complex term = product(coefficients[i], z);
    const double k = orders.at(i);
    sum.value += term.real();
    sum.first -= k * term.imag();
    sum.second -= k * k * term.real();
    z = product(z, factor);
  }
  return sum;
}

double TurningPoints::highest() const { return points_.empty() ? 0.0 : points_.front().value; }

double TurningPoints::lowest() const {
  if (points_.empty()) return 0.0;
  if (is_half_) return -points_.front().value;
  return std::min_element(points_.begin(), points_.end(),
                          [](const Point& a, const Point& b) { return a.value < b.value; })
      ->value;
}

void TurningPoints::find(const Orders& orders, const Complex* coefficients) {
  points_.clear();
  is_half_ = orders.stride == 2;
  if (orders.count == 0) return;
  double first = 0.0, second = 0.0;
  for (int i = 1; i < orders.count; ++i) {
    const double size = std::abs(coefficients[i]), k = orders.at(i);
    first += k * size;
    second += k * k * size;
  }
  const double lead = std::abs(coefficients[0]);
  if (lead == 0.0 && second == 0.0) return;
  // At a root of the slope |sin| of the first order is at most first / lead; where the curvature of the others cannot
  // undo that of the first there, each half period has one root.
  if (first * first + second * second < 0.9 * lead * lead) {
    const double top = -std::arg(coefficients[0]);
    add_root(orders, coefficients, top - 0.5 * pi, top + 0.5 * pi, 1.0, top);
    if (is_half_) {
      const Point p = points_.front();
      points_.push_back({p.angle + pi, -p.value, -p.unit_vector});
    } else {
      add_root(orders, coefficients, top + 0.5 * pi, top + 1.5 * pi, -1.0, top + pi);
    }
    return;
  }
  find_by_samples(orders, coefficients);
}

void TurningPoints::add_root(const Orders& orders, const Complex* coefficients, double low, double high,
                             double slope_low, double guess) {
  Point p;
  p.unit_vector = root_between(low, high, slope_low, guess, p.angle, [&](Complex z) {
    const SeriesValue s = evaluate(orders, coefficients, z);
    return std::pair{s.first, s.second};
  });
  p.value = evaluate(orders, coefficients, p.unit_vector).value;
  points_.push_back(p);
}

void TurningPoints::find_by_samples(const Orders& orders, const Complex* coefficients) {
  // Twelve samples a shortest period; in half a period the same number of samples is twice as fine.
  const int intervals = std::max(24, 12 * orders.highest()) / (is_half_ ? 2 : 1);
  const double period = is_half_ ? pi : 2.0 * pi, step = period / intervals;
  if (static_cast<int>(samples_.size()) != intervals + 1 || grid_.empty() || std::abs(grid_[1] - unit(step)) > 1e-15) {
    samples_.resize(static_cast<std::size_t>(intervals) + 1);
    grid_.resize(samples_.size());
    for (std::size_t j = 0; j < grid_.size(); ++j) grid_[j] = unit(step * static_cast<double>(j));
  }
  for (std::size_t j = 0; j < grid_.size(); ++j) samples_[j] = evaluate(orders, coefficients, grid_[j]);

  for (std::size_t j = 0; j + 1 < grid_.size(); ++j) {
    const double low = step * static_cast<double>(j), high = low + step;
    const double a = samples_[j].first, b = samples_[j + 1].first;
    if (a == 0.0) {
      const double before = j > 0      ? samples_[j - 1].first
                            : is_half_ ? -samples_[grid_.size() - 2].first
                                       : samples_[grid_.size() - 2].first;
      if ((before > 0.0) != (b > 0.0)) points_.push_back({low, samples_[j].value, grid_[j]});
      continue;
    }
    if (b == 0.0) continue;
    if ((a > 0.0) != (b > 0.0)) {
      add_root(orders, coefficients, low, high, a, low + step * a / (a - b));
      continue;
    }
    // The slope may touch zero in between: look where it comes nearest.
    const double da = samples_[j].second, db = samples_[j + 1].second;
    if ((a > 0.0) == (da > 0.0) || (b > 0.0) != (db > 0.0)) continue;
    const double middle = low + step * da / (da - db);
    const SeriesValue nearest = evaluate(orders, coefficients, unit(middle));
    if (nearest.first == 0.0 || (nearest.first > 0.0) == (a > 0.0)) continue;
    add_root(orders, coefficients, low, middle, a, 0.5 * (low + middle));
    add_root(orders, coefficients, middle, high, nearest.first, 0.5 * (middle + high));
  }
  if (points_.empty()) return;

  // From the highest on. In half a period the highest may be the opposite of a minimum found.
  auto highest = std::max_element(points_.begin(), points_.end(), [&](const Point& a, const Point& b) {
    return is_half_ ? std::abs(a.value) < std::abs(b.value) : a.value < b.value;
  });
  const bool opposite = is_half_ && highest->value < 0.0;
  const auto passed = static_cast<std::size_t>(highest - points_.begin());
  std::rotate(points_.begin(), highest, points_.end());
  for (std::size_t i = points_.size() - passed; i < points_.size(); ++i) {
    points_[i].angle += period;
    if (is_half_) {
      points_[i].value = -points_[i].value;
      points_[i].unit_vector = -points_[i].unit_vector;
    }
  }
  if (opposite)
    for (Point& p : points_) {
      p.angle += pi;
      p.value = -p.value;
      p.unit_vector = -p.unit_vector;
    }
  if (is_half_) {
    const Point p = points_.front();
    points_.push_back({p.angle + pi, -p.value, -p.unit_vector});
  }
}

Complex angle_of_value(const Orders& orders, const Complex* coefficients, double value, double low, double value_low,
                       double high, double value_high, double& angle) {
  // A cosine through both turning points is close to what lies between them.
  const double part = std::clamp((value_low - value) / (value_low - value_high), 0.0, 1.0);
  const double guess = low + (high - low) / pi * std::acos(1.0 - 2.0 * part);
  return root_between(low, high, value_low - value, guess, angle, [&](Complex z) {
    const SeriesValue s = evaluate(orders, coefficients, z);
    return std::pair{s.value - value, s.first};
  });
}

}  // namespace rubato::steady
