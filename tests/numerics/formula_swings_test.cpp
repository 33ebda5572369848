#include <rubato/core/error.hpp>
#include <rubato/numerics/formula_enclosure.hpp>
#include <rubato/numerics/formula_swings.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace rubato::numerics {
namespace {

constexpr double pi = std::numbers::pi;

Formula formula(const std::string& text) { return Formula(text, {}, true, {"angle", "rate"}); }

/// How long a step may be that starts at t, by the bound there alone.
double bound_at(const Swings& swings, double t) {
  for (const StepBound& bound : swings.bounds)
    if (bound.from <= t && t < bound.to) return bound.step;
  return HUGE_VAL;
}

/// Steps that follow the bounds from 0 to an end, each as long as it may be.
double steps_of(const Swings& swings) {
  double steps = 0.0;
  for (const StepBound& bound : swings.bounds) steps += (bound.to - bound.from) / bound.step;
  return steps;
}

// Each operation and each function, with arguments that meet kinks, jumps, poles and ends of domains.
const std::vector<std::string> all_operations{"3 - t/4",
                                              "-t^2 + t^3 - 2^-t",
                                              "(t - 2)^4*(t - 3)",
                                              "(1 + t)^(1 + t/2)",
                                              "t^1.5 + (t - 2)^2.5",
                                              "(t - 2)^-2",
                                              "1/(t - 2.2)",
                                              "sin(5*t) + cos(t)^2 - tan(t/2)",
                                              "asin(t/3) + acos(t/4) + atan(t)",
                                              "asin(t)",
                                              "sinh(t)*cosh(t) - tanh(t)",
                                              "asinh(t) + acosh(1.5 + t) + atanh(t/9)",
                                              "acosh(t) + atanh(t - 1)",
                                              "log2(1 + t) + log10(1 + t)*ln(2 + t) - log(3 + t)",
                                              "log(t - 1)",
                                              "sqrt(1 + t^2)*abs(t - 0.7)",
                                              "sqrt(t - 1)",
                                              "min(t, 0.4, 1 - t) + max(t^2, 0.5)",
                                              "atan2(sin(3*t), 2 + cos(t)) + atan2(t - 2, t - 3)",
                                              "sign(t - 0.5)*t + rint(0.2 + t)",
                                              "t > 0.5 ? t^2 : t < 0.1 || t > 3 && 1 ? 2 : sin(t)",
                                              "(t <= 0.25) + (t >= 0.25) + (t == 0.25) + (t != 0.25)*t",
                                              "exp(-((t - 2)/0.1)^2)"};

// A property: what a formula is at any time in an interval lies in its enclosure over the interval, and so do its first
// two derivatives, but for round-off of the operations.
TEST(FormulaEnclosure, HoldsTheFormulaAndItsDerivatives) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const std::string& text : all_operations) {
    const Formula of_time = formula(text);
    FormulaEnclosure enclosure(of_time);
    for (int i = 0; i < 300; ++i) {
      const double from = 4.0 * share(random), width = std::pow(10.0, -5.0 * share(random));
      enclosure.evaluate({from, from + width}, IntervalSeries::most);
      const IntervalSeries over = enclosure.of(enclosure.whole());
      for (int k = 0; k < 5; ++k) {
        const double t = from + width * share(random);
        const TimeDerivatives exact = of_time.derivatives(t);
        const double values[] = {exact.value, exact.rate, exact.second_rate};
        for (int order = 0; order <= 2; ++order) {
          if (!std::isfinite(exact.value) || !std::isfinite(values[order])) continue;
          const Interval held = over.derivative(order);
          const double near = 1e-9 * (1.0 + std::abs(values[order]));
          EXPECT_TRUE(held.low - near <= values[order] && values[order] <= held.high + near)
              << text << " of order " << order << " at " << t << " in [" << from << ", " << from + width
              << "]: " << values[order] << " is not in [" << held.low << ", " << held.high << "]";
        }
      }
    }
  }
}

