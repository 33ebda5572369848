#include <rubato/core/error.hpp>
#include <rubato/numerics/formula.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace rubato::numerics {
namespace {

using Kind = FormulaTree::Kind;
using D = TimeDerivatives;

D product(const D& a, const D& b) {
  return {a.value * b.value, a.rate * b.value + a.value * b.rate,
          a.second_rate * b.value + 2.0 * a.rate * b.rate + a.value * b.second_rate};
}

D quotient(const D& a, const D& b) {
  D result;
  result.value = a.value / b.value;
  result.rate = (a.rate - result.value * b.rate) / b.value;
  result.second_rate = (a.second_rate - 2.0 * result.rate * b.rate - result.value * b.second_rate) / b.value;
  return result;
}

/// f(a), with f and its derivatives at a.
D chain(const D& f, const D& a) {
  return {f.value, f.rate * a.rate, f.second_rate * a.rate * a.rate + f.rate * a.second_rate};
}

D power(const D& a, const D& b) {
  const double value = std::pow(a.value, b.value);
  if (b.rate == 0.0 && b.second_rate == 0.0) {
    const double n = b.value;
    // A factor of zero rules, whatever a negative power of zero is.
    const double first = n == 0.0 ? 0.0 : n * std::pow(a.value, n - 1.0);
    const double second = n == 0.0 || n == 1.0 ? 0.0 : n * (n - 1.0) * std::pow(a.value, n - 2.0);
    return chain({value, first, second}, a);
  }
  const double log = std::log(a.value);
  const D exponent = product(b, chain({log, 1.0 / a.value, -1.0 / (a.value * a.value)}, a));
  return {value, value * exponent.rate, value * (exponent.rate * exponent.rate + exponent.second_rate)};
}

D atan2_of(const D& y, const D& x) {
  // d/dt atan2(y, x) = (y' x - y x')/(x^2 + y^2)
  const double square = x.value * x.value + y.value * y.value;
  const double turning = y.rate * x.value - y.value * x.rate;
  const double rate = turning / square;
  return {std::atan2(y.value, x.value), rate,
          (y.second_rate * x.value - y.value * x.second_rate - 2.0 * rate * (x.value * x.rate + y.value * y.rate)) /
              square};
}

/// Of t and of what is compared: this near to a switch counts as at it. Twice what add_switches takes for the same
/// time.
constexpr double at_switch = 8.0 * std::numeric_limits<double>::epsilon();

int sign_of(double x) { return x < 0.0 ? -1 : x > 0.0 ? 1 : 0; }

/// The sign of a - b, at a switch just before or after it; `unordered` where one is no number.
constexpr int unordered = 2;
int order(const D& a, const D& b, double t, int direction) {
  const double gap = a.value - b.value, rate = a.rate - b.rate, second_rate = a.second_rate - b.second_rate;
  const double near = at_switch * (std::abs(a.value) + std::abs(b.value) + std::abs(t * rate));
  if (direction != 0 && std::abs(gap) <= near) {
    if (rate != 0.0) return direction * sign_of(rate);
    if (second_rate != 0.0) return sign_of(second_rate);
  }
  return a.value < b.value ? -1 : a.value > b.value ? 1 : a.value == b.value ? 0 : unordered;
}

int order(double a, double b) { return a < b ? -1 : a > b ? 1 : a == b ? 0 : unordered; }

/// What a program needs besides the tree, for a value alone.
struct Values {
  using Real = double;
  double t;
  std::span<const double> others;

  double constant(double value) const { return value; }
  double time() const { return t; }
  double other(std::size_t which) const {
    return which < others.size() ? others[which] : std::numeric_limits<double>::quiet_NaN();
  }
  static double value(double a) { return a; }
  static double negative(double a) { return -a; }
  static double sum(double a, double b) { return a + b; }
  static double difference(double a, double b) { return a - b; }
  static double product(double a, double b) { return a * b; }
  static double quotient(double a, double b) { return a / b; }
  static double power(double a, double b) { return std::pow(a, b); }
  static double angle(double y, double x) { return std::atan2(y, x); }
  static double function(const FormulaFunction& f, double a) { return f.value(a); }
  static double magnitude(double a) { return std::abs(a); }
  static double step(double value) { return value; }
  static double rounded(double a) { return std::floor(a + 0.5); }
  static int compared(double a, double b) { return order(a, b); }
  static double least(double a, double b) { return b < a ? b : a; }
  static double greatest(double a, double b) { return b > a ? b : a; }
};

/// The same, with the first derivative by one of the further values.
struct Slopes {
  using Real = ValueAndSlope;
  double t;
  std::span<const double> others;
  std::size_t by;

