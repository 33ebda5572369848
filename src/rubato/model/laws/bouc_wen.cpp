#include <rubato/core/error.hpp>
#include <rubato/model/laws/degrading_bouc_wen.hpp>
#include <rubato/model/laws/law_kind.hpp>
#include <rubato/model/laws/law_slopes.hpp>
#include <rubato/numerics/gauss_legendre.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::model {
namespace {

/// The solution of dy/dx = 1 - sign y^n for y >= 0: what a Bouc-Wen element does between two turns, where y is its
/// internal variable over the limit of it. In closed form for n = 1 and 2.
class PowerFlow {
 public:
  explicit PowerFlow(double n) : n_(n) {}

  /// y after a length x >= 0 of the motion that starts at y0 and in which y grows; y0 < 1 where sign > 0.
  double grow(double y0, double x, double sign) const {
    if (sign == 0.0) return y0 + x;
    if (n_ == 1.0) return sign > 0.0 ? y0 - (1.0 - y0) * std::expm1(-x) : y0 + (1.0 + y0) * std::expm1(x);
    if (n_ == 2.0) {
      const double t = sign > 0.0 ? std::tanh(x) : std::tan(x);
      return (y0 + t) / (1.0 + sign * y0 * t);
    }
    return at_time(y0, x, sign);
  }

  /// y after a length x of the motion dy/dx = -(1 - sign y^n), in which it falls; below zero where it would pass it,
  /// `left` of the length then being what is left of x, and at most 0 elsewhere.
  double fall(double y0, double x, double sign, double& left) const {
    left = -1.0;
    // Most steps stay on their side of zero, which the rate at their start shows.
    const bool stays = x * (sign > 0.0 ? 1.0 : 1.0 - sign * power(y0)) < y0;
    if (sign == 0.0) {
      left = x - y0;
      return y0 - x;
    }
    if (n_ == 1.0) {
      if (!stays) left = x - (sign > 0.0 ? -std::log1p(-y0) : std::log1p(y0));
      return sign > 0.0 ? y0 - (1.0 - y0) * std::expm1(x) : y0 + (1.0 + y0) * std::expm1(-x);
    }
    if (n_ == 2.0) {
      if (!stays) left = x - (sign > 0.0 ? std::atanh(y0) : std::atan(y0));
      if (left > 0.0) return -1.0;
      const double t = sign > 0.0 ? std::tanh(x) : std::tan(x);
      return (y0 - t) / (1.0 - sign * y0 * t);
    }
    if (!stays) left = x - time_between(0.0, y0, sign);
    return left > 0.0 ? -1.0 : at_time(y0, -x, sign);
  }

  /// y^n
  double power(double y) const { return n_ == 1.0 ? y : n_ == 2.0 ? y * y : std::pow(y, n_); }

 private:
  double rate(double y, double sign) const { return 1.0 - sign * power(y); }

  /// The length from `from` to `to`, the integral of dy / (1 - sign y^n).
  double time_between(double from, double to, double sign) const {
    if (from > to) return -time_between(to, from, sign);
    double time = 0.0;
    if (from < first) {
      const double end = std::min(to, first);
      time = series(end, sign) - series(from, sign);
      from = end;
    }
    static const numerics::GaussLegendre<16> rule;
    while (from < to) {
      // Short enough for the pole: towards 1 in steps of the distance to it, at -1 beside the n-th roots.
      const double most = sign > 0.0 ? 0.5 * (1.0 - from) : 0.7 / std::max(n_, 2.0) * std::max(from, 0.5);
      const double end = to - from < 1.2 * most ? to : from + most;
      double sum = 0.0;
      for (std::size_t i = 0; i < rule.node.size(); ++i)
        sum += rule.weight[i] / rate(from + rule.node[i] * (end - from), sign);
      time += sum * (end - from);
      from = end;
    }
    return time;
  }

  /// Sum of sign^k y^(kn+1) / (kn+1).
  double series(double y, double sign) const { return series(y, sign, power(y)); }
  /// @param power_of_y  y^n
  double series(double y, double sign, double power_of_y) const {
    const double factor = sign * power_of_y;
    double sum = 0.0, power = y;
    for (int k = 0; k < 60; ++k) {
      const double term = power / (k * n_ + 1.0);
      sum += term;
      if (std::abs(term) <= 1e-17 * sum) break;
      power *= factor;
    }
    return sum;
  }