// Derivatives of higher order, of functions whose derivatives are known: those of sin repeat, exp stays.
TEST(FormulaEnclosure, KnowsHigherDerivatives) {
  const double t = 0.7;
  const auto at = [&](const std::string& text, int order) {
    const Formula of_time = formula(text);
    FormulaEnclosure enclosure(of_time);
    enclosure.evaluate({t, t}, IntervalSeries::most);
    return enclosure.of(enclosure.whole()).derivative(order).low;
  };
  for (int order = 0; order <= 6; ++order) {
    EXPECT_NEAR(at("sin(3*t)", order), std::pow(3.0, order) * std::sin(3.0 * t + order * pi / 2.0), 1e-12 * 729.0);
    EXPECT_NEAR(at("exp(-2*t)", order), std::pow(-2.0, order) * std::exp(-2.0 * t), 1e-12 * 64.0);
    EXPECT_NEAR(at("cosh(t) + sinh(t)", order), std::exp(t), 1e-12);
    EXPECT_NEAR(at("t^6", order), std::tgamma(7.0) / std::tgamma(7.0 - order) * std::pow(t, 6 - order), 1e-10);
  }
  // (1 + t^2) f' = 1 and its derivatives, of f = atan: by Leibniz's rule, f^(n+1) (1 + t^2) = -2 n t f^(n) - n (n-1)
  // f^(n-1)
  for (int n = 2; n <= 5; ++n)
    EXPECT_NEAR(at("atan(t)", n + 1) * (1.0 + t * t),
                -2.0 * n * t * at("atan(t)", n) - n * (n - 1.0) * at("atan(t)", n - 1), 1e-9);
}

// What fifty equal steps, or any power of two, meet at its zeros.
TEST(FormulaSwings, BoundStepsByASixthOfThePeriodOfASine) {
  for (const double hertz : {0.5, 2.0, 5.0, 20.48, 81.92, 250.0})
    for (const double duration : {1.0, 25.0, 50.0}) {
      if (hertz * duration < 3.0) continue;
      const Swings found = swings(formula("1000*sin(2*pi*" + std::to_string(hertz) + "*t)"), 0, 0.0, duration);
      ASSERT_TRUE(found.are_known);
      for (const double t : {0.01, 0.31, 0.5, 0.77, 0.99}) {
        // Heights are those of samples, and bounds that differ by less than a quarter are one.
        EXPECT_LE(bound_at(found, t * duration), 1.0 / hertz / 6.0 * 1.001) << hertz << " " << duration;
        EXPECT_GE(bound_at(found, t * duration), 1.0 / hertz / 6.0 / 1.3) << hertz << " " << duration;
      }
    }
}

TEST(FormulaSwings, AreThoseOfDerivativesToo) {
  // The second derivative of a slow swing with a small fast one on it is all fast.
  const std::string text = "sin(t) + 1e-6*sin(500*t)";
  EXPECT_GT(bound_at(swings(formula(text), 0, 0.0, 20.0), 7.0), 2.0 * pi / 6.0 / 1.3);
  EXPECT_NEAR(bound_at(swings(formula(text), 2, 0.0, 20.0), 7.0), 2.0 * pi / 500.0 / 6.0, 0.1 * 2.0 * pi / 500.0 / 6.0);
}

// A pulse of which no lattice of samples knows, and few steps beside it.
TEST(FormulaSwings, FindANarrowPulseAndBoundStepsThereAlone) {
  for (const double place : {0.3, 25.0, 31.4159, 49.9})
    for (const double width : {2e-3, 1e-6}) {
      const std::string at = std::to_string(place), tau = std::to_string(width);
      for (const std::string& text : {"exp(-((t - " + at + ")/" + tau + ")^2)", "1/cosh((t - " + at + ")/" + tau + ")",
                                      "1/(1 + ((t - " + at + ")/" + tau + ")^2)^2"}) {
        const Swings found = swings(formula(text), 0, 0.0, 50.0);
        ASSERT_TRUE(found.are_known);
        EXPECT_LT(bound_at(found, place), 0.6 * width) << text;
        EXPECT_GT(bound_at(found, place), 0.2 * width) << text;
        EXPECT_GT(bound_at(found, place > 10.0 ? place - 10.0 : place + 10.0), 1.0) << text;
        EXPECT_LT(steps_of(found), 300.0) << text;
      }
    }
}

