#include <rubato/analysis/steady/peaks.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace rubato::analysis {
namespace {

/// For curves of a noise: at 1e-13 third differences and round-off of the curves disturb equally.
struct Precision {
  explicit Precision(double noise) {
    const double more = std::cbrt(noise / 1e-13);
    difference = 3e-6 * more;
    settled = 1e-9 * more * more;
    round_off = 1e3 * noise;
  }
  double difference;  // of x
  double settled;     // of x, Newton's last step
  double round_off;   // of a value
};

constexpr double close_enough = 2e-3;  // of the bracket, for Newton to start
constexpr int most_parabolas = 40, most_newton = 12;
constexpr double resolved = 1e-2;  // of a curve, which the cubic through samples may miss between them
constexpr int least_halvings = 1, most_halvings = 5;

struct Bracket {
  double low, middle, high;           // x
  double at_low, at_middle, at_high;  // of the curve
};

class Search {
 public:
  Search(const Curves& curves, const PeakRange& range, Index curve)
      : curves_(curves), range_(range), precision_(range.noise), curve_(curve) {}

  bool value(double x, double& out) {
    if (!curves_(x, values_)) return false;
    out = values_[curve_];
    return std::isfinite(out);
  }

  // Narrows a bracket whose middle is highest: by the parabola through it, by the golden section where that does not
  // halve the step before the last.
  bool narrow(Bracket& b) {
    constexpr double golden = 0.381966011250105;
    const double wanted = close_enough * (b.high - b.low);
    double step_before = b.high - b.low, step = step_before;
    for (int i = 0; i < most_parabolas && b.high - b.low > wanted; ++i) {
      const double left = b.middle - b.low, right = b.high - b.middle;
      const double p = (b.at_middle - b.at_high) * left, q = (b.at_middle - b.at_low) * right;
      double x = b.middle - 0.5 * (left * p - right * q) / (p + q);
      const bool usable = p + q > 0.0 && x > b.low && x < b.high && std::abs(x - b.middle) < 0.5 * step_before;
      if (!usable) x = right > left ? b.middle + golden * right : b.middle - golden * left;
      step_before = step;
      step = std::abs(x - b.middle);
      if (usable && step < 0.25 * wanted) {
        if (step < 1e-12 * std::abs(x)) return true;
        // The parabola has settled: one point on the other side closes the bracket.
        x = b.middle + (x > b.middle ? 0.4 : -0.4) * wanted;
        if (!(x > b.low && x < b.high)) return true;
      }
      double now = 0.0;
      if (!value(x, now)) return false;
      if (now >= b.at_middle) {
        (x > b.middle ? b.low : b.high) = b.middle;
        (x > b.middle ? b.at_low : b.at_high) = b.at_middle;
        b.middle = x;
        b.at_middle = now;
      } else {
        (x > b.middle ? b.high : b.low) = x;
        (x > b.middle ? b.at_high : b.at_low) = now;
      }
    }
    return true;
  }

  // Newton's method on the slope from x, not leaving [low, high].
  std::optional<Peak> finish(double x, double low, double high) {
    Peak peak{curve_, x, 0.0, 0.0, Peak::Kind::interior};
    for (int i = 0; i < most_newton; ++i) {
      const double h = precision_.difference * std::max(std::abs(x), 1e-3 * (range_.to - range_.from));
      double before = 0.0, here = 0.0, after = 0.0;
      if (!value(x - h, before) || !value(x, here) || !value(x + h, after)) return std::nullopt;
      const double slope = (after - before) / (2.0 * h), curvature = (after - 2.0 * here + before) / (h * h);
      peak.at = x;
      peak.value = here;
      peak.slope = slope;
      if (!(curvature < 0.0)) return std::nullopt;
      const double next = x - slope / curvature;
      if (std::abs(next - x) <= precision_.settled * std::abs(x)) {
        peak.value = here - 0.5 * slope * (next - x);
        peak.at = next;
        return peak;
      }
      if (!(next >= low && next <= high)) return std::nullopt;
      x = next;
    }
    return std::nullopt;  // it goes to and fro over a corner
  }

