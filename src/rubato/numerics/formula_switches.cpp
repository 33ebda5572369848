#include <rubato/numerics/formula.hpp>
#include <rubato/numerics/formula_enclosure.hpp>
#include <rubato/numerics/formula_swings.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::numerics {
namespace {

constexpr double same_time = 4.0 * std::numeric_limits<double>::epsilon();  // relative
constexpr std::size_t most_switches = 1u << 18;                             // 2 MB; a run ends a step at each
constexpr std::size_t most_operations = 1u << 24;                           // of enclosures: about a second

}  // namespace

/// Follows what is compared in each switch of a formula, the inner switches first: between their changes it is smooth.
/// Where it is not straight, the interval is divided until the argument has no zero in a part, or rises or falls
/// through the whole of it, as enclosures of value and rate tell (Moore, Kearfott and Cloud 2009, chapter 8).
class SwitchFinder {
 public:
  SwitchFinder(const Formula& formula, double from, double to)
      : formula_(formula), nodes_(formula.tree().nodes), from_(from), to_(to), enclosure_(formula) {}

  /// None where there are too many.
  std::optional<std::vector<double>> find() {
    for (const Node& node : nodes_) {  // what a node is made of comes before it
      shapes_.push_back(shape_of(node));
      if (!switches_with_time(node)) continue;
      std::vector<double> ends = found_;
      ends.push_back(to_);
      changes_.clear();
      enclosure_.choose({node.first, node.second});
      double start = from_;
      for (const double end : ends) {
        follow(node, start, end);
        start = end;
        if (are_too_many_) return std::nullopt;
      }
      add_switches(changes_, from_, to_, found_);
    }
    return found_;
  }

  bool finds_any() {
    for (const Node& node : nodes_) {
      shapes_.push_back(shape_of(node));
      if (switches_with_time(node)) return true;
    }
    return false;
  }

 private:
  using Kind = FormulaTree::Kind;
  using Node = FormulaTree::Node;
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
  };

  Point at(const Node& node, double t, int direction) const {
    const TimeDerivatives a = formula_.part(node.first, t, direction);
    if (node.second < 0) return {t, a};
    const TimeDerivatives b = formula_.part(node.second, t, direction);
    return {t, {a.value - b.value, a.rate - b.rate, a.second_rate - b.second_rate}};
  }

  /// Within (start, end), where the argument is smooth.
  void follow(const Node& node, double start, double end) {
    if (shape_of_argument(node) == Shape::straight) return take_levels(node, at(node, start, 1), at(node, end, -1));
    struct Part {
      double from, to;
    };
    std::vector<Part> open{{start, end}};
    const auto point = [&](double t) { return at(node, t, t == start ? 1 : t == end ? -1 : 0); };
    while (!open.empty() && !are_too_many_) {
      const Part part = open.back();
      open.pop_back();
      // Ends are switches of what is within, to round-off.
      const Interval t{part.from == start ? start + round_off(start) : part.from,
                       part.to == end ? end - round_off(end) : part.to};
      const Argument argument = argument_over(node, t);
      if (!has_level(node, argument.value)) continue;
      const double middle = 0.5 * (part.from + part.to);
      const bool is_least = part.to - part.from <= 4.0 * std::max(round_off(part.from), round_off(part.to));
      if (argument.rises_or_falls || is_least) {
        const Point first = point(part.from), last = point(part.to);
        const bool are_numbers = std::isfinite(first.argument.value) && std::isfinite(last.argument.value);
        if (are_numbers || is_least) {
          take_levels(node, first, last);
          continue;
        }
      }
      open.push_back({middle, part.to});
      open.push_back({part.from, middle});
    }
  }

  double round_off(double t) const { return 4.0 * same_time * std::abs(t) + 1e-15 * (to_ - from_); }

  struct Argument {
    Interval value;
    bool rises_or_falls = false;
  };
  Argument argument_over(const Node& node, const Interval& t) {
    operations_ += enclosure_.cost();
    if (operations_ > most_operations) are_too_many_ = true;
    if (t.is_empty()) return {Interval::whole(), false};
    enclosure_.evaluate(t, 1);
    IntervalSeries argument = enclosure_.of(node.first);
    if (node.second >= 0) argument = series::difference(argument, enclosure_.of(node.second), 1);
    const Interval& rate = argument.c[1];
    return {argument.c[0], rate.low > 0.0 || rate.high < 0.0};
  }

  static bool has_level(const Node& node, const Interval& value) {
    if (value.is_empty()) return false;
    if (node.kind != Kind::rounded) return value.has(0.0) && value.size() > 0.0;
    return std::ceil(value.low - 0.5) <= std::floor(value.high - 0.5);
  }

  /// Between two points from one to the other of which the argument rises, or falls.
  void take_levels(const Node& node, const Point& first, const Point& second) {
    const double from = first.argument.value, to = second.argument.value;
    if (!std::isfinite(from) || !std::isfinite(to) || from == to) return;
    if (node.kind != Kind::rounded) {
      if (from != 0.0 && (from < 0.0 ? to >= 0.0 : to <= 0.0)) changes_.push_back(time_of(node, 0.0, first, second));
      are_too_many_ = are_too_many_ || changes_.size() > most_switches;
      return;
    }
    const double lowest = std::ceil(std::min(from, to) - 0.5), highest = std::floor(std::max(from, to) - 0.5);
    const double room = static_cast<double>(most_switches) - static_cast<double>(changes_.size());
    are_too_many_ = are_too_many_ || !(highest - lowest < room);
    if (are_too_many_) return;
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

  const Formula& formula_;
  const std::vector<Node>& nodes_;
  double from_, to_;
  std::vector<Shape> shapes_;
  std::vector<double> found_, changes_;
  FormulaEnclosure enclosure_;
  std::size_t operations_ = 0;
  bool are_too_many_ = false;
};

Formula::Formula(std::string text, const Parameters& parameters, bool of_time, const std::vector<std::string>& others)
    : text_(std::move(text)), tree_(parse_formula(text_, parameters, of_time, others)) {
  has_switches_ = SwitchFinder(*this, 0.0, 0.0).finds_any();
}

std::optional<std::vector<double>> find_switches(const Formula& formula, double from, double to) {
  return SwitchFinder(formula, from, to).find();
}

std::vector<double> Formula::switches(double from, double to) const {
  return find_switches(*this, from, to).value_or(std::vector<double>{});
}

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
