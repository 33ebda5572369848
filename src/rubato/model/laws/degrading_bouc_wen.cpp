#include <rubato/model/laws/degrading_bouc_wen.hpp>
#include <rubato/model/laws/only_transient.hpp>
#include <rubato/numerics/gauss_legendre.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rubato::model {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// What is left at a work e.
struct Strength {
  double a, nu, eta;
};

/// Where an element stands in the direction of its motion.
struct Place {
  double w;  ///< z times the direction [m]
  double e;  ///< [J]
};

/// (w, e) as functions of the travel x, dw/dx = (A - nu c |w|^n)/eta and de/dx = H w, on one side of w = 0: Taylor
/// series, whose coefficients follow from one another (Knuth 1997, section 4.7, for |w|^n).
class Series {
 public:
  static constexpr int degree = 16;

  /// @param y      |w|, above zero unless n is 1 or 2
  /// @param way    +1 where |w| is w, -1 where it is -w
  /// @param scale  of |w| [m]
  Series(const DegradingBoucWenValues& v, double y, double e, double way, double scale) {
    const double c = v.gamma + way * v.beta;
    const bool is_spent = v.a_loss * e >= v.a;
    std::array<double, degree + 1> p{}, eta{}, top{};  // |w|^n, eta, A - nu c |w|^n
    y_[0] = y;
    e_[0] = e;
    for (int k = 0; k < degree; ++k) {
      const auto i = static_cast<std::size_t>(k);
      p[i] = power(v.n, p, k);
      eta[i] = (k == 0 ? 1.0 : 0.0) + v.eta_gain * e_[i];
      double loss = p[i];
      for (std::size_t j = 0; j <= i; ++j) loss += v.nu_gain * e_[j] * p[i - j];
      top[i] = (is_spent ? 0.0 : (k == 0 ? v.a : 0.0) - v.a_loss * e_[i]) - c * loss;
      double slope = top[i];  // of w by x, times eta[0]
      for (std::size_t j = 1; j <= i; ++j) slope -= eta[j] * slope_[i - j];
      slope_[i] = slope / eta[0];
      y_[i + 1] = way * slope_[i] / (k + 1);
      e_[i + 1] = way * v.hysteretic * y_[i] / (k + 1);
    }
    // So far that the last two terms are at round-off (Jorba and Zou 2005).
    const double of_energy = v.hysteretic * scale * scale + std::abs(e);
    for (std::size_t k = degree - 1; k <= degree; ++k) {
      reach_ = std::min(reach_, std::pow(0.25 * epsilon * scale / std::abs(y_[k]), 1.0 / static_cast<double>(k)));
      reach_ = std::min(reach_, std::pow(0.25 * epsilon * of_energy / std::abs(e_[k]), 1.0 / static_cast<double>(k)));
    }
  }

  /// How far it is as good as exact [m].
  double reach() const { return reach_; }
  double y(double x) const { return sum(y_, x); }
  double e(double x) const { return sum(e_, x); }
  double slope(double x) const { return sum(slope_, x); }  ///< dw/dx

 private:
  using Coefficients = std::array<double, degree + 1>;

  static double sum(const Coefficients& c, double x) {
    double sum = 0.0;
    for (std::size_t k = degree + 1; k-- > 0;) sum = sum * x + c[k];
    return sum;
  }

  /// The coefficient k of y^n.
  double power(double n, const Coefficients& p, int k) const {
    const auto i = static_cast<std::size_t>(k);
    if (n == 1.0) return y_[i];
    double sum = 0.0;
    if (n == 2.0) {
      for (std::size_t j = 0; j <= i; ++j) sum += y_[j] * y_[i - j];
      return sum;
    }
    if (k == 0) return std::pow(y_[0], n);
    for (int j = 1; j <= k; ++j)
      sum += (n * j - (k - j)) * y_[static_cast<std::size_t>(j)] * p[static_cast<std::size_t>(k - j)];
    return sum / (k * y_[0]);
  }

  Coefficients y_{}, e_{}, slope_{};
  double reach_ = std::numeric_limits<double>::infinity();
};

class DegradingBoucWen final : public Law, public OnlyTransient {
 public:
  explicit DegradingBoucWen(const DegradingBoucWenValues& values) : v_(values) {}

  Index memory_size() const override { return 2; }