  Peak climb(Bracket bracket) {
    const double low = bracket.low, high = bracket.high;
    const auto open = [&] { return Peak{curve_, bracket.middle, bracket.at_middle, NAN, Peak::Kind::interior, false}; };
    if (!narrow(bracket)) return open();
    // What lies lower, beyond round-off, is the top of another bend.
    const double least = bracket.at_middle - precision_.round_off * std::abs(bracket.at_middle);
    if (auto peak = finish(bracket.middle, low, high); peak && peak->value >= least) return *peak;
    // No curvature to trust: a corner of the curve. It is where the bracket closes.
    for (int i = 0; i < 5; ++i)
      if (!narrow(bracket)) return open();
    return Peak{curve_, bracket.middle, bracket.at_middle, NAN, Peak::Kind::interior};
  }

 private:
  const Curves& curves_;
  const PeakRange& range_;
  Precision precision_;
  Index curve_;
  Vector values_;
};

/// Where curves are looked at: equally spaced, and besides.
std::vector<double> places_of(const PeakRange& range) {
  std::vector<double> places;
  const int samples = std::max(range.samples, 3);
  for (int i = 0; i < samples; ++i) places.push_back(range.from + (range.to - range.from) * i / (samples - 1));
  const double nearest = 1e-3 * (range.to - range.from) / samples;
  for (const double x : range.besides)
    if (x > range.from && x < range.to &&
        std::none_of(places.begin(), places.end(), [&](double y) { return std::abs(x - y) < nearest; }))
      places.push_back(x);
  std::sort(places.begin(), places.end());
  return places;
}

/// A place where curves were looked at.
struct Sample {
  double x = 0.0;
  Vector y;                              // [c]; empty where there is no value
  bool is_new = false, is_rough = true;  // of the last halving; what lies to the right is not resolved
};

/// The cubic through four samples.
Vector cubic(const std::array<const Sample*, 4>& through, double x) {
  Vector sum = Vector::Zero(through[0]->y.size());
  for (std::size_t i = 0; i < 4; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < 4; ++j)
      if (j != i) weight *= (x - through[j]->x) / (through[i]->x - through[j]->x);
    sum += weight * through[i]->y;
  }
  return sum;
}

/// Marks what lies beside new samples as rough where the cubic through the four old ones around them misses them. Of
/// the first `sought` values each is measured by its own size, the others by that of the largest of them.
void judge(std::vector<Sample>& samples, Index sought) {
  for (Sample& one : samples) one.is_rough = false;
  std::vector<std::size_t> old;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (!samples[i].is_new && samples[i].y.size() > 0) old.push_back(i);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (!samples[i].is_new || samples[i].y.size() == 0 || old.size() < 4) continue;
    const auto right = std::upper_bound(old.begin(), old.end(), i) - old.begin();
    const auto first =
        static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(right - 2, 0, static_cast<std::ptrdiff_t>(old.size()) - 4));
    std::array<const Sample*, 4> around{};
    for (std::size_t j = 0; j < 4; ++j) around[j] = &samples[old[first + j]];
    const Vector& now = samples[i].y;
    Vector largest = now.cwiseAbs();
    for (const Sample* one : around) largest = largest.cwiseMax(one->y.cwiseAbs());
    auto besides = largest.tail(largest.size() - sought);
    if (besides.size() > 0) besides.setConstant(besides.maxCoeff());
    if (((cubic(around, samples[i].x) - now).array().abs() > resolved * largest.array()).any())
      samples[i - 1].is_rough = samples[i].is_rough = true;
  }
  for (Sample& one : samples) one.is_new = false;
}

}  // namespace

