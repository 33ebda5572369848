#include <rubato/integrate/controllers/controller.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rubato::integrate {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(CardonaCassano, TakesTheFourActionsOfItsTable) {
  const auto act = [](double error) { return decide(CardonaCassano{}, {0.1, error, 3}, {}); };
  EXPECT_FALSE(act(1.001).accepts);
  EXPECT_EQ(act(1.001).next, 0.05);
  EXPECT_TRUE(act(1.0).accepts);
  EXPECT_DOUBLE_EQ(act(1.0).next, 0.1 * std::cbrt(0.5));  // to an error of half the tolerance
  EXPECT_EQ(act(0.5).next, 0.1);
  EXPECT_EQ(act(0.0625).next, 0.1);
  EXPECT_EQ(act(0.0624).next, 0.2);
  EXPECT_EQ(act(0.0).next, 0.2);
  EXPECT_FALSE(act(nan).accepts);
}

// With e = C h^p the step that meets the aim safety^p is h (aim/e)^(1/p): the controller must settle there, and may
// stay anywhere in its band before.
TEST(PiControl, SettlesInsideItsBandAndThenKeepsTheStep) {
  for (const int p : {1, 2, 3, 5}) {
    const PiControl pi;
    ControlHistory history;
    double h = 1e-4;
    int changes = 0, rejections = 0;
    for (int step = 0; step < 200; ++step) {
      const double error = std::pow(h / 0.02, p);
      const Decision decision = decide(pi, {h, error, p}, history);
      history.was_rejected = !decision.accepts;
      if (decision.accepts) history.last_error = error, history.last_step = h;
      if (!decision.accepts) ++rejections;
      if (step >= 30 && decision.next != h) ++changes;
      h = decision.next;
    }
    EXPECT_EQ(changes, 0) << p;
    EXPECT_LE(rejections, 1) << p;
    EXPECT_LE(h, 0.02);
    EXPECT_GT(h, 0.02 * pi.safety / pi.keep) << p;
  }
}

// An error density that rises threefold a step is met before it must be rejected.
TEST(PiControl, ShortensTheStepAheadOfAnErrorThatRisesFast) {
  EXPECT_EQ(decide(PiControl{}, {0.1, 0.9, 2}, {0.9, 0.1, false}).next, 0.1);
  const Decision decision = decide(PiControl{}, {0.1, 0.9, 2}, {0.3, 0.1, false});
  EXPECT_TRUE(decision.accepts);
  EXPECT_DOUBLE_EQ(decision.next, 0.1 * 0.9 * std::pow(0.9, -0.5) * std::pow(1.0 / 3.0, 0.2));
  // The same error from a step that was shorter by sqrt(3) is no rise.
  EXPECT_EQ(decide(PiControl{}, {0.1, 0.9, 2}, {0.3, 0.1 / std::sqrt(3.0), false}).next, 0.1);
}

TEST(PiControl, NeverGrowsDirectlyAfterARejectionAndNeverShrinksMoreThanItMay) {
  const PiControl pi;
  EXPECT_EQ(decide(pi, {0.1, 1e-6, 2}, {0.5, 0.2, true}).next, 0.1);
  EXPECT_DOUBLE_EQ(decide(pi, {0.1, 1e-6, 2}, {}).next, 0.5);
  EXPECT_DOUBLE_EQ(decide(pi, {0.1, 1e9, 2}, {}).next, 0.02);
  for (const double worst : {nan, HUGE_VAL}) {
    EXPECT_FALSE(decide(pi, {0.1, worst, 2}, {}).accepts);
    EXPECT_DOUBLE_EQ(decide(pi, {0.1, worst, 2}, {}).next, 0.02);
  }
}

TEST(FixedStep, AcceptsWhateverTheErrorAndKeepsTheStep) {
  EXPECT_TRUE(decide(FixedStep{}, {0.1, 1e9, 2}, {}).accepts);
  EXPECT_EQ(decide(FixedStep{}, {0.1, nan, 2}, {}).next, 0.1);
}

}  // namespace
}  // namespace rubato::integrate
