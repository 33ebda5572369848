#pragma once

#include <rubato/numerics/formula_tree.hpp>
#include <rubato/numerics/time_derivatives.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace rubato::numerics {

struct ValueAndSlope {
  double value = 0.0, slope = 0.0;
};

/// A formula of named values (`pi` is known) and, where asked for, of the time t [s] and of further values that change
/// from one evaluation to the next.
///
/// Derivatives are exact but for round-off, by forward differentiation of each operation (Griewank and Walther 2008,
/// chapter 13). Where a formula branches (comparisons, abs, min, max, sign, rint) they are those of the branch that is
/// taken; a step has none. Evaluates without allocating; may be used by several threads at once.
class Formula {
 public:
  /// Throws InvalidInput whose message says what is wrong and at which character of the text (from 1), with the nearest
  /// known name where a name is unknown. A list ("1, 5") and an assignment ("a = 5") are refused.
  /// @param text        the formula
  /// @param parameters  the names it may use, with their values
  /// @param of_time     whether `t` is known
  /// @param others      names of the further values; a parameter of the same name goes before
  Formula(std::string text, const Parameters& parameters, bool of_time = false,
          const std::vector<std::string>& others = {});

  /// Its value; may be non-finite (division by zero, log of a negative number): the caller decides what that means.
  /// @param others  the further values, in the order of the constructor; where none are given and the formula uses one
  ///                it is not a number
  double operator()(double t = 0.0, std::span<const double> others = {}) const;
  /// The limits at t, which differ where a branch changes there, to round-off of t.
  double from_left(double t) const;
  double from_right(double t) const;

  /// With the derivatives by t, as it is written and as limits; the further values are not known.
  TimeDerivatives derivatives(double t) const;
  TimeDerivatives derivatives_from_left(double t) const;
  TimeDerivatives derivatives_from_right(double t) const;
  /// Its value with the derivative by one of the further values.
  /// @param other   a number in the order of the constructor
  /// @param others  all of them
  ValueAndSlope with_slope(std::size_t other, double t, std::span<const double> others) const;

  bool uses_time() const;
  /// @param other  a number in the order of the constructor
  bool uses(std::size_t other) const;

  /// Whether it branches anywhere with t alone.
  bool has_switches() const { return has_switches_; }
  /// The times in (from, to) at which a branch changes with t alone, rising: where what is compared becomes equal, or
  /// the argument of abs or sign vanishes, or that of rint is half an integer. To round-off, and all of them, however
  /// close they are: enclosures of what is compared tell where it has no zero (formula_enclosure.hpp). None where there
  /// are more than 262,144, or where the search for them would take longer than about a second.
  std::vector<double> switches(double from, double to) const;

  const std::string& text() const { return text_; }
  /// Its operations, for searches.
  const FormulaTree& tree() const { return tree_; }
  /// A part of it with its derivatives by t.
  /// @param node       of the tree
  /// @param direction  of a limit: -1 or 1, just before or after t; 0: at t
  TimeDerivatives part(int node, double t, int direction) const;

 private:
  int whole() const { return static_cast<int>(tree_.nodes.size()) - 1; }

  std::string text_;
  FormulaTree tree_;
  bool has_switches_ = false;
};

/// Whether a text is a formula of the parameters alone.
bool is_formula_of(const Parameters& parameters, const std::string& text);

/// Which of the parameters a formula uses (by place, rising). Throws InvalidInput as Formula does.
/// @param others  names of further values that it may use, which the parameters of the same name go before
std::vector<std::size_t> parameters_used(const std::string& text, const Parameters& parameters, bool of_time = false,
                                         const std::vector<std::string>& others = {});

/// Adds to sorted times those that do not coincide with one of them or with an end, to the round-off to which formulas
/// know their switches.
/// @param switches  in (from, to)
void add_switches(const std::vector<double>& switches, double from, double to, std::vector<double>& times);

}  // namespace rubato::numerics
