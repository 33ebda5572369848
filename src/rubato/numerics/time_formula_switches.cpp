#include <rubato/core/error.hpp>
#include <rubato/numerics/time_formula.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::numerics {
namespace {

constexpr double same_time = 4.0 * std::numeric_limits<double>::epsilon();  // relative
// Steps along an argument that is not straight: a share of the interval, at most and at least, and of its time scale.
constexpr double longest = 1.0 / 16384.0, shortest = 1.0 / 1048576.0, of_scale = 0.3;

}  // namespace

/// Follows what is compared in each switch of a formula, the inner switches first: between their changes it is smooth.
class SwitchSearch {
 public:
  SwitchSearch(const TimeFormula& formula, double from, double to) : formula_(formula), from_(from), to_(to) {}

  std::vector<double> find() {
    for (const Node& node : formula_.nodes_) {  // what a node is made of comes before it
      shapes_.push_back(shape_of(node));
      if (!switches_with_time(node)) continue;
      std::vector<double> ends = found_;
      ends.push_back(to_);
      changes_.clear();
      double start = from_;
      for (const double end : ends) {
        follow(node, start, end);
        start = end;
      }
      add_switches(changes_, from_, to_, found_);
    }
    return found_;
  }

  bool finds_any() {
    for (const Node& node : formula_.nodes_) {
      shapes_.push_back(shape_of(node));
      if (switches_with_time(node)) return true;
    }
    return false;
  }

 private:
  using Kind = TimeFormula::Kind;
  using Node = TimeFormula::Node;
  enum class Shape { constant, straight, curved, unknown };  // between the changes within

  static bool is_switch(const Node& node) {
    switch (node.kind) {
      case Kind::magnitude:
      case Kind::direction:
      case Kind::rounded:
      case Kind::least:
      case Kind::greatest:
      case Kind::less:
      case Kind::less_or_equal:
      case Kind::greater:
      case Kind::greater_or_equal:
      case Kind::equal:
      case Kind::unequal:
        return true;
      default:
        return false;
    }
  }

  bool switches_with_time(const Node& node) const {
    const Shape argument = shape_of_argument(node);
    return is_switch(node) && argument != Shape::constant && argument != Shape::unknown;
  }

  Shape known(int node) const { return node < 0 ? Shape::constant : shapes_[static_cast<std::size_t>(node)]; }
  Shape shape_of_argument(const Node& node) const { return std::max(known(node.first), known(node.second)); }

  Shape shape_of(const Node& node) const {
    const Shape first = known(node.first), second = known(node.second), third = known(node.third);
    const Shape most = std::max({first, second, third});
    if (most == Shape::unknown && node.kind != Kind::choice) return Shape::unknown;
    switch (node.kind) {
      case Kind::constant:
        return Shape::constant;
      case Kind::time:
        return Shape::straight;
      case Kind::other:
        return Shape::unknown;
      case Kind::negative:
      case Kind::sum:
      case Kind::difference:
      case Kind::least:
      case Kind::greatest:
      case Kind::magnitude:
        return most;
      case Kind::choice:
        return first == Shape::unknown ? Shape::unknown : std::max(second, third);
      case Kind::product:
        return first == Shape::constant || second == Shape::constant ? most : Shape::curved;
      case Kind::quotient:
        return second == Shape::constant ? first : Shape::curved;
      case Kind::function:
      case Kind::power:
      case Kind::angle:
        return most == Shape::constant ? Shape::constant : Shape::curved;
      default:
        return Shape::constant;  // true or false, a sign, an integer
    }
  }

  struct Point {
    double t = 0.0;
    TimeDerivatives argument;  // of the switch: it changes at levels of this
    double size = 0.0;         // of the terms of the argument
  };

  Point at(const Node& node, double t, int direction) const {
    const TimeDerivatives a = formula_.at(node.first, t, direction);
    if (node.second < 0) return {t, a, std::abs(a.value)};
    const TimeDerivatives b = formula_.at(node.second, t, direction);
    return {
        t, {a.value - b.value, a.rate - b.rate, a.second_rate - b.second_rate}, std::abs(a.value) + std::abs(b.value)};
  }

