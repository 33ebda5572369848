#include <rubato/analysis/steady/optimum.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rubato::analysis {
namespace {

/// Bells over x, each with a height and a place that depend on p; one curve, or a curve each.
class Bells : public PeakFamily {
 public:
  struct Bell {
    std::function<double(double)> height, place;
    double width = 0.1;
  };
  Bells(std::vector<Bell> bells, bool are_apart = false, std::vector<double> besides = {})
      : bells_(std::move(bells)), are_apart_(are_apart), range_{1.0, 4.0, 33, std::move(besides)} {}

  std::vector<Peak> peaks(double p) override { return find_peaks(curves(p), range_); }
  std::optional<Peak> follow(double p, const Peak& known) override { return follow_peak(curves(p), range_, known); }

  std::optional<Optimum> optimum(double from, double to, int samples, double sign = 1.0) {
    std::vector<double> at, values;
    for (int i = 0; i < samples; ++i) {
      at.push_back(from + (to - from) * i / (samples - 1));
      const auto found = peaks(at.back());
      values.push_back(found.empty() ? NAN : found.front().value);
    }
    return find_optimum(*this, at, values, sign);
  }

 private:
  Curves curves(double p) const {
    return [this, p](double x, Vector& values) {
      values.setZero(are_apart_ ? static_cast<Index>(bells_.size()) : 1);
      for (std::size_t i = 0; i < bells_.size(); ++i) {
        const double r = (x - bells_[i].place(p)) / bells_[i].width;
        values[are_apart_ ? static_cast<Index>(i) : 0] += bells_[i].height(p) * std::exp(-r * r);
      }
      return true;
    };
  }

  std::vector<Bell> bells_;
  bool are_apart_;
  PeakRange range_;
};

TEST(Optimum, OfOnePeakIsWhereBothDerivativesVanish) {
  Bells bells({{[](double p) { return 3.0 + 0.5 * (p - 2.3) * (p - 2.3); }, [](double p) { return 2.0 + 0.1 * p; }}});
  const auto found = bells.optimum(0.5, 5.0, 10);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Optimum::Kind::smooth);
  EXPECT_NEAR(found->parameter, 2.3, 1e-6);
  EXPECT_NEAR(found->active.at(0).at, 2.23, 1e-7);
  EXPECT_NEAR(found->active.at(0).value, 3.0, 1e-11);
  EXPECT_NEAR(found->derivative[0], 0.0, 1e-7);
  EXPECT_NEAR(found->curvature, 1.0, 1e-3);
}

TEST(Optimum, MayBeTheHighestOfTheCurve) {
  Bells bells({{[](double p) { return 3.0 - 0.5 * (p - 2.3) * (p - 2.3); }, [](double) { return 2.0; }}});
  const auto found = bells.optimum(1.0, 4.0, 10, -1.0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Optimum::Kind::smooth);
  EXPECT_NEAR(found->parameter, 2.3, 1e-6);
  EXPECT_NEAR(found->curvature, -1.0, 1e-3);
}

// One peak falls steeply, the other hardly rises: wherever among the samples they cross, the search ends beside the
// crossing, and must see it.
TEST(Optimum, OfTwoPeaksOfUnequalSlopesIsTheirCrossing) {
  for (int i = 0; i < 25; ++i) {
    const double at = 2.0 + 0.0137 * i;
    Bells bells({{[&](double p) { return 1.0 + 1e-3 * (p - at); }, [](double) { return 3.3; }},
                 {[&](double p) { return 1.0 - 0.1 * (p - at); }, [](double) { return 1.7; }}});
    const auto found = bells.optimum(0.7, 4.9, 9);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->kind, Optimum::Kind::kink) << at;
    EXPECT_NEAR(found->parameter, at, 1e-7);
    EXPECT_NEAR(found->active.front().value, 1.0, 1e-9);
  }
}

