#pragma once

#include <rubato/system/excitation.hpp>

#include <span>
#include <vector>

namespace rubato::steady {

/// The orders of a truncated Fourier series besides zero: 1, 1 + stride, 1 + 2 stride, ... (stride 2: odd ones only).
struct Orders {
  int stride = 1;
  int count = 0;
  int at(int i) const { return 1 + stride * i; }
  int highest() const { return count > 0 ? at(count - 1) : 0; }
};

/// a b without the search for infinities that std::complex makes.
inline Complex product(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
inline Complex unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// x(theta) = sum over the orders of Re(c_k exp(i k theta)), with its derivatives by theta.
struct SeriesValue {
  double value = 0.0, first = 0.0, second = 0.0;
};
SeriesValue evaluate(const Orders& orders, const Complex* coefficients, Complex unit_vector);

/// Finds where a truncated Fourier series turns round. Holds its workspace.
class TurningPoints {
 public:
  /// The turning points of a period in the order of the angle, from the highest maximum on; with odd orders only, those
  /// of half a period up to the lowest minimum (the other half repeats them with the other sign). None where the series
  /// is zero. Two alone, found at once, where the first order prevails; else bracketed by samples and by the extrema of
  /// the slope between them; each is located to round-off.
  void find(const Orders& orders, const Complex* coefficients);

  struct Point {
    double angle = 0.0, value = 0.0;
    Complex unit_vector;
  };
  std::span<const Point> points() const { return points_; }
  bool is_half() const { return is_half_; }
  double highest() const;
  double lowest() const;
  double half_range() const { return 0.5 * (highest() - lowest()); }

 private:
  void find_by_samples(const Orders& orders, const Complex* coefficients);
  void add_root(const Orders& orders, const Complex* coefficients, double low, double high, double slope_low,
                double guess);

  std::vector<Point> points_;
  std::vector<Complex> grid_;
  std::vector<SeriesValue> samples_;
  bool is_half_ = false;
};

/// The angle in [low, high] at which a monotone stretch of the series has a value.
Complex angle_of_value(const Orders& orders, const Complex* coefficients, double value, double low, double value_low,
                       double high, double value_high, double& angle);

}  // namespace rubato::steady
