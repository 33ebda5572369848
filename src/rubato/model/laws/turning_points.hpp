#pragma once

#include <rubato/core/types.hpp>

#include <array>
#include <cmath>
#include <cstddef>

namespace rubato::model {

/// A number with its slopes by some others.
template <std::size_t count>
struct Sloped {
  double value = 0.0;
  std::array<double, count> slope{};

  Sloped() = default;
  Sloped(double number) : value(number) {}  // implicit, as double itself
  Sloped& operator+=(const Sloped& b) {
    value += b.value;
    for (std::size_t i = 0; i < count; ++i) slope[i] += b.slope[i];
    return *this;
  }
  Sloped& operator*=(double factor) {
    value *= factor;
    for (double& s : slope) s *= factor;
    return *this;
  }
  friend Sloped operator+(Sloped a, const Sloped& b) { return a += b; }
  friend Sloped operator-(Sloped a, Sloped b) { return a += (b *= -1.0); }
  friend Sloped operator*(double factor, Sloped a) { return a *= factor; }
};

inline double value_of(double x) { return x; }
template <std::size_t count>
double value_of(const Sloped<count>& x) {
  return x.value;
}

/// The memory of rules by Masing: half the travels between the turning points that are not forgotten, the radii
///
///   r_1 > r_2 > ... > r_n > 0
///
/// with the directions of these travels, which alternate; the first is the whole travel from where nothing had
/// happened. A slider that slips at the spring deflection phi has last slipped in the direction k where r_(k+1) < phi <
/// r_k. So a travel makes the last radius grow, a turn begins another, and a radius that reaches the one before forgets
/// both.
///
/// As numbers it is the radii with the signs of their directions, zeros behind them: all zero at first.
template <class Real, std::size_t most>
class TurningPoints {
 public:
  explicit TurningPoints(const double* memory) {
    while (n_ < most && memory[n_] != 0.0) {
      r_[n_] = std::abs(memory[n_]);
      ++n_;
    }
    if (n_ > 0) first_ = memory[0] > 0.0 ? 1.0 : -1.0;
  }
  void write(double* memory) const {
    for (std::size_t k = 0; k < most; ++k) memory[k] = k < n_ ? way(k) * value_of(r_[k]) : 0.0;
  }

  std::size_t size() const { return n_; }
  bool is_full() const { return n_ == most; }
  double radius(std::size_t k) const { return value_of(r_[k]); }
  const Real& number(std::size_t k) const { return r_[k]; }
  Real& number(std::size_t k) { return r_[k]; }
  /// The direction k, 1 or -1.
  double way(std::size_t k) const { return k % 2 == 0 ? first_ : -first_; }
  /// That of the last; 0 where nothing has happened.
  double way() const { return n_ == 0 ? 0.0 : way(n_ - 1); }

  /// A turn, or the first travel. Not of full ones.
  void begin(double way) {
    if (n_ == 0) first_ = way;
    r_[n_] = 0.0;
    ++n_;
  }
  /// Forgets the last two, which are as large as each other; of two only the first is left, turned round.
  void close() {
    if (n_ == 2) first_ = -first_;
    n_ -= n_ == 2 ? 1 : 2;
  }
  /// Swaps the ranges of directions k and k + 1, which then are one with those beside them, from a border on.
  void swap(std::size_t k, const Real& border) {
    const std::size_t fewer = k == 0 ? 1 : 2;
    if (k == 0) first_ = -first_;
    r_[k == 0 ? 1 : k] = border;
    for (std::size_t i = k + 3; i < n_; ++i) r_[i - fewer] = r_[i];
    n_ -= fewer;
  }
  /// Lets the ranges r_(k + 1) to r_k and r_(k + 3) to r_(k + 2) be one, from y to x.
  void join(std::size_t k, const Real& x, const Real& y) {
    r_[k] = x;
    r_[k + 1] = y;
    for (std::size_t i = k + 4; i < n_; ++i) r_[i - 2] = r_[i];
    n_ -= 2;
  }
  /// Turns the first round, which is hardly longer than the second.
  void turn_first() {
    r_[0] = 2.0 * r_[1] - r_[0];
    for (std::size_t i = 2; i < n_; ++i) r_[i - 1] = r_[i];
    --n_;
    first_ = -first_;
  }

  /// Forgets what differs by round-off: of travels that repeat, each closes the loop before it to the last digits only.
  /// What that changes is of the order of the product of the widths that go.
  void tidy() {
    constexpr double nothing = 1e-14;  // of squares of radii, and of the first for a turn that leads nowhere
    while (n_ >= 2 && radius(n_ - 1) <= nothing * radius(0)) --n_;
    for (bool has_changed = true; has_changed;) {
      has_changed = false;
      if (n_ >= 2 && std::pow(radius(0) - radius(1), 2) <= nothing * radius(0) * radius(0)) {
        turn_first();
        has_changed = true;
      } else if (n_ >= 3) {
        const std::size_t k = n_ - 3;
        const double widths = (radius(k) - radius(k + 1)) * (radius(k + 1) - radius(k + 2));
        if (!(widths <= nothing * radius(k) * radius(k))) break;
        swap(k, r_[k] - r_[k + 1] + r_[k + 2]);
        has_changed = true;
      }
    }
  }

 private:
  std::array<Real, most> r_{};
  std::size_t n_ = 0;
  double first_ = 1.0;
};

}  // namespace rubato::model
