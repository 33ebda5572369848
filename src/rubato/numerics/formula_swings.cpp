#include <rubato/numerics/formula_enclosure.hpp>
#include <rubato/numerics/formula_swings.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::numerics {
namespace {

constexpr double least_height = 1e-4;           // of an arc that counts, of the range of the formula
constexpr double unseen = 0.25 * least_height;  // by which a part may be off
constexpr int first_parts = 64;                 // steps are at most a fiftieth of a run anyway
constexpr std::size_t most_operations = 1u << 23;
constexpr double beside = 2.0;  // a bound holds for so many of its steps before and after its place

/// Bounds beside one another that differ by less than this factor are one, the smaller.
constexpr double alike = 1.25;

/// A part of the interval in which a formula is as good as a cubic.
struct Part {
  double from = 0.0, to = 0.0;
  double value = 0.0, rate = 0.0, bend = 0.0;  // in its middle: f, f', f''
  double most_bend = 0.0;                      // the largest |f''| in it
  double bound = HUGE_VAL;                     // of steps [s]

  double middle() const { return 0.5 * (from + to); }
  double at_end(double side) const {
    const double s = side * 0.5 * (to - from);
    return value + s * (rate + 0.5 * s * bend);
  }
};

class SwingSearch {
 public:
  SwingSearch(FormulaEnclosure& enclosure, int part, int order, double from, double to)
      : enclosure_(enclosure), part_(part), order_(order), from_(from), to_(to) {
    enclosure_.choose({part});
  }

  /// @param switches  of the formula in (from, to), rising
  std::vector<StepBound> find(const std::vector<double>& switches) {
    std::vector<double> borders{from_};
    borders.insert(borders.end(), switches.begin(), switches.end());
    borders.push_back(to_);
    divide(borders);
    if (!are_known_) return {};
    std::sort(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) { return a.from < b.from; });
    for (std::size_t first = 0; first < parts_.size();) {
      std::size_t last = first + 1;
      // Parts on either side of a switch do not touch.
      while (last < parts_.size() && parts_[last].from == parts_[last - 1].to && goes_on(last)) ++last;
      bound_arc(first, last);
      first = last;
    }
    hold_beside();
    return joined();
  }
  bool are_known() const { return are_known_; }

 private:
  struct Open {
    double from, to;
  };

  double round_off(double t) const {
    return 32.0 * std::numeric_limits<double>::epsilon() * std::abs(t) + 1e-15 * (to_ - from_);
  }