  /// The same by the Taylor series of y about its start, where that has come to its end within its terms: in steps of
  /// time, which move y by a small part of it. The coefficients w of y^n follow from those of y (Knuth 1997, section
  /// 4.7).
  bool by_taylor(double y0, double x, double sign, double& y) const {
    constexpr int degree = 14;
    if (!(std::abs(x) < 0.2 * y0)) return false;
    double c[degree + 1], w[degree];  // of y and of y^n, each with its power of x
    c[0] = y0;
    w[0] = power(y0);
    c[1] = x * (1.0 - sign * w[0]);
    y = c[0] + c[1];
    for (int k = 1; k < degree; ++k) {
      double sum = 0.0;
      for (int j = 1; j <= k; ++j) sum += (n_ * j - (k - j)) * c[j] * w[k - j];
      w[k] = sum / (k * y0);
      c[k + 1] = -sign * x * w[k] / (k + 1);
      y += c[k + 1];
      constexpr double nothing = 0.1 * std::numeric_limits<double>::epsilon();
      if (std::abs(c[k + 1]) <= nothing * y0 && std::abs(c[k]) <= 10.0 * nothing * y0) return y >= 0.0;
    }
    return false;
  }

  /// Where y stays small: Newton's method on that series, whose slope is 1/(1 - sign y^n).
  bool by_series(double y0, double x, double sign, double& y) const {
    if (y0 > first || y0 + x > first) return false;
    double power_of_y = power(y0);
    const double wanted = series(y0, sign, power_of_y) + x;
    y = y0 + x * (1.0 - sign * power_of_y);
    for (int i = 0; i < 8; ++i) {
      if (!(y >= 0.0 && y <= first)) return false;
      power_of_y = power(y);
      const double step = (wanted - series(y, sign, power_of_y)) * (1.0 - sign * power_of_y);
      y += step;
      // What is left is of the order of y^(n-1) step^2.
      if (step * step <= 0.01 * std::numeric_limits<double>::epsilon() * y * y) return y >= 0.0;
    }
    return false;
  }

  /// The y at which the length from y0 is x, of either sign: by its series, where that ends at once, or in parts.
  double at_time(double y0, double x, double sign) const {
    constexpr double endless = 40.0;  // within which y comes as near to 1 as round-off tells
    constexpr double long_part = 0.2, short_part = 0.1, shortest_part = 0.03;  // of y
    constexpr int most_parts = 50;
    if (x > endless) return 1.0;
    double y = y0, left = x, end = 0.0;
    for (int i = 0; i < most_parts && left != 0.0; ++i) {
      if (std::abs(left) < shortest_part * y && by_taylor(y, left, sign, end)) return end;
      if (by_series(y, left, sign, end)) return end;
      if (std::abs(left) < long_part * y && by_taylor(y, left, sign, end)) return end;
      double part = left > 0.0 ? short_part * y : -short_part * y;
      if (y < first && left > 0.0) {
        part = series(first, sign) - series(y, sign);
        end = first;
      } else if (!by_taylor(y, part, sign, end)) {
        break;
      }
      y = end;
      left -= part;
    }
    return left == 0.0 ? y : by_quadrature(y, left, sign);
  }

  /// The same by Newton's method on time_between(), within bounds.
  double by_quadrature(double y0, double x, double sign) const {
    double low = x > 0.0 ? y0 : 0.0, high = x > 0.0 ? 1.0 : y0, y = y0, time = 0.0;  // the length from y0 to y
    for (int i = 0; i < 100; ++i) {
      double next = y + (x - time) * rate(y, sign);
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      time += time_between(y, next, sign);
      const double step = std::abs(next - y);
      y = next;
      (time < x ? low : high) = y;
      if (step <= 4.0 * std::numeric_limits<double>::epsilon() * y) break;
    }
    return y;
  }

  static constexpr double first = 0.3;  // up to which a series is better: y^n is not smooth at zero
  double n_;
};

/// f = alpha k u + (1 - alpha) k z, dz/dt = du/dt (A - |z|^n (gamma + beta sgn(z du/dt))): Bouc 1967; Wen 1976, eqs. 1
/// to 4. Between turns of u, z is a function of u, which advance() follows exactly; its memory is z [m].
class BoucWen final : public Law, public LawSlopes {
 public:
  BoucWen(double stiffness, double ratio, double a, double beta, double gamma, double n)
      : elastic_(ratio * stiffness),
        hysteretic_((1.0 - ratio) * stiffness),
        a_(a),
        beta_(beta),
        gamma_(gamma),
        n_(n),
        flow_(n),
        together_{gamma + beta, a, n},
        apart_{gamma - beta, a, n} {}

