#include <rubato/core/error.hpp>
#include <rubato/numerics/bound_formula.hpp>
#include <rubato/numerics/formula_slopes.hpp>
#include <rubato/numerics/time_formula.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace rubato::numerics {
namespace {

const Parameters parameters{{"speed", 20.0}, {"tau", 0.3}};

// Each operator and function of muParser once, with every precedence beside its neighbours.
const std::vector<std::string> formulas{"3",
                                        "-t^2",
                                        "2^-t^2",
                                        "(-2)^2*t",
                                        "1 - 2 - t*3/4/5",
                                        "-t*2 + +t",
                                        "t > 0.5 ? t^2 : t < 0.1 || t > 3 && 1 ? 2 : sin(t)",
                                        "speed*(t - tau*(1 - exp(-t/tau)))",
                                        "t < tau ? speed*t^2/(2*tau) : speed*(t - tau/2)",
                                        "sin(speed*t) + cos(t)^2 - tan(t/2)",
                                        "asin(t/3)+acos(t/4)+atan(t)",
                                        "sinh(t)*cosh(t) - tanh(t)",
                                        "asinh(t)+acosh(1.5+t)+atanh(t/9)",
                                        "log2(1+t) + log10(1+t)*ln(2+t) - log(3 + t)",
                                        "sqrt(1 + t^2)*abs(t - 0.7)",
                                        "min(t, 0.4, 1 - t) + max(t^2, 0.5) + sum(t, 2, t) + avg(t, 1, t^3)",
                                        "atan2(sin(3*t), 2 + cos(t))",
                                        "sign(t - 0.5)*t + rint(0.2 + t/10)",
                                        "(1 + t)^(1 + t/2)",
                                        "1.5e-1*t + .5 + pi",
                                        "(t <= 0.25) + (t >= 0.25) + (t == 0.25) + (t != 0.25)*t",
                                        "t^1 + t^0"};

TEST(TimeFormula, SaysWhatAnExpressionSays) {
  for (const std::string& text : formulas) {
    const TimeFormula formula(text, parameters);
    const Expression expression(text, parameters, true);
    for (const double t : {0.05, 0.25, 0.61, 1.3})
      EXPECT_NEAR(formula(t).value, expression(t), 1e-14 * (1.0 + std::abs(expression(t)))) << text << " at " << t;
  }
}

/// A random formula of t and tau, with numbers and all that formulas know.
class RandomFormula {
 public:
  explicit RandomFormula(unsigned seed) : random_(seed) {}

  std::string text(int depth) {
    static const std::vector<std::string> leaves{"t",    "tau", "pi", "0.3", "0",   "1",   "2",   "0.5",
                                                 "(-1)", "3",   "4",  ".25", "7.5", "1e3", "tau", "t"};
    static const std::vector<std::string> operators{"+",  "-",  "*",  "/",  "^",  "<", ">",
                                                    "<=", ">=", "==", "!=", "&&", "||"};
    static const std::vector<std::string> functions{"sin",  "cos",  "tan",   "asin",  "acos",  "atan", "sinh",
                                                    "cosh", "tanh", "asinh", "acosh", "atanh", "log2", "log10",
                                                    "log",  "ln",   "exp",   "sqrt",  "sign",  "rint", "abs"};
    static const std::vector<std::string> lists{"min", "max", "sum", "avg"};
    static const std::vector<std::string> signs{"-", "-", "- ", "+", "--", "- +"};
    if (depth == 0) return one_of(leaves);
    const auto part = [&] { return text(depth - 1); };
    switch (random_() % 8) {
      case 0:
        return one_of(functions) + "(" + part() + ")";
      case 1:
        return "(" + part() + ")";
      case 2:
        return one_of(signs) + part();
      case 3:
        return part() + " ? " + part() + " : " + part();
      case 4:
        return one_of(lists) + "(" + part() + ", " + part() + ")";
      case 5:
        return "atan2(" + part() + ", " + part() + ")";
      default:
        return part() + one_of(operators) + part();
    }
  }

 private:
  const std::string& one_of(const std::vector<std::string>& words) { return words[random_() % words.size()]; }

