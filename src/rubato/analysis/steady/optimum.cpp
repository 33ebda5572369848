#include <rubato/analysis/steady/optimum.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::analysis {
namespace {

/// For values of F of a noise.
struct Precision {
  explicit Precision(double noise) {
    const double root = std::sqrt(noise / 1e-13);
    difference = 1e-4 * std::sqrt(root);
    settled = finest = equal = 1e-9 * root;
    round_off = 10.0 * noise;
  }
  double difference;  // of p, for derivatives of F
  double settled;     // of p, Newton's last step
  double finest;      // of p, for the place of a corner
  double equal;       // of F: two peaks that are as near are one height
  double round_off;   // of F: what is as near does not change
};

constexpr double close_enough = 1e-4;   // of p, for the end of Brent's method
constexpr double same_place = 1e-5;     // of x: what the place of a peak errs by
constexpr double farthest_move = 0.02;  // of x: how far a peak moves in a difference of p, at most
constexpr int most_rounds = 60, most_newton = 20;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class Refinement : private Precision {
 public:
  Refinement(PeakFamily& family, double low, double high, double sign, double noise)
      : Precision(noise), family_(family), low_(low), high_(high), sign_(sign) {}

  double value(double p) {
    const auto peak = top(p);
    return peak ? sign_ * peak->value : HUGE_VAL;
  }

  // Brent's method without derivatives in [a, b], from a best point between.
  double minimise(double a, double best, double b, double precision = close_enough) {
    constexpr double golden = 0.381966011250105;
    double x = best, w = best, v = best, fx = value(x), fw = fx, fv = fx, step = 0.0, before = 0.0;
    for (int i = 0; i < most_rounds; ++i) {
      const double middle = 0.5 * (a + b), tolerance = precision * step_unit(x);
      if (std::abs(x - middle) <= 2.0 * tolerance - 0.5 * (b - a)) break;
      bool parabolic = false;
      if (std::abs(before) > tolerance) {
        const double r = (x - w) * (fx - fv);
        double q = (x - v) * (fx - fw), p = (x - v) * q - (x - w) * r;
        q = 2.0 * (q - r);
        if (q > 0.0) p = -p;
        q = std::abs(q);
        if (std::abs(p) < std::abs(0.5 * q * before) && p > q * (a - x) && p < q * (b - x)) {
          before = step;
          step = p / q;
          parabolic = true;
        }
      }
      if (!parabolic) {
        before = x < middle ? b - x : a - x;
        step = golden * before;
      }
      const double u = x + (std::abs(step) >= tolerance ? step : std::copysign(tolerance, step)), fu = value(u);
      if (fu <= fx) {
        (u < x ? b : a) = x;
        v = w, fv = fw, w = x, fw = fx, x = u, fx = fu;
      } else {
        (u < x ? a : b) = u;
        if (fu <= fw || w == x)
          v = w, fv = fw, w = u, fw = fu;
        else if (fu <= fv || v == x || v == w)
          v = u, fv = fu;
      }
    }
    return x;
  }

  // A bracket of a point that lies below `level`, between `worse`, where F is above it, and `edge`, from where on F
  // keeps to it: by halving the part in which it reaches the level. Nothing where F does not fall below.
  std::optional<std::array<double, 3>> dip(double worse, double edge, double level) {
    const double noise = equal * std::abs(level);
    while (std::abs(edge - worse) > close_enough * step_unit(edge)) {
      const double middle = 0.5 * (worse + edge), now = value(middle);
      if (now < level - noise) return std::array{std::min(worse, edge), middle, std::max(worse, edge)};
      (now > level + noise ? worse : edge) = middle;
    }
    return std::nullopt;
  }

  // What the lowest point near p is.
  std::optional<Optimum> certify(double p) {
    const double h = step_of(p);
    if (p - low_ <= h || high_ - p <= h) {
      const double end = p - low_ <= h ? low_ : high_;
      if (auto bound = at_bound(end)) return bound;
    }
    const double inside = std::clamp(p, low_ + h, high_ - h);
    const auto before = top(inside - h), after = top(inside + h);
    if (!before || !after) return std::nullopt;
    if (is_same(*before, inside + h, *after)) {
      if (auto found = smooth(inside, *before)) return found;
    } else if (auto found = kink(inside, *before, *after)) {
      return found;
    }
    return corner(inside);
  }

  // An end of the range, if the curve goes on beyond it.
  std::optional<Optimum> at_bound(double end) {
    const auto peak = top(end);
    if (!peak) return std::nullopt;
    const double s = slope(end, *peak);
    const bool goes_on = end == low_ ? sign_ * s > 0.0 : sign_ * s < 0.0;
    if (std::abs(s) * step_of(end) <= round_off * std::abs(peak->value))
      return Optimum{Optimum::Kind::flat, end, {*peak}, {0.0, 0.0}, {1.0, 0.0}, 0.0};
    if (!goes_on) return std::nullopt;
    return Optimum{Optimum::Kind::bound, end, {*peak}, {s, 0.0}, {1.0, 0.0}, 0.0};
  }

 private:
  double step_unit(double p) const { return std::max(std::abs(p), 1e-3 * (high_ - low_)); }
  double step_of(double p) const { return difference * step_unit(p); }
  std::optional<Peak> top(double p) {
    const auto peaks = family_.peaks(p);
    if (peaks.empty()) return std::nullopt;
    return peaks.front();
  }
  // Whether a peak has become another at p. Two that are close, as of weakly coupled masses, are told apart by
  // following: one of them stays where it was, or nearly.
  bool is_same(const Peak& a, double p, const Peak& b) {
    const double apart = std::abs(a.at - b.at);
    if (a.curve != b.curve || a.kind != b.kind || apart > farthest_move * std::abs(a.at)) return false;
    if (apart <= same_place * std::abs(a.at)) return true;
    const auto followed = family_.follow(p, a);
    return followed && std::abs(followed->at - b.at) <= std::max(same_place * std::abs(a.at), 0.25 * apart);
  }
  double slope(double p, const Peak& peak) {
    const double h =
        std::min({step_of(p), p - low_ > 0.0 ? p - low_ : HUGE_VAL, high_ - p > 0.0 ? high_ - p : HUGE_VAL});
    const auto before = p > low_ ? family_.follow(p - h, peak) : std::optional(peak);
    const auto after = p < high_ ? family_.follow(p + h, peak) : std::optional(peak);
    if (!before || !after) return nan;
    return (after->value - before->value) / ((p < high_ ? h : 0.0) + (p > low_ ? h : 0.0));
  }

  // Whether no other peak is higher than one that is followed.
  bool is_top(double p, const Peak& peak) {
    const auto highest = top(p);
    return highest && highest->value <= peak.value + equal * std::abs(peak.value);
  }

  // Where the derivative of one peak vanishes, by Newton's method; nothing where it does not settle at an extremum.
  std::optional<Optimum> smooth(double p, Peak peak) {
    for (int i = 0; i < most_newton; ++i) {
      const double h = step_of(p);
      const auto here = family_.follow(p, peak), before = family_.follow(p - h, peak),
                 after = family_.follow(p + h, peak);
      if (!here || !before || !after) return std::nullopt;
      const double s = (after->value - before->value) / (2.0 * h);
      const double c = (after->value - 2.0 * here->value + before->value) / (h * h);
      const double noise = round_off * std::abs(here->value);
      if (std::abs(after->value - here->value) <= noise && std::abs(before->value - here->value) <= noise)
        return Optimum{Optimum::Kind::flat, p, {*here}, {0.0, 0.0}, {1.0, 0.0}, 0.0};
      if (!(sign_ * c > 0.0)) return std::nullopt;
      peak = *here;
      const double next = p - s / c;
      if (!(next >= low_ + 4.0 * h && next <= high_ - 4.0 * h)) return std::nullopt;
      if (std::abs(next - p) <= settled * step_unit(p)) {
        // Over a corner the second difference falls with the distance; a curvature does not.
        const auto far_before = family_.follow(p - 4.0 * h, peak), far_after = family_.follow(p + 4.0 * h, peak);
        if (!far_before || !far_after || !is_top(p, peak)) return std::nullopt;
        const double far = (far_after->value - 2.0 * peak.value + far_before->value) / (16.0 * h * h);
        if (!(far / c > 0.5)) return std::nullopt;
        return Optimum{Optimum::Kind::smooth, p, {peak}, {s, 0.0}, {1.0, 0.0}, c};
      }
      p = next;
    }
    return std::nullopt;
  }

  // Where two peaks are equal, by the secant method on their difference; nothing where they are not, or where both
  // rise.
  std::optional<Optimum> kink(double p, Peak a, Peak b) {
    const double h = step_of(p);
    double p0 = p - h, p1 = p + h;
    const auto difference_at = [&](double x) {
      const auto now_a = family_.follow(x, a), now_b = family_.follow(x, b);
      if (!now_a || !now_b) return nan;
      a = *now_a;
      b = *now_b;
      return a.value - b.value;
    };
    double d0 = difference_at(p0), d1 = difference_at(p1);
    for (int i = 0; i < most_newton && std::isfinite(d0) && std::isfinite(d1) && d1 != d0; ++i) {
      const double next = p1 - d1 * (p1 - p0) / (d1 - d0);
      if (!(next > low_ && next < high_)) return std::nullopt;
      p0 = p1, d0 = d1, p1 = next, d1 = difference_at(p1);
      if (std::abs(p1 - p0) <= settled * step_unit(p1)) break;
    }
    if (!(std::abs(d1) <= equal * std::abs(a.value)) || !is_top(p1, a)) return std::nullopt;
    const double slope_a = slope(p1, a), slope_b = slope(p1, b);
    if (!(slope_a * slope_b < 0.0)) return std::nullopt;
    const double multiplier = slope_b / (slope_b - slope_a);
    return Optimum{Optimum::Kind::kink, p1, {a, b}, {slope_a, slope_b}, {multiplier, 1.0 - multiplier}, 0.0};
  }

  // Where one peak turns from falling to rising without a derivative. Slopes over two distances tell a corner, where
  // they are alike, from a round minimum, where they halve; else the best that was found is all there is.
  std::optional<Optimum> corner(double p) {
    const double reach = 4.0 * step_of(p);
    p = minimise(std::max(low_, p - reach), p, std::min(high_, p + reach), finest);
    const double h = std::min({step_of(p), p - low_, high_ - p});
    const auto here = top(p), before = top(p - h), after = top(p + h), near_before = top(p - 0.5 * h),
               near_after = top(p + 0.5 * h);
    if (!here) return std::nullopt;
    Optimum result{Optimum::Kind::uncertified, p, {*here}, {nan, 0.0}, {1.0, 0.0}, 0.0};
    if (!before || !after || !near_before || !near_after) return result;
    // The best point was not near enough before to see that the highest peaks at its sides are two.
    if (!is_same(*near_before, p + 0.5 * h, *near_after))
      if (auto found = kink(p, *near_before, *near_after)) return found;
    const double left = (here->value - before->value) / h, right = (after->value - here->value) / h;
    const double near_left = (here->value - near_before->value) / (0.5 * h),
                 near_right = (near_after->value - here->value) / (0.5 * h);
    result.derivative = {0.5 * (left + right), 0.0};
    const bool turns = sign_ * near_left < 0.0 && sign_ * near_right > 0.0;
    if (!turns || near_left / left < 0.75 || near_right / right < 0.75) return result;
    const double multiplier = near_right / (near_right - near_left);
    return Optimum{Optimum::Kind::corner,          p,  {*here, *here}, {near_left, near_right},
                   {multiplier, 1.0 - multiplier}, 0.0};
  }

  PeakFamily& family_;
  double low_, high_, sign_;
};

}  // namespace