  Index memory_size() const override { return 1; }

  LawAnswer advance(const LawPoint& from, const double* memory, const LawPoint& to, double* next) const override {
    double slope = 0.0;
    next[0] = moved(memory[0], to.u - from.u, to.rate, slope);
    return {elastic_ * to.u + hysteretic_ * next[0], elastic_ + hysteretic_ * slope, 0.0};
  }

  /// Along a travel dz/du is rate(z), so that a change of z grows by the ratio of the rates at both ends.
  void slopes(const LawPoint& from, const double* memory, const LawPoint& to, double* slopes) const override {
    const double travel = to.u - from.u;
    double slope = 0.0;
    moved(memory[0], travel, to.rate, slope);
    const double start = rate(memory[0], travel);
    // At the limit of z both rates vanish; near it, where they are small differences, z hardly counts.
    const double kept = travel == 0.0 ? 1.0 : std::abs(start) > 1e-12 * a_ ? slope / start : decay_at_limit(travel);
    slopes[0] = elastic_ + hysteretic_ * slope;
    slopes[2] = -hysteretic_ * slope;
    slopes[4] = hysteretic_ * kept;
    slopes[5] = slope;
    slopes[7] = -slope;
    slopes[9] = kept;
  }

  LawAnswer at(const LawPoint& point, const double* memory) const override {
    const double z = memory[0];
    double slope = rate(z, point.rate);
    if (point.rate == 0.0) slope = a_ - std::pow(std::abs(z), n_) * gamma_;
    return {elastic_ * point.u + hysteretic_ * z, elastic_ + hysteretic_ * slope, 0.0};
  }

  /// Of the springs alpha k, and of the other what it gives back where it unloads as steeply as it started:
  /// (1 - alpha) k z^2 / (2 A).
  double stored_energy(double u, const double* memory) const override {
    return 0.5 * elastic_ * u * u + 0.5 * hysteretic_ * memory[0] * memory[0] / a_;
  }

  /// Its power is (1 - alpha) k z (du/dt - dz/dt / A).
  double dissipated(const LawPoint& from, const double* memory, const LawPoint& to, const double* next) const override {
    static const numerics::GaussLegendre<8> rule;
    const double travel = to.u - from.u;
    double work = 0.0, slope = 0.0;
    for (std::size_t i = 0; i < rule.node.size(); ++i)
      work += rule.weight[i] * moved(memory[0], rule.node[i] * travel, to.rate, slope);
    return hysteretic_ * (work * travel - 0.5 * (next[0] * next[0] - memory[0] * memory[0]) / a_);
  }

  double largest_stiffness() const override {
    // Where z and the motion are opposite the slope is A + (beta - gamma) |z|^n, at most at the limit of z.
    const double opposite = beta_ > gamma_ && beta_ + gamma_ > 0.0 ? (beta_ - gamma_) / (beta_ + gamma_) : 0.0;
    return elastic_ + std::max(hysteretic_, 0.0) * a_ * (1.0 + opposite);
  }
  bool is_odd() const override { return true; }

  /// Another formula holds once the motion turns, or z passes zero.
  bool is_exact_between_guards() const override { return true; }
  double guard(const LawPoint& from, const double* memory, const LawPoint& to, double near) const override {
    const double z = memory[0], before_turn = from.rate > 0.0 ? to.rate : from.rate < 0.0 ? -to.rate : 1.0;
    if (std::abs(z) <= near * a_ * std::abs(from.rate)) return before_turn;
    double slope = 0.0;
    const double then = moved(z, to.u - from.u, to.rate, slope);
    return std::min(before_turn, z > 0.0 ? then : -then);
  }

 private:
  /// dz/du where the motion goes in a direction.
  double rate(double z, double direction) const {
    const double sign = z * direction > 0.0 ? 1.0 : z * direction < 0.0 ? -1.0 : 0.0;
    return a_ - std::pow(std::abs(z), n_) * (gamma_ + beta_ * sign);
  }