// Heights p and 8/p^2 are equal at p = 2, with the derivatives 1 and -2: these vanish in the sum with weights 2/3 and
// 1/3.
TEST(Optimum, OfTwoEqualPeaksHasMultipliersThatWeighTheirDerivativesToZero) {
  const auto rising = [](double p) { return p; };
  const auto falling = [](double p) { return 8.0 / (p * p); };
  for (const bool are_apart : {false, true}) {
    Bells bells({{rising, [](double) { return 1.7; }}, {falling, [](double p) { return 3.3 + 0.01 * p; }}}, are_apart);
    const auto found = bells.optimum(0.7, 4.9, 9);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->kind, Optimum::Kind::kink) << are_apart;
    EXPECT_NEAR(found->parameter, 2.0, 1e-8);
    const std::size_t first = found->active.at(0).at < 2.5 ? 0 : 1;
    EXPECT_EQ(found->active[first].curve == found->active[1 - first].curve, !are_apart);
    EXPECT_NEAR(found->active[first].at, 1.7, 1e-7);
    EXPECT_NEAR(found->active[1 - first].value, 2.0, 1e-8);
    EXPECT_NEAR(found->derivative[first], 1.0, 1e-6);
    EXPECT_NEAR(found->derivative[1 - first], -2.0, 1e-6);
    EXPECT_NEAR(found->multiplier[first], 2.0 / 3.0, 1e-6);
    EXPECT_NEAR(found->multiplier[0] * found->derivative[0] + found->multiplier[1] * found->derivative[1], 0.0, 1e-12);
  }
}

// As blades that are mistuned by little, or masses that are coupled weakly.
TEST(Optimum, OfTwoEqualPeaksThatAreCloseIsTheirCrossing) {
  for (const double apart : {0.1, 0.03, 0.01, 0.002}) {
    const double width = 0.15 * apart;
    Bells bells(
        {{[](double p) { return p; }, [](double) { return 2.0; }, width},
         {[](double p) { return 8.0 / (p * p); }, [&](double p) { return 2.0 + apart + 1e-3 * apart * p; }, width}},
        false, {2.0 - apart, 2.0, 2.0 + 0.5 * apart, 2.0 + apart, 2.0 + 2.0 * apart});
    const auto found = bells.optimum(0.7, 4.9, 9);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->kind, Optimum::Kind::kink) << apart;
    EXPECT_NEAR(found->parameter, 2.0, 1e-7);
    ASSERT_EQ(found->active.size(), 2u);
    const std::size_t first = found->active[0].at < 2.0 + 0.5 * apart ? 0 : 1;
    EXPECT_NEAR(found->derivative[first], 1.0, 1e-5);
    EXPECT_NEAR(found->derivative[1 - first], -2.0, 1e-5);
  }
}

// One peak that moves by a third of its place over the range is one all the same.
TEST(Optimum, OfOnePeakThatMovesIsSmooth) {
  Bells bells({{[](double p) { return 3.0 + 0.5 * (p - 2.3) * (p - 2.3); }, [](double p) { return 1.3 + 0.5 * p; }}});
  const auto found = bells.optimum(0.5, 5.0, 10);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Optimum::Kind::smooth);
  EXPECT_NEAR(found->parameter, 2.3, 1e-6);
}

TEST(Optimum, BeyondTheRangeIsItsEnd) {
  Bells falling({{[](double p) { return 1.0 / p; }, [](double) { return 2.0; }}});
  const auto upper = falling.optimum(1.0, 4.0, 7);
  ASSERT_TRUE(upper);
  EXPECT_EQ(upper->kind, Optimum::Kind::bound);
  EXPECT_EQ(upper->parameter, 4.0);
  EXPECT_NEAR(upper->derivative[0], -1.0 / 16.0, 1e-4);
  Bells rising({{[](double p) { return p; }, [](double) { return 2.0; }}});
  const auto lower = rising.optimum(1.0, 4.0, 7);
  ASSERT_TRUE(lower);
  EXPECT_EQ(lower->kind, Optimum::Kind::bound);
  EXPECT_EQ(lower->parameter, 1.0);
}

