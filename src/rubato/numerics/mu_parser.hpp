#pragma once

#include <muParser.h>

#include <cmath>
#include <numbers>

// Private to the numerics floor.
namespace rubato::numerics {

/// muParser as formulas take it: `pi` is known and no other constant.
///
/// Its optimizer is off: it folds the constants of && and || as whole numbers, so that 0.3 || 0 would be false. That
/// costs a fifth of the time of an evaluation. Its own asinh, acosh and atanh subtract what nearly cancels:
/// asinh(-1000) has 11 digits; its log2 is a quotient, so that log2(8) is not 3.
inline void set_up(mu::Parser& parser) {
  parser.EnableOptimizer(false);
  parser.ClearConst();
  parser.DefineConst("pi", std::numbers::pi);
  using Function = double (*)(double);
  parser.DefineFun("asinh", static_cast<Function>(std::asinh));
  parser.DefineFun("acosh", static_cast<Function>(std::acosh));
  parser.DefineFun("atanh", static_cast<Function>(std::atanh));
  parser.DefineFun("log2", static_cast<Function>(std::log2));
}

}  // namespace rubato::numerics