  /// z after a travel without a turn, with its slope there by the travel.
  /// @param rate_then  of u at the end: where nothing has moved it says in which direction it goes on
  double moved(double z, double travel, double rate_then, double& slope) const {
    if (travel == 0.0) {
      slope = rate(z, rate_then);
      return z;
    }
    // Along the travel, w = z in its direction: dw/dx = A - c |w|^n.
    const double direction = travel > 0.0 ? 1.0 : -1.0;
    double w = direction * z, left = std::abs(travel);
    if (w < 0.0) {
      double beyond = 0.0;
      const double y = flow_.fall(-w / apart_.limit, a_ * left / apart_.limit, apart_.sign, beyond);
      if (beyond <= 0.0) {
        slope = a_ * (1.0 - apart_.sign * flow_.power(std::max(y, 0.0)));
        return -direction * apart_.limit * std::max(y, 0.0);
      }
      w = 0.0;
      left = beyond * apart_.limit / a_;
    }
    double y = w / together_.limit;
    if (together_.sign > 0.0) y = std::min(y, 1.0);
    y = flow_.grow(y, a_ * left / together_.limit, together_.sign);
    slope = a_ * (1.0 - together_.sign * flow_.power(y));
    return direction * together_.limit * y;
  }

  /// dw/dx = A - c |w|^n over its scale.
  struct Branch {
    double limit = 1.0;  ///< of |z|, where c > 0; elsewhere a scale of it [m]
    double sign = 0.0;   ///< of c

    Branch(double c, double a, double n)
        : limit(c == 0.0 ? 1.0 : std::pow(a / std::abs(c), 1.0 / n)),
          sign(c > 0.0   ? 1.0
               : c < 0.0 ? -1.0
                         : 0.0) {}
  };

  /// What is left after a travel of a small distance to the limit of z, d(dz/du)/dz there being -n A / limit.
  double decay_at_limit(double travel) const {
    return together_.sign > 0.0 ? std::exp(-n_ * a_ * std::abs(travel) / together_.limit) : 1.0;
  }

  double elastic_, hysteretic_;  // alpha k, (1 - alpha) k [N/m]
  double a_, beta_, gamma_, n_;
  PowerFlow flow_;
  Branch together_, apart_;  // z and the motion in the same direction, and in opposite ones
};

/// What is left where alpha is 1: z would go on for ever without a force.
class Elastic final : public Law {
 public:
  explicit Elastic(double stiffness) : stiffness_(stiffness) {}

  LawAnswer advance(const LawPoint&, const double*, const LawPoint& to, double*) const override {
    return {stiffness_ * to.u, stiffness_, 0.0};
  }
  LawAnswer at(const LawPoint& point, const double*) const override { return {stiffness_ * point.u, stiffness_, 0.0}; }
  double stored_energy(double u, const double*) const override { return 0.5 * stiffness_ * u * u; }
  double dissipated(const LawPoint&, const double*, const LawPoint&, const double*) const override { return 0.0; }
  double largest_stiffness() const override { return stiffness_; }
  bool is_odd() const override { return true; }

