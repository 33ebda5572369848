#pragma once

#include <rubato/numerics/formula_functions.hpp>

#include <string>
#include <utility>
#include <vector>

namespace rubato::numerics {

/// Named values, in the order of the file.
using Parameters = std::vector<std::pair<std::string, double>>;

/// A formula as it was read: its operations as a tree, which searches follow, and as a program for a stack, which is
/// evaluated.
struct FormulaTree {
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
    choice,
    otherwise,  // of programs only: takes a number off the stack, and goes on elsewhere where that is 0
    leap        // of programs only: goes on elsewhere
  };
  struct Node {
    Kind kind = Kind::constant;
    double constant = 0.0;                      ///< of `other` its number
    const FormulaFunction* function = nullptr;  ///< of `function`
    int first = -1, second = -1, third = -1;    ///< what it is made of, which comes before it; -1: nothing
    int begin = 0, end = 0;                     ///< the part of the program that evaluates it
  };
  /// Puts a number on the stack, or one in place of those that it takes.
  struct Instruction {
    Kind kind = Kind::constant;
    int target = 0;  ///< of `otherwise` and `leap`, the instruction; of `other`, its number
    double constant = 0.0;
    const FormulaFunction* function = nullptr;
  };

  std::vector<Node> nodes;  ///< the last is the whole
  std::vector<Instruction> program;
  int depth = 0;  ///< of the stack, at most `deepest`
  static constexpr int deepest = 256;
};

/// Descends through a text, from the loosest to the tightest: `? :`, ||, &&, comparisons, + -, * /, signs, ^ (from the
/// right). Throws InvalidInput whose message says what is wrong and at which character of the text (from 1), with the
/// nearest known name where a name is unknown.
/// @param of_time  whether `t` is known
/// @param others   names of further values
FormulaTree parse_formula(const std::string& text, const Parameters& parameters, bool of_time,
                          const std::vector<std::string>& others);

}  // namespace rubato::numerics
