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

// With e = C h^p the step that meets the aim is h (aim/e)^(1/p): the controller must settle there, and may
// stay anywhere in its band before.
TEST(PiControl, SettlesInsideItsBandAndThenKeepsTheStep) {
  for (const int p : {1, 2, 3, 5}) {
    const PiControl pi;
    ControlHistory history;
    double h = 1e-4;
    int changes = 0, rejections = 0;
    for (int step = 0; step < 1000; ++step) {
      const double error = std::pow(h / 0.02, p);
      const Decision decision = decide(pi, {h, error, p}, history);
      history.was_rejected = !decision.accepts;
      history.forgone = decision.forgone;
      if (decision.accepts) history.last_error = error, history.last_step = h;
      if (!decision.accepts) ++rejections;
      if (step >= 500 && decision.next != h) ++changes;  // the last growth by a tenth waits for 110
      h = decision.next;
    }
    EXPECT_EQ(changes, 0) << p;
    EXPECT_LE(rejections, 1) << p;
    EXPECT_LE(h, 0.02);
    EXPECT_GT(h, 0.02 * std::pow(pi.least, 1.0 / p)) << p;
  }
}

// An error density that rises threefold a step is met before it must be rejected.
TEST(PiControl, ShortensTheStepAheadOfAnErrorThatRisesFast) {
  EXPECT_EQ(decide(PiControl{}, {0.1, 0.9, 2}, {0.9, 0.1, false}).next, 0.1);
  const Decision decision = decide(PiControl{}, {0.1, 0.9, 2}, {0.2, 0.1, false});
  EXPECT_TRUE(decision.accepts);
  EXPECT_DOUBLE_EQ(decision.next, 0.1 * std::sqrt(PiControl{}.aim / 0.9) * std::pow(2.0 / 9.0, 0.2));
  // The same error from a step that was shorter by sqrt(4.5) is no rise.
  EXPECT_EQ(decide(PiControl{}, {0.1, 0.9, 2}, {0.2, 0.1 / std::sqrt(4.5), false}).next, 0.1);
}

// An error of 0.25 allows a step 0.8/sqrt(0.25) = 1.6 times as long, which would save 0.375 steps a step: 10 steps
// after
// 27. An error that rises in between leaves nothing to wait for.
TEST(PiControl, GrowsModeratelyOnlyAfterTheFactorisationWouldHaveBeenSaved) {
  const PiControl pi;
  const auto steps_until_growth = [&](int disturbed_at) {
    ControlHistory history;
    for (int step = 1; step < 100; ++step) {
      const double error = step == disturbed_at ? 0.7 : 0.25;
      const Decision decision = decide(pi, {0.1, error, 2}, history);
      if (decision.next != 0.1) {
        EXPECT_DOUBLE_EQ(decision.next, 0.16);
        return step;
      }
      history = {error, 0.1, false, decision.forgone};
    }
    return 0;
  };
  EXPECT_EQ(steps_until_growth(0), 27);
  EXPECT_EQ(steps_until_growth(20), 47);
  // A step 2.5 times as long is taken at once.
  EXPECT_DOUBLE_EQ(decide(pi, {0.1, 0.1, 2}, {}).next, 0.1 * 0.8 / std::sqrt(0.1));
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
