#pragma once

#include <rubato/numerics/expression.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rubato::numerics {

/// A number that changes with time, with its first two derivatives.
struct TimeDerivatives {
  double value = 0.0, rate = 0.0, second_rate = 0.0;
};

/// A formula of named values and of the time t [s], as Expression knows it, with its derivatives with respect to t:
/// exact but for round-off, by forward differentiation of each operation (Griewank and Walther 2008, chapter 13). Where
/// a formula branches (comparisons, abs, min, max, sign, rint) they are those of the branch that is taken; a step has
/// none. Evaluates without allocating; may be used by several threads at once.
class TimeFormula {
 public:
  /// Throws InvalidInput as Expression does.
  /// @param others  names of further values that change with what moves: where a formula uses one it has no value here
  ///                (not a number), and only switches that do not depend on it are known
  TimeFormula(std::string text, const Parameters& parameters, std::vector<std::string> others = {});

  /// As it is written.
  TimeDerivatives operator()(double t) const;
  /// The limits at t: a branch that changes there, to round-off of t, is the one on that side.
  TimeDerivatives from_left(double t) const;
  TimeDerivatives from_right(double t) const;

  /// Whether it branches anywhere with t alone.
  bool has_switches() const;
  /// The times in (from, to) at which a branch changes, rising: where what is compared becomes equal, or the argument
  /// of abs or sign vanishes, or that of rint is half an integer. To round-off, and all of them, however close they
  /// are: enclosures of what is compared tell where it has no zero (formula_enclosure.hpp). None where there are more
  /// than 262,144, or where the search for them would take longer than about a second.
  std::vector<double> switches(double from, double to) const;
  const std::string& text() const { return text_; }

 private:
  friend class TimeFormulaParser;
  friend class SwitchSearch;
  using Function = TimeDerivatives (*)(double);  // value and derivatives with respect to the argument
  enum class Kind {
    constant,
    time,
    other,
    negative,
    sum,
    difference,
    product,
    quotient,
    power,
    function,
    magnitude,  // abs
    direction,  // sign
    rounded,    // rint
    angle,      // atan2
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
  /// @param direction  of a limit: -1 or 1, just before or after t; 0: at t
  TimeDerivatives at(int node, double t, int direction) const;

  std::string text_;
  std::vector<Node> nodes_;  // the last is the whole
};

/// The formula where it switches with t alone; none where it does not, or where something in it has no known
/// derivative.
/// @param others  names of values that change with what moves
std::optional<TimeFormula> switching_formula(const std::string& text, const Parameters& parameters,
                                             const std::vector<std::string>& others = {});

/// Adds to sorted times those that do not coincide with one of them or with an end, to the round-off to which formulas
/// know their switches.
/// @param switches  in (from, to)
void add_switches(const std::vector<double>& switches, double from, double to, std::vector<double>& times);

}  // namespace rubato::numerics