std::vector<double> find_extremes(const Curves& curves, const PeakRange& range, Index sought) {
  std::vector<Sample> samples;
  const auto sample = [&](double x) {
    Sample now{x, {}};
    if (!curves(x, now.y) || !now.y.allFinite()) now.y.resize(0);
    return now;
  };
  for (const double x : places_of(range)) samples.push_back(sample(x));
  for (int level = 0; level < most_halvings; ++level) {
    std::vector<Sample> finer;
    bool has_grown = false;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      finer.push_back(samples[i]);
      if (i + 1 == samples.size() || (level >= least_halvings && !samples[i].is_rough)) continue;
      finer.push_back(sample(0.5 * (samples[i].x + samples[i + 1].x)));
      finer.back().is_new = has_grown = true;
    }
    if (!has_grown) break;
    judge(finer, sought);
    samples = std::move(finer);
  }
  std::vector<Sample> known;
  std::copy_if(samples.begin(), samples.end(), std::back_inserter(known),
               [](const Sample& one) { return one.y.size() > 0; });
  std::vector<double> extremes;
  for (std::size_t i = 1; i + 1 < known.size(); ++i) {
    const Vector before = (known[i].y - known[i - 1].y).head(sought),
                 after = (known[i + 1].y - known[i].y).head(sought);
    if ((before.array() * after.array() < 0.0).any()) extremes.push_back(known[i].x);
  }
  return extremes;
}

std::vector<Peak> find_peaks(const Curves& curves, const PeakRange& range) {
  const std::vector<double> places = places_of(range);
  std::vector<double> x;
  std::vector<Vector> y;
  Vector values;
  for (const double place : places)
    if (curves(place, values) && values.allFinite()) {
      x.push_back(place);
      y.push_back(values);
    }
  std::vector<Peak> peaks;
  if (x.empty()) return peaks;
  const std::size_t last = x.size() - 1;
  for (Index c = 0; c < y.front().size(); ++c)
    for (std::size_t i = 0; i <= last; ++i) {
      const bool rises = i == 0 || y[i][c] > y[i - 1][c], falls = i == last || y[i][c] >= y[i + 1][c];
      if (!rises || !falls) continue;
      if (i > 0 && i < last) {
        peaks.push_back(Search(curves, range, c).climb({x[i - 1], x[i], x[i + 1], y[i - 1][c], y[i][c], y[i + 1][c]}));
        continue;
      }
      // At an end: a maximum between it and its neighbour has a slope that says so.
      Search search(curves, range, c);
      const double inwards = i == 0 ? 1.0 : -1.0,
                   h = Precision(range.noise).difference * std::max(std::abs(x[i]), 1e-3);
      double near = 0.0;
      if (!search.value(x[i] + inwards * h, near)) continue;
      Peak peak{c, x[i], y[i][c], inwards * (near - y[i][c]) / h,
                i == 0 ? Peak::Kind::lower_end : Peak::Kind::upper_end};
      if (near > y[i][c] && last > 0) {
        const std::size_t other = i == 0 ? 1 : last - 1;
        const double a = x[i], b = x[other];
        Bracket bracket{std::min(a, b), a + inwards * h,
                        std::max(a, b), i == 0 ? y[i][c] : y[other][c],
                        near,           i == 0 ? y[other][c] : y[i][c]};
        peak = search.climb(bracket);
      }
      peaks.push_back(peak);
    }
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.value > b.value; });
  return peaks;
}

std::optional<Peak> follow_peak(const Curves& curves, const PeakRange& range, const Peak& known) {
  Search search(curves, range, known.curve);
  const double width = 0.25 * (range.to - range.from);
  if (known.kind == Peak::Kind::interior) {
    if (auto peak =
            search.finish(known.at, std::max(range.from, known.at - width), std::min(range.to, known.at + width)))
      return peak;
  }
  std::optional<Peak> nearest;
  for (const Peak& peak : find_peaks(curves, range)) {
    if (peak.curve != known.curve || std::abs(peak.at - known.at) > width) continue;
    if (!nearest || std::abs(peak.at - known.at) < std::abs(nearest->at - known.at)) nearest = peak;
  }
  return nearest;
}

}  // namespace rubato::analysis
