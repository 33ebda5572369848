#include <rubato/core/error.hpp>

#include <support/laws.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rubato::model {
namespace {

using rubato::testing::made;

TEST(Cable, OnlyPulls) {
  const auto law = made("cable", {9.0, 1.0});
  EXPECT_EQ(law->at({0.5, 1.0}, nullptr).force, 0.0);
  EXPECT_EQ(law->at({0.5, 1.0}, nullptr).by_u, 0.0);
  EXPECT_DOUBLE_EQ(law->at({1.5, 1.0}, nullptr).force, 4.5);
  EXPECT_EQ(law->at({1.5, 1.0}, nullptr).by_u, 9.0);
  EXPECT_DOUBLE_EQ(law->stored_energy(1.5, nullptr), 1.125);
  EXPECT_EQ(law->stored_energy(-3.0, nullptr), 0.0);
  // Just taut: as it goes on, from rest the mean of both.
  EXPECT_EQ(law->at({1.0, 0.0}, nullptr).by_u, 4.5);
  EXPECT_EQ(law->at({1.0, 2.0}, nullptr).by_u, 9.0);
  EXPECT_EQ(law->at({1.0, -2.0}, nullptr).by_u, 0.0);
  EXPECT_FALSE(law->is_odd());
  EXPECT_TRUE(std::isnan(law->at({std::nan(""), 0.0}, nullptr).force));
}

// Steps that end where it becomes taut or slack.
TEST(Cable, ChangesWhereItsLengthIsReached) {
  const auto law = made("cable", {9.0, 1.0});
  constexpr double near = 1e-9;
  EXPECT_GT(law->guard({0.5, 1.0}, nullptr, {0.9, 1.0}, near), 0.0);
  EXPECT_LT(law->guard({0.5, 1.0}, nullptr, {1.1, 1.0}, near), 0.0);
  EXPECT_GT(law->guard({1.5, -1.0}, nullptr, {1.2, -1.0}, near), 0.0);
  EXPECT_LT(law->guard({1.5, -1.0}, nullptr, {0.9, -1.0}, near), 0.0);
  // Where a step ended at the length to round-off, it goes on as the rate says.
  EXPECT_GT(law->guard({1.0 - 1e-12, 1.0}, nullptr, {1.1, 1.0}, near), 0.0);
  EXPECT_GT(law->guard({1.0 + 1e-12, -1.0}, nullptr, {0.9, -1.0}, near), 0.0);
}

TEST(Cable, RefusesWhatItCannotBe) {
  for (const double bad : {0.0, -2.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(made("cable", {bad, 1.0}), InvalidInput) << bad;
  EXPECT_THROW(made("cable", {1.0, std::nan("")}), InvalidInput);
}

}  // namespace
}  // namespace rubato::model