std::optional<Optimum> find_optimum(PeakFamily& family, const std::vector<double>& samples,
                                    const std::vector<double>& values, double sign, double noise) {
  std::size_t best = samples.size();
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (std::isfinite(values[i]) && (best == samples.size() || sign * values[i] < sign * values[best])) best = i;
  if (best == samples.size()) return std::nullopt;
  const double low = samples[best == 0 ? 0 : best - 1], high = samples[std::min(best + 1, samples.size() - 1)];
  Refinement refinement(family, samples.front(), samples.back(), sign, noise);

  std::size_t first = best, last = best;
  const auto is_level = [&](std::size_t i) {
    return std::abs(values[i] - values[best]) <= Precision(noise).equal * std::abs(values[best]);
  };
  while (first > 0 && is_level(first - 1)) --first;
  while (last + 1 < samples.size() && is_level(last + 1)) ++last;

  // Where F keeps one level, as where all sliders stick, whatever presses them, the lowest value often lies beside it:
  // a slider that begins to slip brakes. Nothing where F does not fall below its level between it and the next samples.
  const auto beside_level = [&](double from, double to) {
    const double level = sign * values[best];
    std::optional<double> lowest;
    for (const bool is_before : {true, false}) {
      if (is_before ? first == 0 : last + 1 == samples.size()) continue;
      const auto bracket =
          is_before ? refinement.dip(samples[first - 1], from, level) : refinement.dip(samples[last + 1], to, level);
      if (!bracket) continue;
      const double at = refinement.minimise((*bracket)[0], (*bracket)[1], (*bracket)[2]);
      if (!lowest || refinement.value(at) < refinement.value(*lowest)) lowest = at;
    }
    return lowest;
  };
  if (first < last)
    if (const auto lowest = beside_level(samples[first], samples[last])) return refinement.certify(*lowest);

  std::optional<Optimum> found;
  if (best == 0 || best + 1 == samples.size()) found = refinement.at_bound(samples[best]);
  if (!found) found = refinement.certify(refinement.minimise(low, samples[best], high));
  if (found && found->kind == Optimum::Kind::flat && first == last)
    if (const auto lowest =
            beside_level(std::min(found->parameter, samples[best]), std::max(found->parameter, samples[best])))
      return refinement.certify(*lowest);
  return found;
}

std::string optimum_kind(Optimum::Kind kind) {
  switch (kind) {
    case Optimum::Kind::smooth:
      return "smooth";
    case Optimum::Kind::kink:
      return "kink";
    case Optimum::Kind::corner:
      return "corner";
    case Optimum::Kind::bound:
      return "bound";
    case Optimum::Kind::flat:
      return "flat";
    case Optimum::Kind::uncertified:
      return "uncertified";
  }
  return {};
}

}  // namespace rubato::analysis
