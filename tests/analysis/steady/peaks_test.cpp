#include <rubato/analysis/steady/peaks.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rubato::analysis {
namespace {

/// The amplitude of a damped oscillator of unit stiffness over frequency: largest at w sqrt(1 - 2 d^2).
struct Oscillator {
  double natural, damping_ratio, force = 1.0;
  double operator()(double w) const {
    const double r = w / natural;
    return force / std::hypot(1.0 - r * r, 2.0 * damping_ratio * r);
  }
  double peak() const { return natural * std::sqrt(1.0 - 2.0 * damping_ratio * damping_ratio); }
  double highest() const { return 0.5 * force / (damping_ratio * std::sqrt(1.0 - damping_ratio * damping_ratio)); }
};

template <typename... Functions>
Curves curves(Functions... functions) {
  return [=](double x, Vector& values) {
    values.resize(sizeof...(functions));
    Index i = 0;
    ((values[i++] = functions(x)), ...);
    return true;
  };
}

TEST(Peaks, AreWhereTheAmplitudeOfAnOscillatorIsLargest) {
  for (const double damping : {0.2, 0.02, 0.002}) {
    const Oscillator oscillator{3.0, damping};
    const auto peaks = find_peaks(curves(oscillator), {1.0, 5.0, 17, {3.0}});
    ASSERT_EQ(peaks.size(), 1u) << damping;
    EXPECT_EQ(peaks[0].kind, Peak::Kind::interior);
    EXPECT_NEAR(peaks[0].at, oscillator.peak(), 2e-9 * oscillator.peak());
    // The height is flat at the top: its error is the square of that of the place, and round-off.
    EXPECT_NEAR(peaks[0].value, oscillator.highest(), 1e-12 * oscillator.highest());
    EXPECT_NEAR(peaks[0].slope, 0.0, 1e-6 * peaks[0].value / (damping * peaks[0].at));
  }
}

TEST(Peaks, BetweenTheSamplesAreFoundWhereTheyAreExpected) {
  const Oscillator broad{4.0, 0.1}, narrow{2.0317, 1e-5, 2e-5};
  const auto sum = [=](double x) { return broad(x) + narrow(x); };
  const auto blind = find_peaks(curves(sum), {1.0, 6.0, 17, {}});
  EXPECT_EQ(blind.size(), 1u);
  const auto peaks = find_peaks(curves(sum), {1.0, 6.0, 17, {2.0317}});
  ASSERT_EQ(peaks.size(), 2u);
  EXPECT_NEAR(peaks[0].value, broad.highest(), 1e-3);
  EXPECT_NEAR(peaks[1].at, 2.0317, 1e-7);
}

TEST(Peaks, OfSeveralCurvesComeWithTheHighestFirst) {
  const Oscillator low{2.0, 0.1}, high{3.0, 0.05};
  const auto peaks = find_peaks(curves(low, high), {1.0, 5.0, 33, {}});
  ASSERT_EQ(peaks.size(), 2u);
  EXPECT_EQ(peaks[0].curve, 1);
  EXPECT_EQ(peaks[1].curve, 0);
  EXPECT_NEAR(peaks[1].at, low.peak(), 1e-8);
}

TEST(Peaks, AtAnEndOfTheRangeSayThatTheyAre) {
  const auto rising = find_peaks(curves([](double x) { return x * x; }), {1.0, 2.0, 9, {}});
  ASSERT_EQ(rising.size(), 1u);
  EXPECT_EQ(rising[0].kind, Peak::Kind::upper_end);
  EXPECT_EQ(rising[0].at, 2.0);
  EXPECT_NEAR(rising[0].slope, 4.0, 1e-4);
  const auto falling = find_peaks(curves([](double x) { return 1.0 / x; }), {1.0, 2.0, 9, {}});
  ASSERT_EQ(falling.size(), 1u);
  EXPECT_EQ(falling[0].kind, Peak::Kind::lower_end);
}

TEST(Peaks, BetweenAnEndAndTheFirstSampleAreInterior) {
  const Oscillator oscillator{1.06, 0.01};
  const auto peaks = find_peaks(curves(oscillator), {1.0585, 2.0, 9, {}});
  ASSERT_EQ(peaks.size(), 1u);
  EXPECT_EQ(peaks[0].kind, Peak::Kind::interior);
  EXPECT_NEAR(peaks[0].at, oscillator.peak(), 1e-8);
}

TEST(Peaks, AtACornerHaveNoSlope) {
  const auto peaks = find_peaks(curves([](double x) { return 1.0 - std::abs(x - 1.23456789); }), {1.0, 2.0, 9, {}});
  ASSERT_EQ(peaks.size(), 1u);
  EXPECT_NEAR(peaks[0].at, 1.23456789, 1e-5);
  EXPECT_TRUE(std::isnan(peaks[0].slope));
}

// Each bend has its top on the other side of the corner: Newton's method goes to and fro between them.
TEST(Peaks, AtACornerOfTwoBendsAreNotTakenForTheTopOfEither) {
  const double corner = 1.43;
  const auto bends = [=](double x) {
    const double d = x - corner;
    return d < 0.0 ? 1.0 + 0.2 * d - 2.0 * d * d : 1.0 - 0.5 * d - 20.0 * d * d;
  };
  const auto peaks = find_peaks(curves(bends), {1.0, 2.0, 9, {}});
  ASSERT_EQ(peaks.size(), 1u);
  EXPECT_NEAR(peaks[0].at, corner, 1e-5);
  EXPECT_NEAR(peaks[0].value, 1.0, 1e-5);
  EXPECT_TRUE(std::isnan(peaks[0].slope));
}

// Nine samples lie 0.5 apart and see one top of three; peaks are as wide as 0.1.
TEST(Peaks, ThatAreCloseAreSeenByTheExtremesOfACoarseCurve) {
  const auto bump = [](double x, double at, double height) { return height / (1.0 + std::pow((x - at) / 0.05, 2)); };
  const auto exact = [=](double x) {
    return 1.0 / (1.0 + 0.1 * x) + bump(x, 2.55, 1.0) + bump(x, 2.78, 1.04) + bump(x, 4.21, 0.5);
  };
  PeakRange range{1.0, 5.0, 9, {}};
  int looks = 0;
  const Curves coarse = [&](double x, Vector& values) {
    ++looks;
    values.setConstant(1, exact(x) * (1.0 + 1e-3 * std::sin(3.0 * x)));
    return true;
  };
  range.besides = find_extremes(coarse, range, 1);
  EXPECT_LT(looks, 120);
  EXPECT_EQ(range.besides.size(), 6u);  // three tops, and the dips before, between and behind
  const auto peaks = find_peaks(curves(exact), range);
  ASSERT_EQ(peaks.size(), 4u);  // with the lower end
  EXPECT_NEAR(peaks[0].at, 2.78, 5e-3);
  EXPECT_NEAR(peaks[1].at, 2.55, 5e-3);
}

// A bump of one sign is hidden where its only sample lies on its zero; the other part of a complex response is largest
// there.
TEST(Peaks, OfWhichOneCurveShowsNothingAreSeenByAnother) {
  const auto bump = [](double x) { return (x - 2.75) / 0.1 * std::exp(-std::pow((x - 2.75) / 0.1, 2)); };
  const auto beside = [](double x) { return std::exp(-std::pow((x - 2.75) / 0.1, 2)); };
  const PeakRange range{1.0, 5.0, 9, {}};
  const Curves both = curves([&](double x) { return 2.0 - 0.1 * x + bump(x); }, beside);
  EXPECT_TRUE(find_extremes(curves([&](double x) { return 2.0 - 0.1 * x + bump(x); }), range, 1).empty());
  const auto extremes = find_extremes(both, range, 1);
  ASSERT_EQ(extremes.size(), 2u);
  EXPECT_NEAR(extremes[0], 2.68, 0.02);  // 2.75 -+ 0.1/sqrt(2)
  EXPECT_NEAR(extremes[1], 2.82, 0.02);
}

TEST(Peaks, AreFoundThoughSomePointsHaveNoValue) {
  const Oscillator oscillator{3.0, 0.05};
  const Curves holes = [=](double x, Vector& values) {
    values.setConstant(1, oscillator(x));
    return !(x > 1.9 && x < 2.1);
  };
  const auto peaks = find_peaks(holes, {1.0, 5.0, 17, {}});
  ASSERT_EQ(peaks.size(), 1u);
  EXPECT_NEAR(peaks[0].at, oscillator.peak(), 1e-8);
  EXPECT_TRUE(find_peaks([](double, Vector&) { return false; }, {1.0, 5.0, 17, {}}).empty());
}

// A resonance without a value around its top, three times as high as the other: the lower one was the only peak.
TEST(Peaks, WhoseTopHasNoValueAreTheBestThatHasOne) {
  const Oscillator high{2.0, 0.01}, low{4.0, 0.05};
  const Curves holes = [&](double x, Vector& values) {
    values.setConstant(1, high(x) + low(x));
    return !(x > 1.93 && x < 2.07);
  };
  const auto peaks = find_peaks(holes, {1.0, 5.0, 41, {}});
  ASSERT_EQ(peaks.size(), 2u);
  EXPECT_FALSE(peaks[0].is_closed);
  EXPECT_NEAR(peaks[0].at, 2.0, 0.11);
  EXPECT_GE(peaks[0].value, high(1.9));
  EXPECT_TRUE(peaks[1].is_closed);
}

TEST(Peaks, AreFollowedToWhatTheyHaveBecome) {
  const Oscillator before{3.0, 0.05}, after{3.05, 0.05};
  const PeakRange range{1.0, 5.0, 17, {}};
  const auto known = find_peaks(curves(before), range);
  const auto peak = follow_peak(curves(after), range, known.at(0));
  ASSERT_TRUE(peak);
  EXPECT_NEAR(peak->at, after.peak(), 1e-8);
  EXPECT_FALSE(follow_peak(curves([](double x) { return x; }), range, known.at(0)));
}

}  // namespace
}  // namespace rubato::analysis