  std::mt19937 random_;
};

// Two engines read formulas: muParser for values, and TimeFormula for derivatives. muParser folded the constants of &&
// and || as whole numbers: `0.3 || 0` was false. Round-off of different logarithms and powers is left.
TEST(TimeFormula, SaysWhatAnExpressionSaysOfRandomFormulas) {
  EXPECT_EQ(Expression("0.3 || 0 ? 1 : 0", {})(), 1.0);
  EXPECT_EQ(Expression("0.3 && 0.2", {})(), 1.0);
  EXPECT_EQ(BoundFormula("0.3 || 0 ? 1 : 0", {}, nullptr)(), 1.0);
  RandomFormula random(11);
  int compared = 0;
  for (int i = 0; i < 5000; ++i) {
    const std::string text = random.text(1 + i % 4);
    const Expression expression(text, parameters, true);
    const TimeFormula formula(text, parameters);
    for (const double t : {0.0, 0.3, -0.7, 2.5}) {
      const double a = expression(t), b = formula(t).value;
      if (std::isnan(a) && std::isnan(b)) continue;
      ++compared;
      EXPECT_TRUE(a == b || std::abs(a - b) <= 1e-12 * (std::abs(a) + std::abs(b)))
          << text << " at " << t << ": " << a << ", " << b;
    }
  }
  EXPECT_GT(compared, 15000);
}

// Central differences of a step h are off by h^2 f'''/6, and round-off by eps/h and 4 eps/h^2: 1e-8 and 1e-6 of values
// whose time scale is 1/20 s with h = 1e-5 and 1e-4.
TEST(TimeFormula, KnowsItsDerivatives) {
  for (const std::string& text : formulas) {
    const TimeFormula formula(text, parameters);
    for (const double t : {0.05, 0.61, 1.3}) {
      const double h = 1e-5, g = 1e-4;
      const auto now = formula(t);
      const double size = 1.0 + std::abs(now.value) + 400.0 * std::abs(now.rate);
      EXPECT_NEAR(now.rate, (formula(t + h).value - formula(t - h).value) / (2.0 * h), 1e-8 * size) << text << t;
      EXPECT_NEAR(now.second_rate, (formula(t + g).value - 2.0 * now.value + formula(t - g).value) / (g * g),
                  1e-5 * (size + std::abs(now.second_rate)))
          << text << " at " << t;
    }
  }
}

TEST(TimeFormula, HasExactDerivativesOfAPowerAtZero) {
  const auto square = TimeFormula("t^2", {})(0.0);
  EXPECT_EQ(square.value, 0.0);
  EXPECT_EQ(square.rate, 0.0);
  EXPECT_EQ(square.second_rate, 2.0);
  EXPECT_EQ(TimeFormula("t^1", {})(0.0).rate, 1.0);
}

TEST(TimeFormulaFault, IsThatOfAnExpression) {
  EXPECT_THROW(TimeFormula("3*sped", parameters), InvalidInput);
  EXPECT_THROW(TimeFormula("3*(t", parameters), InvalidInput);
}

std::vector<double> switches(const std::string& text, double from = 0.0, double to = 50.0) {
  return TimeFormula(text, parameters).switches(from, to);
}

/// To round-off of the times.
void expect_times(const std::string& text, const std::vector<double>& expected, double from = 0.0, double to = 50.0) {
  const std::vector<double> found = switches(text, from, to);
  ASSERT_EQ(found.size(), expected.size()) << text;
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-15 * expected[i]) << text;
}

TEST(TimeFormulaSwitches, AreWhereWhatIsComparedBecomesEqual) {
  expect_times("t < 25 ? 0 : 1", {25.0});
  expect_times("t > 25 && t < 25.005", {25.0, 25.005});
  expect_times("(t >= 3) - (t >= 4) + 0*(t < 3)", {3.0, 4.0});
  expect_times("t < tau ? t : tau", {0.3});
  expect_times("2*(t - 1) <= speed*tau ? t : 1", {4.0});
  expect_times("t < 25 ? 0 : (t < 25.01 ? 100 : 0)", {25.0, 25.01});
  expect_times("speed < 3 ? t : 2*t", {});
  expect_times("t < 60 ? 1 : t > -1", {});
}

TEST(TimeFormulaSwitches, AreWhereFunctionsBend) {
  expect_times("abs(t - 7)", {7.0});
  expect_times("sign(7 - t)", {7.0});
  expect_times("rint(t/10)", {5.0, 15.0, 25.0, 35.0, 45.0});
  expect_times("min(t, 3, 10 - t) + max(2*t, 4)", {2.0, 3.0, 7.0});
  expect_times("max(0, 1 - abs(t - 25.005)/0.005)*200", {25.0, 25.005, 25.01});
  expect_times("abs(abs(t - 10) - 2)", {8.0, 10.0, 12.0});
}

// 1/16384 of the interval is 3 ms; the pairs of switches of the second are 0.9 ms apart.
TEST(TimeFormulaSwitches, OfCurvedArgumentsAreFound) {
  const double pi = std::numbers::pi;
  expect_times("sin(pi*t) > 0", {1.0, 2.0, 3.0, 4.0}, 0.0, 5.0);
  const double half = std::acos(1.0 - 1e-8) * 10.0 / (2.0 * pi);
  std::vector<double> expected;
  for (const double peak : {2.5, 12.5, 22.5, 32.5, 42.5}) expected.insert(expected.end(), {peak - half, peak + half});
  // The level is approached with a slope of 2 pi/10 sqrt(2e-8): its round-off moves the time by 2.5e-12.
  const std::vector<double> found = switches("sin(2*pi*t/10) > 1 - 1e-8");
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-11);
  EXPECT_EQ(switches("sin(2*pi*100*t) > 0.5").size(), 10000u);
  expect_times("exp(-t) < 1e-3", {3.0 * std::log(10.0)});
}

