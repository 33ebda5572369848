#include <rubato/core/error.hpp>
#include <rubato/numerics/time_formula.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
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

}  // namespace
}  // namespace rubato::numerics
