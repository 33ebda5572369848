#include <rubato/core/error.hpp>
#include <rubato/core/excerpt.hpp>
#include <rubato/numerics/formula_functions.hpp>
#include <rubato/numerics/formula_slopes.hpp>
#include <rubato/numerics/time_formula.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

namespace rubato::numerics {
namespace {

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

D truth(bool is_true) { return {is_true ? 1.0 : 0.0, 0.0, 0.0}; }

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

}  // namespace

/// Descends through a text that Expression has accepted, by muParser's precedences: `? :`, ||, &&, comparisons, + -,
/// * / and signs, ^ (from the right).
class TimeFormulaParser {
 public:
  using Kind = TimeFormula::Kind;
  using Node = TimeFormula::Node;

  TimeFormulaParser(TimeFormula& formula, const Parameters& parameters, const std::vector<std::string>& others)
      : formula_(formula), text_(formula.text_), parameters_(parameters), others_(others) {}

  void parse() {
    (void)choice();
    if (!is_at_end()) refuse();
  }

  /// The other values, and by which of them is differentiated instead of by t.
  struct Others {
    std::span<const double> values;
    std::size_t by = 0;
  };
  /// A node and its derivatives.
  /// @param others  none: they have no value
  static double slope(const TimeFormula& formula, double t, const Others& others) {
    return evaluate(formula, static_cast<int>(formula.nodes_.size()) - 1, t, 0, &others).rate;
  }
  static D evaluate(const TimeFormula& formula, int index, double t, int direction, const Others* others);

 private:
  [[noreturn]] void refuse() const {
    throw InvalidInput("the derivative of \"" + excerpt(text_) + "\" with respect to t is not known from character " +
                       std::to_string(at_ + 1) + " on; give the values in a table");
  }
  int add(Kind kind, int first = -1, int second = -1, int third = -1) {
    Node node;
    node.kind = kind;
    node.first = first;
    node.second = second;
    node.third = third;
    formula_.nodes_.push_back(node);
    return static_cast<int>(formula_.nodes_.size()) - 1;
  }
  int add_constant(double value) {
    const int node = add(Kind::constant);
    formula_.nodes_.back().constant = value;
    return node;
  }

  void skip_blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  bool is_at_end() {
    skip_blanks();
    return at_ == text_.size();
  }
  bool takes(const std::string& token) {
    skip_blanks();
    if (text_.compare(at_, token.size(), token) != 0) return false;
    at_ += token.size();
    return true;
  }
  void require(const std::string& token) {
    if (!takes(token)) refuse();
  }