  void divide(const std::vector<double>& borders) {
    std::vector<Open> open, next;
    for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
      // What is compared in a switch has its value there to round-off alone.
      const double from = borders[i] + (i > 0 ? round_off(borders[i]) : round_off(0.0));
      const double to = borders[i + 1] - (i + 2 < borders.size() ? round_off(borders[i + 1]) : 0.0);
      if (!(to > from)) continue;
      const int count = 1 + static_cast<int>(first_parts * (to - from) / (to_ - from_));
      for (int k = 0; k < count; ++k)
        open.push_back({from + (to - from) * k / count, k + 1 < count ? from + (to - from) * (k + 1) / count : to});
    }
    // All of one level before the next: the range is then known soon.
    while (!open.empty() && are_known_) {
      next.clear();
      for (const Open& one : open) {
        look(one, next);
        if (!are_known_) return;
      }
      std::swap(open, next);
    }
  }

  Interval derivative(int k) const {
    double factorial = 1.0;
    for (int i = 2; i <= k + order_; ++i) factorial *= i;
    return factorial * enclosure_.of(part_).c[static_cast<std::size_t>(k + order_)];
  }

  void look(const Open& one, std::vector<Open>& next) {
    operations_ += 2 * enclosure_.cost();
    are_known_ = operations_ <= most_operations;
    Part part;
    part.from = one.from;
    part.to = one.to;
    const double length = one.to - one.from, middle = part.middle();
    enclosure_.evaluate({middle, middle}, 2 + order_);
    const Interval value = derivative(0), rate = derivative(1), bend = derivative(2);
    const bool has_value = std::isfinite(value.low) && value.low == value.high;
    if (has_value) {
      low_ = std::min(low_, value.low);
      high_ = std::max(high_, value.low);
    }
    const double range = std::max(0.0, high_ - low_);
    part.value = has_value ? value.low : 0.0;
    part.rate = rate.low;
    part.bend = bend.low;
    enclosure_.evaluate({one.from, one.to}, 4 + order_);
    const Interval over = derivative(0), third = derivative(3), fourth = derivative(4);
    if (over.is_empty()) return;  // nowhere a value
    Interval bends = derivative(2);
    if (bend.low == bend.high) bends = common(bends, bend + Interval{-0.5 * length, 0.5 * length} * third);
    part.most_bend = bends.size();
    const bool is_flat = over.width() <= unseen * range;
    const bool is_cubic = has_value && std::isfinite(part.rate) && std::isfinite(part.bend) &&
                          std::pow(length, 4) * fourth.size() / 384.0 <= unseen * range;
    const bool is_least = length <= 4.0 * std::max(round_off(one.from), round_off(one.to));
    if (is_flat || is_cubic) {
      if (is_flat && !is_cubic) part.rate = part.bend = part.most_bend = 0.0;
      parts_.push_back(part);
    } else if (!is_least) {
      next.push_back({one.from, middle});
      next.push_back({middle, one.to});
    }
  }

  /// Whether a part bends the way of the part before.
  bool goes_on(std::size_t i) const { return parts_[i].bend * parts_[i - 1].bend >= 0.0; }

  void bound_arc(std::size_t first, std::size_t last) {
    const double start = parts_[first].from, end = parts_[last - 1].to;
    const double from = parts_[first].at_end(-1.0), to = parts_[last - 1].at_end(1.0);
    double height = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      const double share = (parts_[i].middle() - start) / (end - start);
      height = std::max(height, std::abs(parts_[i].value - (from + share * (to - from))));
    }
    if (!(height > least_height * (high_ - low_))) return;
    for (std::size_t i = first; i < last; ++i)
      if (parts_[i].most_bend > 0.0) parts_[i].bound = std::numbers::pi / 3.0 * std::sqrt(height / parts_[i].most_bend);
  }

  /// A bound holds for the parts beside its own.
  void hold_beside() {
    struct Held {
      double step, until;
    };
    const auto pass = [&](auto begin, auto end, auto near, auto far) {
      std::vector<Held> held;  // rising steps, each of which holds longer than the one before
      for (auto part = begin; part != end; ++part) {
        const double own = part->bound;
        std::erase_if(held, [&](const Held& one) { return one.until < near(*part); });
        if (!held.empty()) part->bound = std::min(part->bound, held.front().step);
        if (!std::isfinite(own)) continue;
        const Held mine{own, far(*part) + beside * own};
        std::erase_if(held, [&](const Held& one) { return one.step >= mine.step && one.until <= mine.until; });
        const auto place =
            std::find_if(held.begin(), held.end(), [&](const Held& one) { return one.step > mine.step; });
        if (place == held.begin() || std::prev(place)->until < mine.until) held.insert(place, mine);
      }
    };
    const std::vector<Part> own = parts_;
    pass(
        parts_.begin(), parts_.end(), [](const Part& part) { return part.from; },
        [](const Part& part) { return part.to; });
    std::vector<Part> back = own;
    pass(
        back.rbegin(), back.rend(), [](const Part& part) { return -part.to; },
        [](const Part& part) { return -part.from; });
    for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].bound = std::min(parts_[i].bound, back[i].bound);
  }

  /// Parts of like bounds in one.
  std::vector<StepBound> joined() const {
    std::vector<StepBound> bounds;
    double longest = 0.0;
    for (const Part& part : parts_) {
      if (!std::isfinite(part.bound)) {
        longest = 0.0;
        continue;
      }
      if (longest > 0.0) {
        const double step = std::min(bounds.back().step, part.bound), most = std::max(longest, part.bound);
        const bool is_short = part.to - bounds.back().from < step;
        if (most <= alike * step || is_short) {
          bounds.back().to = part.to;
          bounds.back().step = step;
          longest = most;
          continue;
        }
      }
      bounds.push_back({part.from, part.to, part.bound});
      longest = part.bound;
    }
    return bounds;
  }

  FormulaEnclosure& enclosure_;
  int part_, order_;
  double from_, to_;
  std::vector<Part> parts_;
  double low_ = HUGE_VAL, high_ = -HUGE_VAL;
  std::size_t operations_ = 0;
  bool are_known_ = true;
};

}  // namespace

Swings swings(const Formula& formula, int order, double from, double to) {
  Swings all;
  const auto switches = find_switches(formula, from, to);
  if (!switches) return {{}, false};
  constexpr double others = 0.7390851332151607;  // no value that makes sense of a formula by chance
  FormulaEnclosure enclosure(formula, others);
  const std::vector<int> parts = enclosure.parts_of_time();
  for (const int part : parts) {
    SwingSearch search(enclosure, part, order, from, to);
    all.bounds = join(all.bounds, search.find(*switches));
    all.are_known = all.are_known && search.are_known();
  }
  const bool is_of_others = std::find(parts.begin(), parts.end(), enclosure.whole()) == parts.end();
  if (is_of_others && !parts.empty()) {
    // With constants in their place, of which some make no sense: what is not found so is not missed.
    SwingSearch search(enclosure, enclosure.whole(), order, from, to);
    all.bounds = join(all.bounds, search.find(*switches));
  }
  return all;
}

std::vector<StepBound> join(const std::vector<StepBound>& a, const std::vector<StepBound>& b, double longest) {
  std::vector<StepBound> result;
  const auto take = [&](double from, double to, double step) {
    if (!(step < longest) || !(to > from)) return;
    if (!result.empty() && result.back().to == from && result.back().step == step)
      result.back().to = to;
    else
      result.push_back({from, to, step});
  };
  std::size_t i = 0, j = 0;
  double t = -HUGE_VAL;
  while (i < a.size() || j < b.size()) {
    const auto next = [&](const std::vector<StepBound>& of, std::size_t k, double& step) {
      step = HUGE_VAL;
      if (k == of.size()) return HUGE_VAL;
      if (t < of[k].from) return of[k].from;
      step = of[k].step;
      return of[k].to;
    };
    double of_a = HUGE_VAL, of_b = HUGE_VAL;
    const double end = std::min(next(a, i, of_a), next(b, j, of_b));
    take(t, end, std::min(of_a, of_b));
    t = end;
    while (i < a.size() && a[i].to <= t) ++i;
    while (j < b.size() && b[j].to <= t) ++j;
  }
  return result;
}

}  // namespace rubato::numerics