TEST(FormulaSwings, FollowAFrequencyThatRises) {
  const Swings found = swings(formula("sin(t^2)"), 0, 0.0, 100.0);
  for (const double t : {10.3, 31.4, 55.5, 99.0}) {
    const double sixth = 2.0 * pi / (2.0 * t) / 6.0;
    EXPECT_LT(bound_at(found, t), sixth * 1.1) << t;
    EXPECT_GT(bound_at(found, t), sixth / 1.5) << t;  // bounds within a quarter are one
  }
}

TEST(FormulaSwings, AreNoneWhereNothingSwings) {
  for (const std::string text : {"1000", "3 + 0.2*t", "t < 3 ? 0 : 20", "sign(t - 4)*t", "1000 + 0*sin(1e9*t)"})
    EXPECT_TRUE(swings(formula(text), 0, 0.0, 50.0).bounds.empty()) << text;
  // Slow curves ask for no more than the steps that a run has anyway, a fiftieth.
  for (const std::string text : {"t^2", "10*(t/50)^3 - 15*(t/50)^4 + 6*(t/50)^5", "exp(-t/10)", "sin(t/8)"})
    for (const StepBound& bound : swings(formula(text), 0, 0.0, 50.0).bounds) EXPECT_GT(bound.step, 1.0) << text;
}

// The law of a joint, where what moves is not known: the parts that are of time alone, and the whole.
TEST(FormulaSwings, AreKnownBesideOtherValues) {
  const double sixth = 0.1 / 6.0;
  for (const std::string text : {"-5*rate + angle*sin(2*pi*10*t)", "angle > 3 ? 100*sin(2*pi*10*t) : 0",
                                 "sin(2*pi*10*t + angle)", "rate > 0 ? 2*sin(2*pi*10*t) - angle : 1"})
    EXPECT_NEAR(bound_at(swings(formula(text), 0, 0.0, 20.0), 7.0), sixth, 0.1 * sixth) << text;
}

// Each takes about a second of a processor at most; the first took 30 s and 690 MB.
TEST(FormulaSwings, AreGivenUpInTime) {
  for (const std::string text :
       {"abs(sin(1e9*t))", "sin(1e9*t)", "rint(1e7*t)", "max(sin(t), sin(t))", "sin(1e7*t)*exp(-t)*cos(3*t)"}) {
    const Swings found = swings(formula(text), 0, 0.0, 50.0);
    EXPECT_FALSE(found.are_known) << text;
    EXPECT_TRUE(found.bounds.empty()) << text;
  }
  EXPECT_TRUE(formula("abs(sin(1e9*t))").switches(0.0, 50.0).empty());
}

TEST(StepBounds, JoinToTheSmallerOfBoth) {
  const std::vector<StepBound> a{{0.0, 10.0, 1.0}, {20.0, 30.0, 0.1}}, b{{5.0, 25.0, 0.5}};
  const std::vector<StepBound> both = join(a, b);
  ASSERT_EQ(both.size(), 3u);
  const double expected[3][3] = {{0.0, 5.0, 1.0}, {5.0, 20.0, 0.5}, {20.0, 30.0, 0.1}};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(both[std::size_t(i)].from, expected[i][0]);
    EXPECT_EQ(both[std::size_t(i)].to, expected[i][1]);
    EXPECT_EQ(both[std::size_t(i)].step, expected[i][2]);
  }
  EXPECT_EQ(join(a, b, 0.5).size(), 1u);
}

}  // namespace
}  // namespace rubato::numerics