  int choice() {
    const int condition = either();
    if (!takes("?")) return condition;
    const int yes = choice();
    require(":");
    const int no = choice();
    return add(Kind::choice, condition, yes, no);
  }
  int either() {
    int node = both();
    while (takes("||")) {
      const int other = both();
      node = add(Kind::either, node, other);
    }
    return node;
  }
  int both() {
    int node = comparison();
    while (takes("&&")) {
      const int other = comparison();
      node = add(Kind::both, node, other);
    }
    return node;
  }
  int comparison() {
    static const std::array<std::pair<const char*, Kind>, 6> kinds{{{"<=", Kind::less_or_equal},
                                                                    {">=", Kind::greater_or_equal},
                                                                    {"==", Kind::equal},
                                                                    {"!=", Kind::unequal},
                                                                    {"<", Kind::less},
                                                                    {">", Kind::greater}}};
    int node = sum();
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (const auto& [token, kind] : kinds) {
        if (!takes(token)) continue;
        const int other = sum();
        node = add(kind, node, other);
        goes_on = true;
        break;
      }
    }
    return node;
  }
  int sum() {
    int node = term();
    for (;;) {
      const bool is_plus = takes("+");
      if (!is_plus && !takes("-")) return node;
      const int other = term();
      node = add(is_plus ? Kind::sum : Kind::difference, node, other);
    }
  }
  int term() {
    int node = with_sign();
    for (;;) {
      const bool is_times = takes("*");
      if (!is_times && !takes("/")) return node;
      const int other = with_sign();
      node = add(is_times ? Kind::product : Kind::quotient, node, other);
    }
  }
  int with_sign() {
    bool is_negative = false;
    for (;;) {
      const bool is_minus = takes("-");
      if (!is_minus && !takes("+")) break;
      is_negative = is_negative != is_minus;
    }
    int node = primary();
    if (takes("^")) {
      const int exponent = with_sign();
      node = add(Kind::power, node, exponent);
    }
    return is_negative ? add(Kind::negative, node) : node;
  }
  int primary() {
    if (takes("(")) {
      const int node = choice();
      require(")");
      return node;
    }
    skip_blanks();
    if (at_ < text_.size() && (std::isdigit(static_cast<unsigned char>(text_[at_])) || text_[at_] == '.')) {
      char* end = nullptr;
      const double value = std::strtod(text_.c_str() + at_, &end);
      at_ = static_cast<std::size_t>(end - text_.c_str());
      return add_constant(value);
    }
    const std::size_t start = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_')) ++at_;
    const std::string name = text_.substr(start, at_ - start);
    if (name.empty()) refuse();
    if (takes("(")) return call(name, start);
    if (name == "t") return add(Kind::time);
    if (name == "pi") return add_constant(std::numbers::pi);
    for (const auto& [known, value] : parameters_)
      if (known == name) return add_constant(value);
    if (const auto found = std::find(others_.begin(), others_.end(), name); found != others_.end()) {
      const int node = add(Kind::other);
      formula_.nodes_.back().constant = static_cast<double>(found - others_.begin());  // its number
      return node;
    }
    at_ = start;
    refuse();
  }
  int call(const std::string& name, std::size_t start) {
    std::vector<int> arguments{choice()};
    while (takes(",")) arguments.push_back(choice());
    require(")");
    const auto fold = [&](Kind kind) {
      int node = arguments.front();
      for (std::size_t i = 1; i < arguments.size(); ++i) node = add(kind, node, arguments[i]);
      return node;
    };
    if (name == "min") return fold(Kind::least);
    if (name == "max") return fold(Kind::greatest);
    if (name == "sum") return fold(Kind::sum);
    if (name == "avg") {
      const int total = fold(Kind::sum);
      const int count = add_constant(static_cast<double>(arguments.size()));
      return add(Kind::quotient, total, count);
    }
    if (name == "atan2" && arguments.size() == 2) return add(Kind::angle, arguments[0], arguments[1]);
    if (arguments.size() == 1) {
      if (name == "abs") return add(Kind::magnitude, arguments[0]);
      if (name == "sign") return add(Kind::direction, arguments[0]);
      if (name == "rint") return add(Kind::rounded, arguments[0]);
    }
    const auto& functions = formula_functions();
    const auto function =
        std::find_if(functions.begin(), functions.end(), [&](const FormulaFunction& one) { return name == one.name; });
    if (function == functions.end() || arguments.size() != 1) {
      at_ = start;
      refuse();
    }
    const int node = add(Kind::function, arguments[0]);
    formula_.nodes_.back().function = function->of;
    return node;
  }

  TimeFormula& formula_;
  const std::string& text_;
  const Parameters& parameters_;
  const std::vector<std::string>& others_;
  std::size_t at_ = 0;
};

TimeFormula::TimeFormula(std::string text, const Parameters& parameters, std::vector<std::string> others)
    : text_(std::move(text)) {
  Parameters all = parameters;
  for (const std::string& name : others) all.emplace_back(name, 0.0);
  require_expression(text_, all, true);
  TimeFormulaParser(*this, parameters, others).parse();
}

double FormulaSlopes::operator()(std::size_t other, double t, std::span<const double> values) const {
  const TimeFormulaParser::Others others{values, other};
  return TimeFormulaParser::slope(formula_, t, others);
}

TimeDerivatives TimeFormula::operator()(double t) const { return at(static_cast<int>(nodes_.size()) - 1, t, 0); }