  static Real constant(double value) { return {value, 0.0}; }
  Real time() const { return {t, 0.0}; }
  Real other(std::size_t which) const {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    if (which >= others.size()) return {unknown, unknown};
    return {others[which], which == by ? 1.0 : 0.0};
  }
  static double value(const Real& a) { return a.value; }
  static Real negative(const Real& a) { return {-a.value, -a.slope}; }
  static Real sum(const Real& a, const Real& b) { return {a.value + b.value, a.slope + b.slope}; }
  static Real difference(const Real& a, const Real& b) { return {a.value - b.value, a.slope - b.slope}; }
  static Real product(const Real& a, const Real& b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
  static Real quotient(const Real& a, const Real& b) {
    const double value = a.value / b.value;
    return {value, (a.slope - value * b.slope) / b.value};
  }
  static Real power(const Real& a, const Real& b) {
    const double value = std::pow(a.value, b.value);
    if (b.slope != 0.0) return {value, value * (b.slope * std::log(a.value) + b.value * a.slope / a.value)};
    // A factor of zero rules, whatever a negative power of zero is.
    if (b.value == 0.0) return {value, 0.0};
    const bool in_range = value != 0.0 && std::isfinite(value);
    return {value, b.value * (in_range ? value / a.value : std::pow(a.value, b.value - 1.0)) * a.slope};
  }
  static Real angle(const Real& y, const Real& x) {
    return {std::atan2(y.value, x.value),
            (y.slope * x.value - y.value * x.slope) / (x.value * x.value + y.value * y.value)};
  }
  static Real function(const FormulaFunction& f, const Real& a) {
    const D outer = f.derivatives(a.value);
    return {outer.value, outer.rate * a.slope};
  }
  static Real magnitude(const Real& a) { return a.value < 0.0 ? negative(a) : Real{std::abs(a.value), a.slope}; }
  static Real step(double value) { return {value, 0.0}; }
  static Real rounded(const Real& a) { return step(std::floor(a.value + 0.5)); }
  static int compared(const Real& a, const Real& b) { return order(a.value, b.value); }
  static Real least(const Real& a, const Real& b) { return b.value < a.value ? b : a; }
  static Real greatest(const Real& a, const Real& b) { return b.value > a.value ? b : a; }
};

/// The same, with the derivatives by t.
struct Derivatives {
  using Real = D;
  double t;
  int direction = 0;  // of a limit