// No lattice of samples knows of them: the pulse is 2e-7 of the interval.
TEST(TimeFormulaSwitches, AreFoundHoweverCloseToOneAnother) {
  for (const double place : {0.3, 25.0, 31.4159, 49.99}) {
    const std::vector<double> found = switches("exp(-((t - " + std::to_string(place) + ")/1e-5)^2) > 0.5");
    ASSERT_EQ(found.size(), 2u) << place;
    const double half = 1e-5 * std::sqrt(std::log(2.0));
    EXPECT_NEAR(found[0], place - half, 1e-13);
    EXPECT_NEAR(found[1], place + half, 1e-13);
  }
  expect_times("log(t) > -3", {std::exp(-3.0)});
  expect_times("sqrt(t - 2) > 1", {3.0});
  EXPECT_EQ(switches("abs(max(0, sin(pi*t)))", 0.0, 5.0).size(), 4u);
}

TEST(TimeFormulaSwitches, HaveTheBranchOfEachSide) {
  const auto values = [](const std::string& text, double t) {
    const TimeFormula formula(text, parameters);
    return std::pair{formula.from_left(t), formula.from_right(t)};
  };
  for (const std::string text : {"t < 0.3 ? 2 : 5", "t <= 0.3 ? 2 : 5", "0.1*t < 0.03 ? 2 : 5", "t - 0.1 > 0.2 ? 5 : 2",
                                 "3.5 + 1.5*sign(t - 0.3)", "3*rint(t + 0.2) + 2"})
    for (const double t : {0.3, 0.1 * 3.0}) {  // neighbours
      EXPECT_EQ(values(text, t).first.value, 2.0) << text;
      EXPECT_EQ(values(text, t).second.value, 5.0) << text;
    }
  for (const std::string text : {"abs(t - 2)", "max(t - 2, 2 - t)", "-min(t - 2, 2 - t)", "t < 2 ? 2 - t : t - 2"}) {
    EXPECT_EQ(values(text, 2.0).first.rate, -1.0) << text;
    EXPECT_EQ(values(text, 2.0).second.rate, 1.0) << text;
    EXPECT_EQ(values(text, 2.0).first.value, 0.0) << text;
    EXPECT_EQ(values(text, 2.0).second.value, 0.0) << text;
  }
  // Touches without a change, and a value of one instant alone.
  for (const std::string text : {"(t - 2)^2 > 0", "abs(t - 2) > 0", "t != 2"}) {
    EXPECT_EQ(values(text, 2.0).first.value, 1.0) << text;
    EXPECT_EQ(values(text, 2.0).second.value, 1.0) << text;
  }
}

// The law of a joint: what depends on where it is has no time.
TEST(TimeFormulaSwitches, AreKnownBesideOtherValues) {
  const auto times = [](const std::string& text) {
    const auto formula = switching_formula(text, parameters, {"angle", "rate"});
    return formula ? formula->switches(0.0, 50.0) : std::vector<double>{};
  };
  EXPECT_EQ(times("t > 5 && t < 7 ? 100 : -2*angle"), (std::vector<double>{5.0, 7.0}));
  EXPECT_EQ(times("angle > 0 && t > 5 ? 100 : abs(rate)"), (std::vector<double>{5.0}));
  EXPECT_EQ(times("max(angle, t - 5)"), std::vector<double>{});
  EXPECT_EQ(times("(angle > 0 ? t : 2*t) > 5 ? 1 : 2"), std::vector<double>{});
  EXPECT_EQ(times("(angle > 0 ? t : 2*t)*rate > 5 ? 1 : min(t, 3)"), (std::vector<double>{3.0}));
  EXPECT_FALSE(switching_formula("-3*angle - rate*t", parameters, {"angle", "rate"}).has_value());
  EXPECT_FALSE(switching_formula("speed > 3 ? t : 2", parameters).has_value());
}

// d/ds and d/dv of s^2 v + t s at s = 3, v = 2, t = 5, and of the branch that is taken.
TEST(FormulaSlopes, AreThoseByTheOtherValues) {
  const FormulaSlopes smooth("s^2*v + t*s", parameters, {"s", "v"});
  const std::vector<double> at{3.0, 2.0};
  EXPECT_DOUBLE_EQ(smooth(0, 5.0, at), 17.0);
  EXPECT_DOUBLE_EQ(smooth(1, 5.0, at), 9.0);
  const FormulaSlopes branches("s > 1 ? max(s, v)*speed : tau*v", parameters, {"s", "v"});
  EXPECT_DOUBLE_EQ(branches(0, 5.0, at), 20.0);
  EXPECT_DOUBLE_EQ(branches(1, 5.0, at), 0.0);
  EXPECT_DOUBLE_EQ(branches(1, 5.0, std::vector<double>{0.5, 2.0}), 0.3);
}

TEST(TimeFormulaSwitches, JoinTheRowsOfATableButForRoundOff) {
  std::vector<double> times{0.3, 1.0, 2.0};
  add_switches({0.1 * 3.0, 1.5, 3.0 - 4e-16, 1e-30, 2.5, 2.5}, 0.0, 3.0, times);
  EXPECT_EQ(times, (std::vector<double>{1e-30, 0.3, 1.0, 1.5, 2.0, 2.5}));
}

}  // namespace
}  // namespace rubato::numerics