TimeDerivatives TimeFormula::from_left(double t) const { return at(static_cast<int>(nodes_.size()) - 1, t, -1); }

TimeDerivatives TimeFormula::from_right(double t) const { return at(static_cast<int>(nodes_.size()) - 1, t, 1); }

TimeDerivatives TimeFormula::at(int index, double t, int direction) const {
  return TimeFormulaParser::evaluate(*this, index, t, direction, nullptr);
}

D TimeFormulaParser::evaluate(const TimeFormula& formula, int index, double t, int direction, const Others* others) {
  const Node& node = formula.nodes_[static_cast<std::size_t>(index)];
  if (node.kind == Kind::constant) return {node.constant, 0.0, 0.0};
  if (node.kind == Kind::time) return {t, others ? 0.0 : 1.0, 0.0};
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (node.kind == Kind::other) {
    if (!others) return {unknown, unknown, unknown};
    const std::size_t which = static_cast<std::size_t>(node.constant);
    return {others->values[which], which == others->by ? 1.0 : 0.0, 0.0};
  }
  const D a = evaluate(formula, node.first, t, direction, others);
  switch (node.kind) {
    case Kind::negative:
      return {-a.value, -a.rate, -a.second_rate};
    case Kind::function:
      return chain(node.function(a.value), a);
    case Kind::magnitude: {
      const double sign = order(a, {}, t, direction) == -1 ? -1.0 : 1.0;
      return {std::abs(a.value), sign * a.rate, sign * a.second_rate};
    }
    case Kind::direction: {
      const int sign = order(a, {}, t, direction);
      return {sign == unordered ? 0.0 : sign, 0.0, 0.0};
    }
    case Kind::rounded: {
      const double nearest = std::floor(a.value + 0.5), step = std::floor(a.value) + 0.5;
      if (direction == 0) return {nearest, 0.0, 0.0};
      // At the step between two integers the side tells.
      const int side = order(a, {step, 0.0, 0.0}, t, direction);
      return {side == unordered ? nearest : side < 0 ? step - 0.5 : step + 0.5, 0.0, 0.0};
    }
    case Kind::choice:
      return evaluate(formula, a.value != 0.0 ? node.second : node.third, t, direction, others);
    default:
      break;
  }
  const D b = evaluate(formula, node.second, t, direction, others);
  switch (node.kind) {
    case Kind::sum:
      return {a.value + b.value, a.rate + b.rate, a.second_rate + b.second_rate};
    case Kind::difference:
      return {a.value - b.value, a.rate - b.rate, a.second_rate - b.second_rate};
    case Kind::product:
      return product(a, b);
    case Kind::quotient:
      return quotient(a, b);
    case Kind::power:
      return power(a, b);
    case Kind::angle:
      return atan2_of(a, b);
    // Both are continuous: at a switch only the derivatives have sides.
    case Kind::least: {
      const D& branch = order(b, a, t, direction) == -1 ? b : a;
      return {b.value < a.value ? b.value : a.value, branch.rate, branch.second_rate};
    }
    case Kind::greatest: {
      const D& branch = order(b, a, t, direction) == 1 ? b : a;
      return {b.value > a.value ? b.value : a.value, branch.rate, branch.second_rate};
    }
    case Kind::both:
      return truth(a.value != 0.0 && b.value != 0.0);
    case Kind::either:
      return truth(a.value != 0.0 || b.value != 0.0);
    default:
      break;
  }
  const int sign = order(a, b, t, direction);
  switch (node.kind) {
    case Kind::less:
      return truth(sign == -1);
    case Kind::less_or_equal:
      return truth(sign == -1 || sign == 0);
    case Kind::greater:
      return truth(sign == 1);
    case Kind::greater_or_equal:
      return truth(sign == 1 || sign == 0);
    case Kind::equal:
      return truth(sign == 0);
    default:
      return truth(sign != 0);
  }
}

}  // namespace rubato::numerics