TEST(Optimum, BetweenAnEndAndItsNeighbourIsNoBound) {
  Bells bells({{[](double p) { return 3.0 + (p - 1.1) * (p - 1.1); }, [](double) { return 2.0; }}});
  const auto found = bells.optimum(1.0, 4.0, 7);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Optimum::Kind::smooth);
  EXPECT_NEAR(found->parameter, 1.1, 1e-6);
}

TEST(Optimum, OfACurveThatDoesNotChangeIsFlat) {
  Bells bells({{[](double) { return 2.5; }, [](double) { return 2.0; }}});
  const auto found = bells.optimum(1.0, 4.0, 7);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Optimum::Kind::flat);
  EXPECT_NEAR(found->active.at(0).value, 2.5, 1e-12);
}

// A level from 2.9 on, and a dip before it, at 2.8. On the level round-off makes one of the samples the lowest.
TEST(Optimum, BesideALevelIsWhereTheCurveDips) {
  const auto height = [](double p) {
    return p < 2.9 ? 1.9 + 10.0 * (p - 2.8) * (p - 2.8) : 2.0 + 1e-14 * (p - 11.0 / 3.0) * (p - 11.0 / 3.0);
  };
  const auto mirrored = [&](double p) { return height(6.0 - p); };
  for (const int samples : {2, 4, 6, 7}) {
    for (const bool is_mirrored : {false, true}) {
      Bells bells({{is_mirrored ? std::function<double(double)>(mirrored) : height, [](double) { return 2.0; }}});
      const auto found = bells.optimum(1.0, 5.0, samples);
      ASSERT_TRUE(found);
      EXPECT_EQ(found->kind, Optimum::Kind::smooth) << samples;
      EXPECT_NEAR(found->parameter, is_mirrored ? 3.2 : 2.8, 1e-6) << samples;
      EXPECT_NEAR(found->active.at(0).value, 1.9, 1e-11) << samples;
    }
  }
  Bells level({{[](double p) { return p < 2.9 ? 2.0 + (2.9 - p) : 2.0; }, [](double) { return 2.0; }}});
  EXPECT_EQ(level.optimum(1.0, 5.0, 7)->kind, Optimum::Kind::flat);
}

// One peak that falls with slope -1 and rises with slope 3: weights 3/4 and 1/4.
TEST(Optimum, AtACornerHasTheSlopesOfBothSides) {
  Bells bells({{[](double p) { return 2.0 + (p < 2.2 ? 2.2 - p : 3.0 * (p - 2.2)); }, [](double) { return 2.0; }}});
  const auto found = bells.optimum(1.0, 4.0, 7);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Optimum::Kind::corner);
  EXPECT_NEAR(found->parameter, 2.2, 1e-7);
  EXPECT_NEAR(found->derivative[0], -1.0, 1e-4);
  EXPECT_NEAR(found->derivative[1], 3.0, 1e-3);
  EXPECT_NEAR(found->multiplier[0], 0.75, 1e-4);
}

TEST(Optimum, BesideAHigherPeakIsNotCertified) {
  // Where the first peak is lowest the second is higher: the largest of both is lowest at their crossing.
  Bells bells({{[](double p) { return 2.0 + (p - 2.0) * (p - 2.0); }, [](double) { return 1.7; }},
               {[](double p) { return 3.0 - 0.45 * p; }, [](double) { return 3.3; }}});
  const auto found = bells.optimum(1.0, 4.0, 4);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, Optimum::Kind::kink);
  // 2 + (p - 2)^2 = 3 - 0.45 p: p^2 - 3.55 p + 3 = 0
  EXPECT_NEAR(found->parameter, 0.5 * (3.55 + std::sqrt(3.55 * 3.55 - 12.0)), 1e-7);
}

TEST(Optimum, OfNothingIsNothing) {
  Bells bells({});
  EXPECT_FALSE(find_optimum(bells, {1.0, 2.0}, {NAN, NAN}, 1.0));
}

}  // namespace
}  // namespace rubato::analysis