  static D constant(double value) { return {value, 0.0, 0.0}; }
  D time() const { return {t, 1.0, 0.0}; }
  static D other(std::size_t) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    return {unknown, unknown, unknown};
  }
  static double value(const D& a) { return a.value; }
  static D negative(const D& a) { return {-a.value, -a.rate, -a.second_rate}; }
  static D sum(const D& a, const D& b) { return {a.value + b.value, a.rate + b.rate, a.second_rate + b.second_rate}; }
  static D difference(const D& a, const D& b) {
    return {a.value - b.value, a.rate - b.rate, a.second_rate - b.second_rate};
  }
  static D product(const D& a, const D& b) { return numerics::product(a, b); }
  static D quotient(const D& a, const D& b) { return numerics::quotient(a, b); }
  static D power(const D& a, const D& b) { return numerics::power(a, b); }
  static D angle(const D& y, const D& x) { return atan2_of(y, x); }
  static D function(const FormulaFunction& f, const D& a) { return chain(f.derivatives(a.value), a); }
  D magnitude(const D& a) const {
    const double sign = compared(a, {}) == -1 ? -1.0 : 1.0;
    return {std::abs(a.value), sign * a.rate, sign * a.second_rate};
  }
  static D step(double value) { return {value, 0.0, 0.0}; }
  D rounded(const D& a) const {
    const double nearest = std::floor(a.value + 0.5), level = std::floor(a.value) + 0.5;
    if (direction == 0) return step(nearest);
    // At the step between two integers the side tells.
    const int side = compared(a, step(level));
    return step(side == unordered ? nearest : side < 0 ? level - 0.5 : level + 0.5);
  }
  int compared(const D& a, const D& b) const { return order(a, b, t, direction); }
  // Both are continuous: at a switch only the derivatives have sides.
  D least(const D& a, const D& b) const {
    const D& branch = compared(b, a) == -1 ? b : a;
    return {b.value < a.value ? b.value : a.value, branch.rate, branch.second_rate};
  }
  D greatest(const D& a, const D& b) const {
    const D& branch = compared(b, a) == 1 ? b : a;
    return {b.value > a.value ? b.value : a.value, branch.rate, branch.second_rate};
  }
};

bool is_true_of(Kind comparison, int sign) {
  switch (comparison) {
    case Kind::less:
      return sign == -1;
    case Kind::less_or_equal:
      return sign == -1 || sign == 0;
    case Kind::greater:
      return sign == 1;
    case Kind::greater_or_equal:
      return sign == 1 || sign == 0;
    case Kind::equal:
      return sign == 0;
    default:
      return sign != 0;
  }
}

template <class Algebra, std::size_t depth>
typename Algebra::Real run(const FormulaTree& tree, int begin, int end, const Algebra& algebra) {
  std::array<typename Algebra::Real, depth> stack;
  auto top = stack.data();  // behind the uppermost number
  for (int i = begin; i < end; ++i) {
    const auto& instruction = tree.program[static_cast<std::size_t>(i)];
    // What takes two has them at top[-1] and top[0] after its case has lowered the top.
    switch (instruction.kind) {
      case Kind::constant:
        *top++ = algebra.constant(instruction.constant);
        break;
      case Kind::time:
        *top++ = algebra.time();
        break;
      case Kind::other:
        *top++ = algebra.other(static_cast<std::size_t>(instruction.target));
        break;
      case Kind::negative:
        top[-1] = algebra.negative(top[-1]);
        break;
      case Kind::function:
        top[-1] = algebra.function(*instruction.function, top[-1]);
        break;
      case Kind::magnitude:
        top[-1] = algebra.magnitude(top[-1]);
        break;
      case Kind::direction: {
        const int sign = algebra.compared(top[-1], algebra.constant(0.0));
        top[-1] = algebra.step(sign == unordered ? 0.0 : sign);
        break;
      }
      case Kind::rounded:
        top[-1] = algebra.rounded(top[-1]);
        break;
      case Kind::otherwise:
        if (!(algebra.value(*--top) != 0.0)) i = instruction.target - 1;
        break;
      case Kind::leap:
        i = instruction.target - 1;
        break;
      case Kind::sum:
        --top;
        top[-1] = algebra.sum(top[-1], *top);
        break;
      case Kind::difference:
        --top;
        top[-1] = algebra.difference(top[-1], *top);
        break;
      case Kind::product:
        --top;
        top[-1] = algebra.product(top[-1], *top);
        break;
      case Kind::quotient:
        --top;
        top[-1] = algebra.quotient(top[-1], *top);
        break;
      case Kind::power:
        --top;
        top[-1] = algebra.power(top[-1], *top);
        break;
      case Kind::angle:
        --top;
        top[-1] = algebra.angle(top[-1], *top);
        break;
      case Kind::least:
        --top;
        top[-1] = algebra.least(top[-1], *top);
        break;
      case Kind::greatest:
        --top;
        top[-1] = algebra.greatest(top[-1], *top);
        break;
      case Kind::both:
        --top;
        top[-1] = algebra.step(algebra.value(top[-1]) != 0.0 && algebra.value(*top) != 0.0);
        break;
      case Kind::either:
        --top;
        top[-1] = algebra.step(algebra.value(top[-1]) != 0.0 || algebra.value(*top) != 0.0);
        break;
      case Kind::choice:
        break;  // of trees only
      default:
        --top;
        top[-1] = algebra.step(is_true_of(instruction.kind, algebra.compared(top[-1], *top)));
        break;
    }
  }
  return top[-1];
}

template <class Algebra>
typename Algebra::Real evaluate(const FormulaTree& tree, int node, const Algebra& algebra) {
  const auto& wanted = tree.nodes[static_cast<std::size_t>(node)];
  constexpr int usual = 16;
  return tree.depth <= usual ? run<Algebra, usual>(tree, wanted.begin, wanted.end, algebra)
                             : run<Algebra, FormulaTree::deepest>(tree, wanted.begin, wanted.end, algebra);
}

bool has_kind(const FormulaTree& tree, Kind kind, double constant = 0.0) {
  return std::any_of(tree.nodes.begin(), tree.nodes.end(), [&](const FormulaTree::Node& node) {
    return node.kind == kind && (kind != Kind::other || node.constant == constant);
  });
}

}  // namespace

double Formula::operator()(double t, std::span<const double> others) const {
  return evaluate(tree_, whole(), Values{t, others});
}

double Formula::from_left(double t) const { return has_switches_ ? derivatives_from_left(t).value : (*this)(t); }

double Formula::from_right(double t) const { return has_switches_ ? derivatives_from_right(t).value : (*this)(t); }

TimeDerivatives Formula::derivatives(double t) const { return part(whole(), t, 0); }

TimeDerivatives Formula::derivatives_from_left(double t) const { return part(whole(), t, -1); }

TimeDerivatives Formula::derivatives_from_right(double t) const { return part(whole(), t, 1); }

TimeDerivatives Formula::part(int node, double t, int direction) const {
  return evaluate(tree_, node, Derivatives{t, direction});
}

ValueAndSlope Formula::with_slope(std::size_t other, double t, std::span<const double> others) const {
  return evaluate(tree_, whole(), Slopes{t, others, other});
}

bool Formula::uses_time() const { return has_kind(tree_, Kind::time); }

bool Formula::uses(std::size_t other) const { return has_kind(tree_, Kind::other, static_cast<double>(other)); }

bool is_formula_of(const Parameters& parameters, const std::string& text) {
  try {
    (void)parse_formula(text, parameters, false, {});
    return true;
  } catch (const InvalidInput&) {
    return false;
  }
}

std::vector<std::size_t> parameters_used(const std::string& text, const Parameters& parameters, bool of_time,
                                         const std::vector<std::string>& others) {
  std::vector<std::string> names;
  for (const auto& parameter : parameters) names.push_back(parameter.first);
  names.insert(names.end(), others.begin(), others.end());
  const Formula formula(text, {}, of_time, names);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (formula.uses(i)) places.push_back(i);
  return places;
}

}  // namespace rubato::numerics
