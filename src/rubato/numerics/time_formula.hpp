#pragma once

#include <rubato/numerics/expression.hpp>

#include <string>
#include <vector>

namespace rubato::numerics {

/// A number that changes with time, with its first two derivatives.
struct TimeDerivatives {
  double value = 0.0, rate = 0.0, second_rate = 0.0;
};

/// A formula of named values and of the time t [s], as Expression knows it, with its derivatives with respect to t:
/// exact but for round-off, by forward differentiation of each operation (Griewank and Walther 2008, chapter 13). Where
/// a formula branches (`? :`, abs, min, max, sign) they are those of the branch that is taken; a step has none.
/// Evaluates without allocating; may be used by several threads at once.
class TimeFormula {
 public:
  /// Throws InvalidInput as Expression does.
  TimeFormula(std::string text, const Parameters& parameters);

  TimeDerivatives operator()(double t) const;
  const std::string& text() const { return text_; }

 private:
  friend class TimeFormulaParser;
  using Function = TimeDerivatives (*)(double);  // value and derivatives with respect to the argument
  enum class Kind {
    constant,
    time,
    negative,
    sum,
    difference,
    product,
    quotient,
    power,
    function,
    angle,  // atan2
    least,
    greatest,
    less,
    less_or_equal,
    greater,
    greater_or_equal,
    equal,
    unequal,
    both,
    either,
    choice
  };
  struct Node {
    Kind kind = Kind::constant;
    double constant = 0.0;
    Function function = nullptr;
    int first = -1, second = -1, third = -1;
  };
  TimeDerivatives at(int node, double t) const;

  std::string text_;
  std::vector<Node> nodes_;  // the last is the whole
};

}  // namespace rubato::numerics