 private:
  double stiffness_;  // [N/m]
};

std::shared_ptr<const Law> make(const LawDescription& description, const numerics::Parameters& parameters,
                                const std::string& part) {
  enum { stiffness, ratio, a, beta, gamma, n, a_loss, nu_gain, eta_gain };
  std::array<double, 9> value{};
  for (std::size_t i = 0; i < std::min(value.size(), description.values.size()); ++i)
    value[i] = evaluate(description.values[i], parameters, part + ": " + law_kind("bouc_wen").keys[i].name);
  const auto refuse = [&](std::size_t key, const std::string& why) {
    throw InvalidInput(description.values[key].where.line > 0 ? description.values[key].where : description.where,
                       fmt::format("{}: {}", part, why));
  };
  if (!(value[stiffness] > 0.0)) refuse(stiffness, fmt::format("stiffness must be positive, got {}", value[stiffness]));
  if (!(value[ratio] >= 0.0 && value[ratio] <= 1.0))
    refuse(ratio, fmt::format("post_yield_ratio is a share of the stiffness, from 0 to 1, got {}", value[ratio]));
  if (!(value[a] > 0.0)) refuse(a, fmt::format("A must be positive, got {}", value[a]));
  if (!(value[n] >= 1.0 && value[n] <= 100.0)) refuse(n, fmt::format("n must lie between 1 and 100, got {}", value[n]));
  if (!(value[beta] + value[gamma] >= 0.0))
    refuse(gamma, fmt::format("beta + gamma must not be negative, got {}: z would grow without a limit",
                              value[beta] + value[gamma]));
  if (!(value[beta] >= 0.0))
    refuse(beta, fmt::format("beta must not be negative, got {}: loops would make energy", value[beta]));
  for (const std::size_t key : {a_loss, nu_gain, eta_gain})
    if (!(value[key] >= 0.0))
      refuse(key, fmt::format("{} must not be negative, got {}: it would heal with the work done on it",
                              law_kind("bouc_wen").keys[key].name, value[key]));
  if (value[ratio] == 1.0) return std::make_shared<Elastic>(value[stiffness]);
  if (value[a_loss] > 0.0 || value[nu_gain] > 0.0 || value[eta_gain] > 0.0)
    return make_degrading_bouc_wen({value[ratio] * value[stiffness], (1.0 - value[ratio]) * value[stiffness], value[a],
                                    value[beta], value[gamma], value[n], value[a_loss], value[nu_gain],
                                    value[eta_gain]});
  return std::make_shared<BoucWen>(value[stiffness], value[ratio], value[a], value[beta], value[gamma], value[n]);
}

/// What is left of the energy that spends an element where A falls with the work: it is used up before it has yielded.
std::string doubt_of_degradation(const LawDescription& description, const numerics::Parameters& parameters) {
  if (description.values.size() < 9) return {};
  std::array<double, 9> value;
  for (std::size_t i = 0; i < value.size(); ++i) value[i] = evaluate(description.values[i], parameters, "value");
  const auto [stiffness, ratio, a, beta, gamma, n, a_loss, nu_gain, eta_gain] = value;
  if (!(a_loss > 0.0 && beta + gamma > 0.0 && ratio < 1.0)) return {};
  const double limit = std::pow(a / (beta + gamma), 1.0 / n), yield = (1.0 - ratio) * stiffness * limit * limit / a;
  if (!(a / a_loss < yield)) return {};
  return fmt::format(
      "degradation.A is {:.6g} /J, so that A is used up by {:.6g} J, and one way to its limit takes some {:.6g} J: it "
      "is "
      "spent before it yields; degradation is per joule of work",
      a_loss, a / a_loss, yield);
}

/// Erlicher and Point 2004: beyond |gamma| <= beta some motions take energy out of the element.
std::string doubt(const LawDescription& description, const numerics::Parameters& parameters) {
  if (std::string why = doubt_of_degradation(description, parameters); !why.empty()) return why;
  const double beta = evaluate(description.values[3], parameters, "beta");
  const double gamma = evaluate(description.values[4], parameters, "gamma");
  constexpr double rounded = 1e-6;  // what numbers of a few digits make of |gamma| = beta
  if (!(std::abs(gamma) > beta * (1.0 + rounded))) return {};
  return fmt::format(
      "gamma is {:.6g} and beta {:.6g}: where the size of gamma exceeds beta, small cycles about a bias "
      "make energy, which no material does; take |gamma| <= beta",
      gamma, beta);
}

}  // namespace

LawKind bouc_wen();
LawKind bouc_wen() {
  using Type = LawKey::Type;
  return {"bouc_wen",
          "a Bouc-Wen element",
          "Smooth hysteresis: f = alpha k u + (1 - alpha) k z, dz/dt = du/dt (A - |z|^n (gamma + beta sgn(z du/dt)))",
          {{"stiffness", Type::number, "N/m", {}, "k, of first loading where A is 1"},
           {"post_yield_ratio", Type::number, "", 0.0, "alpha: the share of the stiffness that is left after yielding"},
           {"A", Type::number, "", 1.0, "the slope of z against u at z = 0"},
           {"beta", Type::number, "1/m^n", 0.5, "how much steeper it unloads than it loads"},
           {"gamma", Type::number, "1/m^n", 0.5, "with beta the limit of z, (A / (beta + gamma))^(1/n)"},
           {"n", Type::number, "", 1.0, "how sharply it yields"},
           {"degradation.A", Type::number, "1/J", 0.0, "what A loses with each joule of work e done on it"},
           {"degradation.nu", Type::number, "1/J", 0.0, "what nu = 1 + ... e gains, which weakens it"},
           {"degradation.eta", Type::number, "1/J", 0.0, "what eta = 1 + ... e gains, which softens it"}},
          make,
          doubt};
}

}  // namespace rubato::model
