#include <rubato/integrate/exact/first_exit.hpp>
#include <rubato/integrate/exact/series_length.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace rubato::integrate {
namespace {

/// sum over i of a_i cos(w_i s + p_i), as a Taylor series and as itself.
struct Wave {
  std::array<double, 3> amplitude, frequency, phase;
  double value(double s, int derivative = 0) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      sum += amplitude[i] * std::pow(frequency[i], derivative) *
             std::cos(frequency[i] * s + phase[i] + derivative * std::acos(0.0));
    return sum;
  }
  std::vector<double> series() const {
    std::vector<double> c(25);
    double factorial = 1.0;
    for (std::size_t k = 0; k < c.size(); ++k) {
      c[k] = value(0.0, static_cast<int>(k)) / factorial;
      factorial *= static_cast<double>(k + 1);
    }
    return c;
  }
};

Wave random_wave(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Wave wave;
  for (std::size_t i = 0; i < 3; ++i) {
    wave.amplitude[i] = any(random);
    wave.frequency[i] = 0.3 + 1.7 * std::abs(any(random));  // turns by at most 2 over a unit of time
    wave.phase[i] = 3.14 * any(random);
  }
  return wave;
}

// Against 20,000 samples of the function itself: inside before the exit, on the edge at it, to the round-off of its
// terms over its slope.
TEST(FirstExit, IsWhereAWaveLeavesItsBand) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0.05, 0.95);
  int exits = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Wave wave = random_wave(random);
    const double start = wave.value(0.0), lower = start - share(random), upper = start + share(random);
    const auto c = wave.series();
    const double s = first_exit(c, lower, upper, 1.0);
    const double last = s < 0.0 ? 1.0 : s;
    for (int i = 0; i < 20000 && i / 20000.0 < last; ++i) {
      ASSERT_GE(wave.value(i / 20000.0), lower - 1e-13) << trial;
      ASSERT_LE(wave.value(i / 20000.0), upper + 1e-13) << trial;
    }
    if (s < 0.0) continue;
    ++exits;
    const double edge = std::abs(wave.value(s) - upper) < std::abs(wave.value(s) - lower) ? upper : lower;
    EXPECT_NEAR(wave.value(s), edge, 4e-15) << trial;
  }
  EXPECT_GT(exits, 100);
}

// Roots in closed form: 1 - s^2 of the band's two edges; (s - 0.3)^2 - 1e-8, that dips below zero for 2e-4 only; and a
// motion that starts on the edge, moves in and comes back at 0.4.
TEST(FirstExit, FindsShortExcursionsAndReturns) {
  EXPECT_NEAR(first_exit(std::vector{0.0, 0.0, 1.0}, -1.0, 0.25, 1.0), 0.5, 1e-15);
  EXPECT_NEAR(first_exit(std::vector{0.0, 0.0, -1.0}, -0.25, 1.0, 1.0), 0.5, 1e-15);
  EXPECT_NEAR(first_exit(std::vector{0.09 - 1e-8, -0.6, 1.0}, 0.0, HUGE_VAL, 1.0), 0.3 - 1e-4, 1e-13);
  EXPECT_NEAR(first_exit(std::vector{0.0, 0.4, -1.0}, 0.0, HUGE_VAL, 1.0), 0.4, 1e-15);
  EXPECT_NEAR(first_exit(std::vector{0.0, 0.0, 0.4, -1.0}, 0.0, HUGE_VAL, 1.0), 0.4, 1e-15);
  EXPECT_LT(first_exit(std::vector{0.0, 0.4, -1.0}, 0.0, HUGE_VAL, 0.39), 0.0);
  EXPECT_LT(first_exit(std::vector{0.09 + 1e-8, -0.6, 1.0}, 0.0, HUGE_VAL, 1.0), 0.0);
}

// The derivative's own range is that of the derivative; samples miss an extremum by (1/40000)^2 / 2 of the curvature.
TEST(FirstExit, GivesTheRangesOfAWaveAndItsRates) {
  std::mt19937 random(6);
  for (int trial = 0; trial < 100; ++trial) {
    const Wave wave = random_wave(random);
    const auto c = wave.series();
    std::array<ValueRange, 3> ranges, alone;
    include_ranges(c, 1.0, ranges);
    include_ranges(c, 1.0, std::span(alone).first(1));
    EXPECT_NEAR(alone[0].low, ranges[0].low, 1e-15);
    EXPECT_NEAR(alone[0].high, ranges[0].high, 1e-15);
    for (int derivative = 0; derivative < 3; ++derivative) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (int i = 0; i <= 20000; ++i) {
        const double value = wave.value(i / 20000.0, derivative);
        low = std::min(low, value);
        high = std::max(high, value);
      }
      const ValueRange& range = ranges[static_cast<std::size_t>(derivative)];
      EXPECT_NEAR(range.low, low, 2e-8) << trial << ' ' << derivative;
      EXPECT_NEAR(range.high, high, 2e-8) << trial << ' ' << derivative;
      EXPECT_LE(range.low, low + 1e-12);
      EXPECT_GE(range.high, high - 1e-12);
    }
  }
}

TEST(SeriesLength, KeepsTheTermsAboveWhatIsNeglected) {
  const SeriesLength series(1e-10);
  for (const double x : {1e-3, 0.1, 0.5, 1.0, 2.0}) {
    const Index terms = series.terms(x, 25);
    const auto size = [x](Index k) { return std::pow(x, k) / std::tgamma(k + 1.0); };
    EXPECT_LE(size(terms), 1e-10 * (1.0 + 1e-9)) << x;
    EXPECT_GT(size(terms - 1), 1e-10) << x;
  }
  EXPECT_EQ(series.terms(100.0, 25), 25);
  EXPECT_EQ(series.terms(0.0, 25), 1);
}

}  // namespace
}  // namespace rubato::integrate
