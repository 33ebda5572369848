#include <rubato/numerics/formula_enclosure.hpp>
#include <rubato/numerics/formula_functions.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::numerics {
namespace {

using S = IntervalSeries;

const Interval no{0.0, 0.0}, yes{1.0, 1.0}, perhaps{0.0, 1.0};

bool is_true(const Interval& a) { return !a.is_empty() && !a.has(0.0); }
bool is_false(const Interval& a) { return a.low == 0.0 && a.high == 0.0; }

/// A value that is constant where it is known, and jumps where it is not.
S steps(const Interval& value, int n) {
  S result;
  result.c[0] = value;
  return value.low == value.high ? result : series::unknown_from(result, 1, n);
}

}  // namespace

FormulaEnclosure::FormulaEnclosure(const Formula& formula, double others)
    : nodes_(formula.tree().nodes), others_(others) {
  values_.resize(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    Shape shape = node.kind == Kind::time    ? Shape::of_time
                  : node.kind == Kind::other ? Shape::of_others
                                             : Shape::constant;
    for (const int part : {node.first, node.second, node.third})
      if (part >= 0) shape = std::max(shape, shapes_[static_cast<std::size_t>(part)]);
    shapes_.push_back(shape);
    if (shape == Shape::constant) values_[i] = value_of(node, {}, S::most);
  }
  choose({whole()});
}

std::vector<int> FormulaEnclosure::parts_of_time() const {
  std::vector<int> parts, open{whole()};
  while (!open.empty()) {
    const int i = open.back();
    open.pop_back();
    if (i < 0) continue;
    const Shape shape = shapes_[static_cast<std::size_t>(i)];
    const Node& node = nodes_[static_cast<std::size_t>(i)];
    if (shape == Shape::of_time) parts.push_back(i);
    if (shape == Shape::of_others) open.insert(open.end(), {node.first, node.second, node.third});
  }
  return parts;
}

void FormulaEnclosure::choose(const std::vector<int>& parts) {
  std::vector<char> is_wanted(nodes_.size(), 0);
  for (const int part : parts)
    if (part >= 0) is_wanted[static_cast<std::size_t>(part)] = 1;
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    if (!is_wanted[i]) continue;
    const Node& node = nodes_[i];
    for (const int part : {node.first, node.second, node.third})
      if (part >= 0) is_wanted[static_cast<std::size_t>(part)] = 1;
  }
  wanted_.clear();
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (is_wanted[i] && shapes_[i] != Shape::constant) wanted_.push_back(static_cast<int>(i));
}

void FormulaEnclosure::evaluate(const Interval& t, int order) {
  for (const int i : wanted_)
    values_[static_cast<std::size_t>(i)] = value_of(nodes_[static_cast<std::size_t>(i)], t, order);
}

IntervalSeries FormulaEnclosure::value_of(const Node& node, const Interval& t, int n) const {
  if (node.kind == Kind::constant) return series::constant(node.constant);
  if (node.kind == Kind::time) return series::time(t);
  if (node.kind == Kind::other) return series::constant(others_);
  const S& a = of(node.first);
  const Interval& u = a.c[0];
  switch (node.kind) {
    case Kind::negative:
      return series::scaled(-1.0, a, n);
    case Kind::function:
      return node.function->over_interval(a, n);
    case Kind::magnitude:
      if (u.is_empty() || u.low >= 0.0) return a;
      if (u.high <= 0.0) return series::scaled(-1.0, a, n);
      {
        S both = series::either(a, series::scaled(-1.0, a, n), n);
        both.c[0] = {0.0, u.size()};
        return series::unknown_from(both, 2, n);
      }
    case Kind::direction:
      if (u.is_empty()) return series::constant(0.0);
      return steps({u.low > 0.0 ? 1.0 : u.low < 0.0 ? -1.0 : 0.0, u.high > 0.0 ? 1.0 : u.high < 0.0 ? -1.0 : 0.0}, n);
    case Kind::rounded:
      if (u.is_empty()) return steps(u, n);
      return steps({std::floor(u.low + 0.5), std::floor(u.high + 0.5)}, n);
    case Kind::choice: {
      // What is no number counts as true.
      if (u.is_empty() || is_true(u)) return of(node.second);
      if (is_false(u)) return of(node.third);
      return series::unknown_from(series::either(of(node.second), of(node.third), n), 1, n);
    }
    default:
      break;
  }
  const S& b = of(node.second);
  const auto is_constant = [&](int part) { return shapes_[static_cast<std::size_t>(part)] == Shape::constant; };
  switch (node.kind) {
    case Kind::sum:
      return series::sum(a, b, n);
    case Kind::difference:
      return series::difference(a, b, n);
    case Kind::product:
      if (is_constant(node.first) && !u.is_empty()) return series::scaled(u.low, b, n);
      if (is_constant(node.second) && !b.c[0].is_empty()) return series::scaled(b.c[0].low, a, n);
      return series::product(a, b, n);
    case Kind::quotient:
      return series::quotient(a, b, n);
    case Kind::power:
      return series::power(a, b, n);
    case Kind::angle:
      return series::angle(a, b, n);
    default:
      return compared(node, n);
  }
}

IntervalSeries FormulaEnclosure::compared(const Node& node, int n) const {
  const S &a = of(node.first), &b = of(node.second);
  const Interval &u = a.c[0], &v = b.c[0];
  if (node.kind == Kind::least || node.kind == Kind::greatest) {
    const bool is_least = node.kind == Kind::least;
    if (u.is_empty() || v.is_empty()) return a;
    if (is_least ? u.high <= v.low : u.low >= v.high) return a;
    if (is_least ? v.high <= u.low : v.low >= u.high) return b;
    S both = series::either(a, b, n);
    both.c[0] = is_least ? Interval{std::min(u.low, v.low), std::min(u.high, v.high)}
                         : Interval{std::max(u.low, v.low), std::max(u.high, v.high)};
    return series::unknown_from(both, 2, n);
  }
  const auto truth = [&](bool is_sure, bool is_impossible) {
    return steps(is_sure ? yes : is_impossible ? no : perhaps, n);
  };
  if (node.kind == Kind::both) return truth(is_true(u) && is_true(v), is_false(u) || is_false(v));
  if (node.kind == Kind::either) return truth(is_true(u) || is_true(v), is_false(u) && is_false(v));
  // Comparisons with what is no number are false.
  if (u.is_empty() || v.is_empty()) return steps(node.kind == Kind::unequal ? yes : no, n);
  const bool are_one = u.low == u.high && v.low == v.high && u.low == v.low,
             are_apart = u.high < v.low || v.high < u.low;
  switch (node.kind) {
    case Kind::less:
      return truth(u.high < v.low, u.low >= v.high);
    case Kind::less_or_equal:
      return truth(u.high <= v.low, u.low > v.high);
    case Kind::greater:
      return truth(u.low > v.high, u.high <= v.low);
    case Kind::greater_or_equal:
      return truth(u.low >= v.high, u.high < v.low);
    case Kind::equal:
      return truth(are_one, are_apart);
    default:
      return truth(are_apart, are_one);
  }
}

}  // namespace rubato::numerics
