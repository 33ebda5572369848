#include <rubato/numerics/formula_parity.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace rubato::numerics {
namespace {

Formula read(const std::string& text) { return {text, {{"k", 3.0}, {"n", 3.0}}, true, {"u", "rate"}}; }

TEST(FormulaParity, IsOddWhereTheOppositeMotionMakesTheOppositeValue) {
  for (const char* text : {"u",
                           "-u",
                           "k*u + 2*u^3",
                           "u^n",
                           "u^(-3)",
                           "u^(2 + 1)",
                           "1/u",
                           "u/(1 + u^2)",
                           "sin(u)",
                           "tanh(u/0.1)*cos(rate)",
                           "u*abs(u)",
                           "abs(u)^0.5*sign(u)",
                           "sign(rate)*exp(-(rate/0.1)^2)",
                           "max(0, abs(u) - 0.2)*sign(u)",
                           "u*exp(-abs(u))",
                           "sqrt(u^2 + 1)*rate",
                           "(u^2 > 1 ? u : u^3)",
                           "(abs(u) < 1 && rate^2 < 4)*u",
                           "u*(u == 3*rate)",
                           "u*cos(7*t)",
                           "atan2(u, 2)",
                           "u*2^abs(rate)",
                           "u*rate*rate",
                           "asinh(u) + atan(rate) - 3*(u - rate)",
                           "0",
                           "0*u",
                           "u - u",
                           "u*min(u^2, 4)",
                           "u*rint(abs(rate))",
                           "avg(u, rate)",
                           "sinh(u)/cosh(u)"})
    EXPECT_TRUE(parity_of(read(text)).is_odd) << text;
}

TEST(FormulaParity, IsEvenWhereTheOppositeMotionMakesTheSameValue) {
  for (const char* text : {"1",
                           "k",
                           "t",
                           "u^2",
                           "u*rate",
                           "abs(u)",
                           "cos(u)",
                           "u^4 - 3*u*rate + t",
                           "sin(u)^2",
                           "exp(u*sin(u))",
                           "u/rate",
                           "max(u^2, abs(rate))",
                           "abs(u) > 1",
                           "u == 0",
                           "u || rate",
                           "2^abs(u)",
                           "rint(u^2)",
                           "log(abs(u))",
                           "atan2(u^2, -1)",
                           "u^0",
                           "u^-2",
                           "sign(u^2 - 1)",
                           "0",
                           "(u*rate > 0 ? u^2 : abs(rate))"})
    EXPECT_TRUE(parity_of(read(text)).is_even) << text;
}

// Each differs from both where few samples meet it, or nowhere but beyond them.
TEST(FormulaParity, IsNotClaimedWhereItIsNotSo) {
  for (const char* text : {"u + 1e-30",
                           "k*u + 50*max(0, u - 0.3)*(u < 0.5)",
                           "k*u + (u > 1e9)",
                           "u + u^2",
                           "u^2.5",
                           "u^u",
                           "2^u",
                           "exp(u)",
                           "sqrt(u)",
                           "log(u)",
                           "u > 0",
                           "u >= 0 ? u : 2*u",
                           "max(0, u)",
                           "min(u, rate)",
                           "rint(u)",
                           "u*rint(rate)",
                           "acos(u)",
                           "u + abs(rate)",
                           "u*(rate > 0)",
                           "sin(u + 1)",
                           "cos(u + 1)",
                           "tan(u + 0.3)",
                           "atan2(u, -2)",
                           "atan2(0, u)",
                           "atan2(u, rate)",
                           "u < 0 && rate < 0",
                           "u*(u == 3)",
                           "sin(t + u)",
                           "u + t",
                           "abs(u) + u",
                           "sign(u - 1)"}) {
    const Parity parity = parity_of(read(text));
    EXPECT_FALSE(parity.is_odd) << text;
    EXPECT_FALSE(parity.is_even) << text;
  }
}

/// A random formula of u, rate, t and numbers.
std::string random_formula(std::mt19937& draw, int depth) {
  const auto below = [&](int n) { return static_cast<int>(draw() % static_cast<unsigned>(n)); };
  const auto part = [&] { return random_formula(draw, depth - 1); };
  if (depth == 0 || below(8) == 0) {
    static const std::array leaves{"u", "rate", "u", "rate", "t", "0", "0.7", "-2", "1", "3"};
    return leaves[static_cast<std::size_t>(below(leaves.size()))];
  }
  static const std::array functions{"sin",  "cos",  "tan",   "asin",  "acos",  "atan", "sinh",
                                    "cosh", "tanh", "asinh", "acosh", "atanh", "log2", "log10",
                                    "log",  "ln",   "exp",   "sqrt",  "abs",   "sign", "rint"};
  static const std::array operations{"+", "-",  "*", "/ u + ", "+",  "-",  "*",  "/ (1 + rate^2) - ",
                                     "<", "<=", ">", ">=",     "==", "!=", "&&", "||"};
  static const std::array of_two{"min", "max", "atan2", "sum", "avg"};
  switch (below(8)) {
    case 0:
    case 1:
      return fmt::format("{}({})", functions[static_cast<std::size_t>(below(functions.size()))], part());
    case 2:
      return fmt::format("{}({}, {})", of_two[static_cast<std::size_t>(below(of_two.size()))], part(), part());
    case 3:
      return fmt::format("({} ? {} : {})", part(), part(), part());
    case 4:
      return fmt::format("(({})^{})", part(), below(2) == 0 ? std::to_string(below(5)) : "(" + part() + ")");
    default:
      return fmt::format("(({}) {} ({}))", part(), operations[static_cast<std::size_t>(below(operations.size()))],
                         part());
  }
}

// What is claimed holds for all values. Nothing is divided by zero, whose sign would decide.
TEST(FormulaParity, OfRandomFormulasHoldsToTheLastBit) {
  std::mt19937 draw(20);
  int odd = 0, even = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string text = random_formula(draw, 4);
    const Formula formula = read(text);
    const Parity parity = parity_of(formula);
    odd += parity.is_odd && !parity.is_even;
    even += parity.is_even && !parity.is_odd;
    for (const auto& [u, rate] : {std::array{0.3, -0.1}, {1.7, 2.9}, {-0.02, 0.6}, {3.0, 1.0}, {0.5, 0.5}}) {
      const double there = formula(0.4, std::array{u, rate}), back = formula(0.4, std::array{-u, -rate});
      if (!std::isfinite(there) || !std::isfinite(back)) continue;
      if (parity.is_odd) {
        EXPECT_EQ(back, -there) << text << " at " << u << ", " << rate;
      }
      if (parity.is_even) {
        EXPECT_EQ(back, there) << text << " at " << u << ", " << rate;
      }
    }
  }
  EXPECT_GT(odd, 500);
  EXPECT_GT(even, 500);
}

// A sum of many terms asks for no stack.
TEST(FormulaParity, OfALongSumIsFound) {
  std::string text = "u";
  for (int i = 0; i < 50000; ++i) text += " + u^3";
  EXPECT_TRUE(parity_of(read(text)).is_odd);
  EXPECT_FALSE(parity_of(read(text + " + u^2")).is_odd);
}

}  // namespace
}  // namespace rubato::numerics
