#include <rubato/core/error.hpp>

#include <support/laws.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rubato::model {
namespace {

using rubato::testing::made;

TEST(SmoothFriction, ComesNearToCoulombsWithTheRate) {
  const auto law = made("smooth_friction", {0.4, 5.0, 0.01});
  EXPECT_EQ(law->at({}, nullptr).force, 0.0);
  EXPECT_DOUBLE_EQ(law->at({}, nullptr).by_rate, 200.0);
  EXPECT_DOUBLE_EQ(law->at({0.0, 0.01}, nullptr).force, 2.0 * std::tanh(1.0));
  EXPECT_DOUBLE_EQ(law->at({0.0, -3.0}, nullptr).force, -2.0);
  EXPECT_EQ(law->at({0.0, 1e3}, nullptr).by_rate, 0.0);
  constexpr double h = 1e-7, rate = 0.004;
  EXPECT_NEAR(law->at({0.0, rate}, nullptr).by_rate,
              (law->at({0.0, rate + h}, nullptr).force - law->at({0.0, rate - h}, nullptr).force) / (2.0 * h), 1e-6);
}

TEST(SmoothFriction, DissipatesAllOfItsWork) {
  const auto law = made("smooth_friction", {0.4, 5.0, 0.01});
  for (const auto& [before, after] : {std::pair{0.3, 0.5}, {-0.2, 0.3}, {0.004, -0.008}, {0.0, 0.0}}) {
    const double h = 0.2;
    double work = 0.0;
    constexpr int parts = 20000;
    for (int i = 0; i < parts; ++i) {
      const double rate = before + (i + 0.5) / parts * (after - before);
      work += h / parts * rate * law->at({0.0, rate}, nullptr).force;
    }
    const double lost =
        law->dissipated({0.0, before, 1.0}, nullptr, {0.5 * h * (before + after), after, 1.0 + h}, nullptr);
    EXPECT_NEAR(lost, work, 1e-4 * std::abs(work)) << before;
    EXPECT_GE(lost, 0.0);
  }
}

TEST(SmoothFriction, RefusesWhatItCannotBe) {
  EXPECT_THROW(made("smooth_friction", {-0.1, 1.0, 0.1}), InvalidInput);
  EXPECT_THROW(made("smooth_friction", {0.1, -1.0, 0.1}), InvalidInput);
  EXPECT_THROW(made("smooth_friction", {0.1, 1.0, 0.0}), InvalidInput);
  EXPECT_THROW(made("smooth_friction", {0.1, 1.0, std::nan("")}), InvalidInput);
}

}  // namespace
}  // namespace rubato::model
