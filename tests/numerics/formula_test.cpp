#include <rubato/core/error.hpp>
#include <rubato/numerics/formula.hpp>

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

// Each operator and function once, with every precedence beside its neighbours.
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
    if (depth == 0) return one_of(leaves);
    const auto part = [&] { return text(depth - 1); };
    switch (random_() % 8) {
      case 0:
        return one_of(functions) + "(" + part() + ")";
      case 1:
        return "(" + part() + ")";
      case 2:
        return "-" + part();
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

// Constants of && and || were once folded as whole numbers.
TEST(Formula, TakesWhatIsNotZeroForTrue) {
  EXPECT_EQ(Formula("0.3 || 0 ? 1 : 0", {})(), 1.0);
  EXPECT_EQ(Formula("0.3 && 0.2", {})(), 1.0);
  EXPECT_EQ(Formula("0/0 ? 1 : 2", {})(), 1.0);
}

TEST(Formula, HasTheValueThatItsDerivativesHave) {
  RandomFormula random(11);
  int finite = 0;
  for (int i = 0; i < 5000; ++i) {
    const std::string text = random.text(1 + i % 4);
    const Formula formula(text, parameters, true);
    for (const double t : {0.0, 0.3, -0.7, 2.5}) {
      const double a = formula(t), b = formula.derivatives(t).value;
      if (std::isfinite(a)) ++finite;
      EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << text << " at " << t << ": " << a << ", " << b;
    }
  }
  EXPECT_GT(finite, 15000);
}

// As programs write them: sums and chains of choices of any length, without a depth.
TEST(Formula, MayBeLong) {
  std::string sum = "t", chain;
  for (int i = 0; i < 100000; ++i) sum += "+1";
  for (int i = 0; i < 20000; ++i) chain += "t < " + std::to_string(i) + " ? " + std::to_string(2 * i) + " : ";
  EXPECT_EQ(Formula(sum, {}, true)(0.5), 100000.5);
  EXPECT_EQ(Formula(sum, {}, true).derivatives(0.5).rate, 1.0);
  EXPECT_EQ(Formula(chain + "-1", {}, true)(777.5), 1556.0);
  EXPECT_EQ(Formula(chain + "-1", {}, true)(1e9), -1.0);
}

// Central differences of a step h are off by h^2 f'''/6, and round-off by eps/h and 4 eps/h^2: 1e-8 and 1e-6 of values
// whose time scale is 1/20 s with h = 1e-5 and 1e-4.
TEST(Formula, KnowsItsDerivatives) {
  for (const std::string& text : formulas) {
    const Formula formula(text, parameters, true);
    for (const double t : {0.05, 0.61, 1.3}) {
      const double h = 1e-5, g = 1e-4;
      const auto now = formula.derivatives(t);
      const double size = 1.0 + std::abs(now.value) + 400.0 * std::abs(now.rate);
      EXPECT_NEAR(now.rate, (formula(t + h) - formula(t - h)) / (2.0 * h), 1e-8 * size) << text << t;
      EXPECT_NEAR(now.second_rate, (formula(t + g) - 2.0 * now.value + formula(t - g)) / (g * g),
                  1e-5 * (size + std::abs(now.second_rate)))
          << text << " at " << t;
    }
  }
}

TEST(Formula, HasExactDerivativesOfAPowerAtZero) {
  const auto square = Formula("t^2", {}, true).derivatives(0.0);
  EXPECT_EQ(square.value, 0.0);
  EXPECT_EQ(square.rate, 0.0);
  EXPECT_EQ(square.second_rate, 2.0);
  EXPECT_EQ(Formula("t^1", {}, true).derivatives(0.0).rate, 1.0);
}

// Against differences, for every operation; the value keeps the bits of the formula without its slope.
TEST(Formula, HasTheSlopeOfEveryOperation) {
  for (const char* text :
       {"-s + 2*v", "s/v - v/s", "s^3 + v^2.5", "s^v", "2^s", "(s - v)^2", "sin(s*v) + cos(s)", "exp(-s)*log(v)",
        "sqrt(s) + tanh(v)", "atan2(s, v)", "abs(v - s)*s", "min(s, v)*s", "max(s, 2*v)", "rint(s) + v*sign(s - v)",
        "s > v ? s*s : v*v", "s < v && v > 0 ? s : v*s*s", "(s*v)^-1.5", "t*s*s"}) {
    const Formula formula(text, parameters, true, {"s", "v"});
    const double h = 1e-6, t = 0.7;
    for (const std::array<double, 2> at : {std::array{0.3, 1.7}, {2.2, 0.4}, {1.1, 1.9}}) {
      for (std::size_t i = 0; i < 2; ++i) {
        std::array<double, 2> before = at, after = at;
        before[i] -= h;
        after[i] += h;
        const ValueAndSlope found = formula.with_slope(i, t, at);
        EXPECT_EQ(found.value, formula(t, at)) << text;
        EXPECT_NEAR(found.slope, (formula(t, after) - formula(t, before)) / (2.0 * h),
                    1e-7 * (1 + std::abs(found.slope)))
            << text << " by " << i << " at " << at[0] << ", " << at[1];
      }
    }
  }
  const Formula power("s^3", parameters, true, {"s", "v"});
  EXPECT_EQ(power.with_slope(0, 0.0, std::array{0.0, 0.0}).slope, 0.0);
  EXPECT_EQ(Formula("s^1", parameters, true, {"s"}).with_slope(0, 0.0, std::array{0.0}).slope, 1.0);
  EXPECT_DOUBLE_EQ(power.with_slope(0, 0.0, std::array{1e-120, 0.0}).slope, 3e-240);  // the value is below every number
}

// d/ds and d/dv of s^2 v + t s at s = 3, v = 2, t = 5, and of the branch that is taken.
TEST(Formula, HasSlopesByOtherValues) {
  const Formula smooth("s^2*v + t*s", parameters, true, {"s", "v"});
  const std::vector<double> at{3.0, 2.0};
  EXPECT_DOUBLE_EQ(smooth(5.0, at), 33.0);
  EXPECT_DOUBLE_EQ(smooth.with_slope(0, 5.0, at).slope, 17.0);
  EXPECT_DOUBLE_EQ(smooth.with_slope(1, 5.0, at).slope, 9.0);
  const Formula branches("s > 1 ? max(s, v)*speed : tau*v", parameters, true, {"s", "v"});
  EXPECT_DOUBLE_EQ(branches.with_slope(0, 5.0, at).slope, 20.0);
  EXPECT_DOUBLE_EQ(branches.with_slope(1, 5.0, at).slope, 0.0);
  EXPECT_DOUBLE_EQ(branches.with_slope(1, 5.0, std::vector<double>{0.5, 2.0}).slope, 0.3);
}

}  // namespace
}  // namespace rubato::numerics