  LawAnswer advance(const LawPoint& from, const double* memory, const LawPoint& to, double* next) const override {
    double slope = 0.0;
    move(memory, to.u - from.u, to.rate, next, slope);
    return {v_.elastic * to.u + v_.hysteretic * next[0], v_.elastic + v_.hysteretic * slope, 0.0};
  }

  LawAnswer at(const LawPoint& point, const double* memory) const override {
    const double slope = rate(memory[0], memory[1], point.rate);
    return {v_.elastic * point.u + v_.hysteretic * memory[0], v_.elastic + v_.hysteretic * slope, 0.0};
  }

  double stored_energy(double u, const double* memory) const override {
    return 0.5 * v_.elastic * u * u + given_back(memory[0], memory[1]);
  }

  double dissipated(const LawPoint&, const double* memory, const LawPoint&, const double* next) const override {
    return next[1] - memory[1] - (given_back(next[0], next[1]) - given_back(memory[0], memory[1]));
  }

  double largest_stiffness() const override {
    // As without degradation; and z follows its limit, which falls, by a part of it behind.
    const double together = v_.beta + v_.gamma, limit = together > 0.0 ? std::pow(v_.a / together, 1.0 / v_.n) : 0.0;
    const double behind = 1.0 + (v_.nu_gain + v_.a_loss / v_.a) * v_.hysteretic * limit * limit / (v_.a * v_.n);
    const double opposite = v_.beta > v_.gamma && together > 0.0 ? (v_.beta - v_.gamma) / together : 0.0;
    return v_.elastic + v_.hysteretic * v_.a * (1.0 + behind * opposite);
  }
  bool is_odd() const override { return true; }

  /// Another formula holds once the motion turns, or z passes zero.
  bool is_exact_between_guards() const override { return true; }
  double guard(const LawPoint& from, const double* memory, const LawPoint& to, double near) const override {
    const double z = memory[0], before_turn = from.rate > 0.0 ? to.rate : from.rate < 0.0 ? -to.rate : 1.0;
    if (std::abs(z) <= near * v_.a * std::abs(from.rate)) return before_turn;
    double slope = 0.0, then[2];
    move(memory, to.u - from.u, to.rate, then, slope);
    return std::min(before_turn, z > 0.0 ? then[0] : -then[0]);
  }

  const char* why_no_steady_response() const override {
    return "degrades with all that is done on it (degradation), so that no motion of it repeats; run a transient, or "
           "leave degradation out";
  }

 private:
  Strength strength(double e) const {
    return {std::max(0.0, v_.a - v_.a_loss * e), 1.0 + v_.nu_gain * e, 1.0 + v_.eta_gain * e};
  }

  /// dz/du where the motion goes in a direction; in none, the mean of both.
  double rate(double z, double e, double direction) const {
    const double sign = z * direction > 0.0 ? 1.0 : z * direction < 0.0 ? -1.0 : 0.0;
    const Strength s = strength(e);
    return (s.a - s.nu * std::pow(std::abs(z), v_.n) * (v_.gamma + v_.beta * sign)) / s.eta;
  }

  /// Of |z|: its limit as it is now, and at least what it is.
  double scale(double w, double e, double travel) const {
    const Strength s = strength(e);
    const double steepest = s.nu * std::max(v_.beta + v_.gamma, std::abs(v_.gamma - v_.beta));
    if (!(steepest > 0.0)) return std::abs(w) + v_.a * travel;
    return std::max(std::abs(w), std::pow(v_.a / steepest, 1.0 / v_.n));
  }

  /// z and e after a travel without a turn, with the slope of z there by the travel.
  /// @param rate_then  of u at the end: where nothing has moved it says in which direction it goes on
  void move(const double* memory, double travel, double rate_then, double* next, double& slope) const {
    if (travel == 0.0) {
      std::copy_n(memory, 2, next);
      slope = rate(memory[0], memory[1], rate_then);
      return;
    }
    const double direction = travel > 0.0 ? 1.0 : -1.0, length = std::abs(travel);
    double left = length;
    Place at{direction * memory[0], memory[1]};
    if (at.w < 0.0) left = fall(at, left, length);
    if (left > 0.0) grow(at, left, length);
    next[0] = direction * at.w;
    next[1] = at.e;
    slope = rate(next[0], next[1], direction);
  }

  bool is_smooth_at_zero() const { return v_.n == 1.0 || v_.n == 2.0; }

