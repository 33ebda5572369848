#include <rubato/report/digest.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace rubato::report {
namespace {

using testing::ElementsAre;
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

Envelope envelope_of(const std::vector<double>& signal, std::size_t buckets) {
  Envelope envelope(signal.size(), buckets);
  for (const double value : signal) envelope.add(value);
  return envelope;
}

TEST(Envelope, KeepsTheExtremesOfABucketInTheOrderInWhichTheyCame) {
  EXPECT_THAT(envelope_of({1, 5, 2, -3, 0, 4, 9, 8}, 2).points(), ElementsAre(5, -3, 0, 9));
}

TEST(Envelope, KeepsASpikeOfOneRowInALongSignal) {
  std::vector<double> signal(1'000'003, 0.0);
  signal[777'777] = 12.5;
  const auto points = envelope_of(signal, 2000).points();
  EXPECT_EQ(points.size(), 4000u);
  EXPECT_EQ(std::count(points.begin(), points.end(), 12.5), 1);
}

TEST(Envelope, PassesOverNaNAndLeavesItWhereABucketHasNothingElse) {
  const auto points = envelope_of({nan_value, 2, nan_value, nan_value, 3, 1}, 3).points();
  EXPECT_EQ(points[0], 2);
  EXPECT_EQ(points[1], 2);
  EXPECT_TRUE(std::isnan(points[2]) && std::isnan(points[3]));
  EXPECT_EQ(points[4], 3);
  EXPECT_EQ(points[5], 1);
}

TEST(Envelope, FormsNoMoreBucketsThanThereAreRows) {
  EXPECT_THAT(envelope_of({4, 6}, 2000).points(), ElementsAre(4, 4, 6, 6));
  EXPECT_THAT(Envelope::rows_of_points(2, 2000), ElementsAre(0, 0, 1, 1));
  EXPECT_TRUE(envelope_of({}, 2000).points().empty());
}

TEST(Envelope, StandsAtTheFirstAndLastRowOfEachBucket) {
  // floor(3 r / 7): rows 0 1 2 | 3 4 | 5 6.
  EXPECT_THAT(Envelope::rows_of_points(7, 3), ElementsAre(0, 2, 3, 4, 5, 6));
  EXPECT_THAT(envelope_of({0, 1, 2, 3, 4, 5, 6}, 3).points(), ElementsAre(0, 2, 3, 4, 5, 6));
}

TEST(KeyNumbers, OfASineOverWholePeriodsAreOneAndTheRootOfAHalf) {
  const int rows = 100'000;
  const double end = 20.0 * std::numbers::pi;
  KeyNumbers numbers(0.0, end);
  for (int row = 0; row <= rows; ++row) numbers.add(end * row / rows, std::sin(end * row / rows));
  // The trapezoidal rule is exact for a trigonometric polynomial over its periods; the crest is missed by h^2/8 < 5e-8.
  EXPECT_NEAR(numbers.rms(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(numbers.largest(), 1.0, 5e-8);
  EXPECT_NEAR(numbers.late_amplitude(), 1.0, 5e-8);
}

TEST(KeyNumbers, WeighRowsByTheTimeBetweenThem) {
  // x^2 is 1 over [0, 1] and 0 over [1, 10], with many rows crowded in the first tenth.
  KeyNumbers numbers(0.0, 10.0);
  for (int row = 0; row <= 1000; ++row) numbers.add(row / 1000.0, -1.0);
  numbers.add(1.0, 0.0);
  numbers.add(10.0, 0.0);
  EXPECT_NEAR(numbers.rms(), std::sqrt(0.1), 1e-12);
  EXPECT_EQ(numbers.largest(), 1.0);
  EXPECT_EQ(numbers.late_amplitude(), 0.0);
}

TEST(KeyNumbers, TellWhenTheLargestCameFirstAndWhatWasLast) {
  KeyNumbers numbers(0.0, 3.0);
  EXPECT_TRUE(std::isnan(numbers.time_of_largest()) && std::isnan(numbers.last()));
  for (const auto& [t, x] : {std::pair{0.0, 1.0}, {1.0, -4.0}, {2.0, 4.0}, {3.0, 2.0}}) numbers.add(t, x);
  EXPECT_EQ(numbers.largest(), 4.0);
  EXPECT_EQ(numbers.time_of_largest(), 1.0);
  EXPECT_EQ(numbers.last(), 2.0);
}

TEST(KeyNumbers, OfNothingAreNaNAndOfOneRowItsSize) {
  KeyNumbers numbers(0.0, 0.0);
  numbers.add(0.0, nan_value);
  EXPECT_TRUE(std::isnan(numbers.rms()) && std::isnan(numbers.largest()) && std::isnan(numbers.late_amplitude()));
  numbers.add(0.0, -2.0);
  EXPECT_EQ(numbers.rms(), 2.0);
  EXPECT_EQ(numbers.late_amplitude(), 0.0);
}

}  // namespace
}  // namespace rubato::report
