#include <rubato/numerics/formula.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace rubato::numerics {
namespace {

const Parameters parameters{{"speed", 20.0}, {"tau", 0.3}};

std::vector<double> switches(const std::string& text, double from = 0.0, double to = 50.0) {
  return Formula(text, parameters, true).switches(from, to);
}

/// To round-off of the times.
void expect_times(const std::string& text, const std::vector<double>& expected, double from = 0.0, double to = 50.0) {
  const std::vector<double> found = switches(text, from, to);
  ASSERT_EQ(found.size(), expected.size()) << text;
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-15 * expected[i]) << text;
}

TEST(FormulaSwitches, AreWhereWhatIsComparedBecomesEqual) {
  expect_times("t < 25 ? 0 : 1", {25.0});
  expect_times("t > 25 && t < 25.005", {25.0, 25.005});
  expect_times("(t >= 3) - (t >= 4) + 0*(t < 3)", {3.0, 4.0});
  expect_times("t < tau ? t : tau", {0.3});
  expect_times("2*(t - 1) <= speed*tau ? t : 1", {4.0});
  expect_times("t < 25 ? 0 : (t < 25.01 ? 100 : 0)", {25.0, 25.01});
  expect_times("speed < 3 ? t : 2*t", {});
  expect_times("t < 60 ? 1 : t > -1", {});
}

TEST(FormulaSwitches, AreWhereFunctionsBend) {
  expect_times("abs(t - 7)", {7.0});
  expect_times("sign(7 - t)", {7.0});
  expect_times("rint(t/10)", {5.0, 15.0, 25.0, 35.0, 45.0});
  expect_times("min(t, 3, 10 - t) + max(2*t, 4)", {2.0, 3.0, 7.0});
  expect_times("max(0, 1 - abs(t - 25.005)/0.005)*200", {25.0, 25.005, 25.01});
  expect_times("abs(abs(t - 10) - 2)", {8.0, 10.0, 12.0});
}

// 1/16384 of the interval is 3 ms; the pairs of switches of the second are 0.9 ms apart.
TEST(FormulaSwitches, OfCurvedArgumentsAreFound) {
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
TEST(FormulaSwitches, AreFoundHoweverCloseToOneAnother) {
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

TEST(FormulaSwitches, HaveTheBranchOfEachSide) {
  const auto values = [](const std::string& text, double t) {
    const Formula formula(text, parameters, true);
    return std::pair{formula.derivatives_from_left(t), formula.derivatives_from_right(t)};
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
TEST(FormulaSwitches, AreKnownBesideOtherValues) {
  const auto formula = [](const std::string& text) { return Formula(text, parameters, true, {"angle", "rate"}); };
  const auto times = [&](const std::string& text) { return formula(text).switches(0.0, 50.0); };
  EXPECT_EQ(times("t > 5 && t < 7 ? 100 : -2*angle"), (std::vector<double>{5.0, 7.0}));
  EXPECT_EQ(times("angle > 0 && t > 5 ? 100 : abs(rate)"), (std::vector<double>{5.0}));
  EXPECT_EQ(times("max(angle, t - 5)"), std::vector<double>{});
  EXPECT_EQ(times("(angle > 0 ? t : 2*t) > 5 ? 1 : 2"), std::vector<double>{});
  EXPECT_EQ(times("(angle > 0 ? t : 2*t)*rate > 5 ? 1 : min(t, 3)"), (std::vector<double>{3.0}));
  EXPECT_FALSE(formula("-3*angle - rate*t").has_switches());
  EXPECT_FALSE(formula("speed > 3 ? t : 2").has_switches());
}

TEST(FormulaSwitches, JoinTheRowsOfATableButForRoundOff) {
  std::vector<double> times{0.3, 1.0, 2.0};
  add_switches({0.1 * 3.0, 1.5, 3.0 - 4e-16, 1e-30, 2.5, 2.5}, 0.0, 3.0, times);
  EXPECT_EQ(times, (std::vector<double>{1e-30, 0.3, 1.0, 1.5, 2.0, 2.5}));
}

}  // namespace
}  // namespace rubato::numerics