  /// While w is below zero. What is left of the travel beyond.
  double fall(Place& at, double left, double length) const {
    double y = -at.w;
    while (left > 0.0) {
      const double of_y = scale(y, at.e, length);
      const Strength s = strength(at.e);
      if (!is_smooth_at_zero() && y <= beside_zero * of_y && s.a > 0.0) {  // |w|^n does not count
        const double needed = y * s.eta / s.a, part = std::min(left, needed);
        at.e -= v_.hysteretic * part * (y - 0.5 * part * s.a / s.eta);
        y = part < needed ? y - part * s.a / s.eta : 0.0;
        at.w = -y;
        return left - part;
      }
      const Series series(v_, y, at.e, -1.0, of_y);
      double part = std::min(left, series.reach());
      const double then = series.y(part);
      if (!(then > 0.0)) part = zero_of(series, y, part);
      at.e = series.e(part);
      left -= part;
      if (!(then > 0.0)) {
        at.w = 0.0;
        return left;
      }
      y = then;
      at.w = -y;
    }
    return left;
  }

  /// While w is not below zero.
  void grow(Place& at, double left, double length) const {
    while (left > 0.0) {
      const double of_w = scale(at.w, at.e, length);
      if (!is_smooth_at_zero() && at.w <= beside_zero * of_w) {  // from there on by the leading terms
        const Strength s = strength(at.e);
        if (!(s.a > 0.0)) return;  // it is spent, and z stays at zero
        const double steep = s.a / s.eta, part = std::min(left, 2.0 * beside_zero * of_w / steep);
        const double straight = at.w + steep * part;
        const double lost = s.nu * (v_.gamma + v_.beta) / s.eta / steep / (v_.n + 1.0);
        at.e += 0.5 * v_.hysteretic * part * (at.w + straight);
        at.w = straight - lost * (std::pow(straight, v_.n + 1.0) - std::pow(at.w, v_.n + 1.0));
        left -= part;
        continue;
      }
      const Series series(v_, at.w, at.e, 1.0, of_w);
      const double part = std::min(left, series.reach());
      at = {std::max(0.0, series.y(part)), series.e(part)};
      left -= part;
    }
  }

  /// Where a series that falls passes zero, before `end`: by Newton's method within bounds.
  static double zero_of(const Series& series, double y, double end) {
    double low = 0.0, high = end, x = std::min(end, y / series.slope(0.0));
    for (int i = 0; i < 60; ++i) {
      const double value = series.y(x);
      (value > 0.0 ? low : high) = x;
      double next = x + value / series.slope(x);
      if (!(next >= low && next <= high)) next = 0.5 * (low + high);
      if (std::abs(next - x) <= epsilon * end) return next;
      x = next;
    }
    return x;
  }

  /// The part of e that unloading without loss gives back: the integral of A/eta over it is (1 - alpha) k z^2/2.
  double given_back(double z, double e) const {
    const double wanted = 0.5 * v_.hysteretic * z * z;
    if (!(wanted > 0.0)) return 0.0;
    static const numerics::GaussLegendre<8> rule;
    const double spent_at = v_.a_loss > 0.0 ? v_.a / v_.a_loss : std::numeric_limits<double>::infinity();
    const double beyond = std::max(0.0, e - spent_at), top = e - beyond;
    const auto left_at = [&](double at) {
      const Strength s = strength(at);
      return s.a / s.eta;
    };
    // From the steepest slope, at no work at all: from below, and A/eta rises with what is given back.
    double back = wanted / left_at(0.0);
    for (int i = 0; i < 60; ++i) {
      double sum = 0.0;
      for (std::size_t j = 0; j < rule.node.size(); ++j) sum += rule.weight[j] * left_at(top - rule.node[j] * back);
      const double step = (wanted - back * sum) / left_at(top - back);
      back += step;
      if (std::abs(step) <= 4.0 * epsilon * back) break;
    }
    return beyond + back;
  }

  static constexpr double beside_zero = 1e-5;  // of the limit of |z|: what is left out there is of third order
  DegradingBoucWenValues v_;
};

}  // namespace

std::shared_ptr<const Law> make_degrading_bouc_wen(const DegradingBoucWenValues& values) {
  return std::make_shared<DegradingBoucWen>(values);
}

}  // namespace rubato::model