  /// Within (start, end), where the argument is smooth.
  void follow(const Node& node, double start, double end) {
    Point last = at(node, start, 1);
    if (shape_of_argument(node) == Shape::straight) return take_levels(node, last, at(node, end, -1));
    const double range = to_ - from_;
    double size = node.kind == Kind::rounded ? 1.0 : 0.0;
    while (last.t < end) {
      size = std::max(size, node.kind == Kind::rounded ? 1.0 : last.size);
      const double speed =
          std::max(std::abs(last.argument.rate) / size, std::sqrt(std::abs(last.argument.second_rate) / size));
      // Also where the scale is no number.
      const double step =
          speed * longest * range > of_scale ? std::max(of_scale / speed, shortest * range) : longest * range;
      const bool arrives = !(last.t + step < end);
      const Point next = at(node, arrives ? end : last.t + step, arrives ? -1 : 1);
      if (last.argument.rate * next.argument.rate < 0.0) {
        const Point turn = turn_between(node, last, next);
        take_levels(node, last, turn);
        take_levels(node, turn, next);
      } else {
        take_levels(node, last, next);
      }
      last = next;
    }
  }

  Point turn_between(const Node& node, const Point& first, const Point& second) const {
    double low = first.t, high = second.t;
    for (double middle = 0.5 * (low + high); middle > low && middle < high; middle = 0.5 * (low + high))
      (at(node, middle, 0).argument.rate * first.argument.rate > 0.0 ? low : high) = middle;
    return at(node, low, 1);
  }

  /// Between two points from one to the other of which the argument rises, or falls.
  void take_levels(const Node& node, const Point& first, const Point& second) {
    const double from = first.argument.value, to = second.argument.value;
    if (!std::isfinite(from) || !std::isfinite(to) || from == to) return;
    if (node.kind != Kind::rounded) {
      if (from != 0.0 && (from < 0.0 ? to >= 0.0 : to <= 0.0)) changes_.push_back(time_of(node, 0.0, first, second));
      return;
    }
    const double lowest = std::ceil(std::min(from, to) - 0.5), highest = std::floor(std::max(from, to) - 0.5);
    const double room = static_cast<double>(most_levels) - static_cast<double>(changes_.size());
    if (!(highest - lowest < room)) return;
    for (double integer = lowest; integer <= highest; ++integer)
      if (integer + 0.5 != from) changes_.push_back(time_of(node, integer + 0.5, first, second));
  }

  /// Newton's iteration, kept within a bracket by bisection.
  double time_of(const Node& node, double level, const Point& first, const Point& second) const {
    double low = first.t, high = second.t;
    const bool rises = first.argument.value < level;
    double t = low + (high - low) * ((level - first.argument.value) / (second.argument.value - first.argument.value));
    for (int i = 0; i < 200; ++i) {
      if (!(t > low && t < high)) t = 0.5 * (low + high);
      if (!(t > low && t < high)) return high;
      const TimeDerivatives argument = at(node, t, 0).argument;
      const double gap = argument.value - level;
      if (gap == 0.0) return t;
      (gap < 0.0 ? (rises ? low : high) : (rises ? high : low)) = t;
      const double next = t - gap / argument.rate;
      if (std::abs(next - t) <= 0.25 * same_time * std::abs(t)) return next;
      t = i % 8 == 7 ? 0.5 * (low + high) : next;
    }
    return high;
  }

  static constexpr std::size_t most_levels = 1000000;

  const TimeFormula& formula_;
  double from_, to_;
  std::vector<Shape> shapes_;
  std::vector<double> found_, changes_;
};

bool TimeFormula::has_switches() const { return SwitchSearch(*this, 0.0, 0.0).finds_any(); }

std::optional<TimeFormula> switching_formula(const std::string& text, const Parameters& parameters,
                                             const std::vector<std::string>& others) {
  try {
    TimeFormula formula(text, parameters, others);
    if (formula.has_switches()) return formula;
  } catch (const InvalidInput&) {
    // What makes no formula is refused by Expression; this has a function without a derivative.
  }
  return {};
}

std::vector<double> TimeFormula::switches(double from, double to) const { return SwitchSearch(*this, from, to).find(); }

void add_switches(const std::vector<double>& switches, double from, double to, std::vector<double>& times) {
  std::vector<double> sorted = switches;
  std::sort(sorted.begin(), sorted.end());
  const auto are_apart = [](double before, double after) {
    return after - before > same_time * std::max(std::abs(before), std::abs(after));
  };
  std::vector<double> all;
  all.reserve(times.size() + sorted.size());
  auto next = times.begin();
  for (const double t : sorted) {
    while (next != times.end() && *next <= t) all.push_back(*next++);
    if (are_apart(from, t) && are_apart(t, to) && (all.empty() || are_apart(all.back(), t)) &&
        (next == times.end() || are_apart(t, *next)))
      all.push_back(t);
  }
  all.insert(all.end(), next, times.end());
  times = std::move(all);
}

}  // namespace rubato::numerics
