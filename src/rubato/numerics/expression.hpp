#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace rubato::numerics {

/// Named values, in the order of the file.
using Parameters = std::vector<std::pair<std::string, double>>;

/// A formula of named values and, where asked for, of the time t [s]; `pi` is known. The functions and operators are
/// those of muParser (sin, cos, exp, sqrt, abs, min, max, `a < b ? x : y`, ...).
///
/// An instance is a workspace: it must not be evaluated by two threads at once. Copies are independent.
class Expression {
 public:
  /// Throws InvalidInput whose message says what is wrong and at which character of the text (from 1), with the nearest
  /// known name where a name is unknown. A list ("1, 5") and an assignment ("a = 5") are refused.
  /// @param text        the formula
  /// @param parameters  the names it may use, with their values
  /// @param of_time     whether `t` is known
  Expression(std::string text, const Parameters& parameters, bool of_time = false);
  Expression(const Expression& other);
  Expression(Expression&&) noexcept;
  Expression& operator=(const Expression& other);
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  /// Its value; may be non-finite (division by zero, log of a negative number): the caller decides what that means.
  double operator()(double t = 0.0) const;

  /// The limits at t, which differ where a branch changes there and the derivatives of the formula are known
  /// (TimeFormula); elsewhere they are the value.
  double from_left(double t) const;
  double from_right(double t) const;
  /// The times in (from, to) at which a branch changes, as TimeFormula knows them; none where it does not.
  std::vector<double> switches(double from, double to) const;

  const std::string& text() const { return text_; }

 private:
  struct Engine;
  std::string text_;
  Parameters parameters_;
  bool of_time_ = false;
  std::unique_ptr<Engine> engine_;
};

/// Throws InvalidInput where Expression would.
void require_expression(const std::string& text, const Parameters& parameters, bool of_time = false);

/// Whether a name is one of muParser's functions, which a parameter cannot bear.
bool is_function(const std::string& name);

}  // namespace rubato::numerics
