#include <rubato/core/error.hpp>
#include <rubato/model/laws/law_slopes.hpp>

#include <support/laws.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rubato::model {
namespace {

using rubato::testing::made;

constexpr double sigma = 30.0, limit = 2.0;

/// Dahl's equation in small steps of Runge's and Kutta's method.
double dahl_in_small_steps(double f, double travel) {
  const double way = travel > 0.0 ? 1.0 : -1.0, h = travel / 4000;
  const auto slope = [&](double at) { return sigma * (1.0 - at * way / limit); };
  for (int i = 0; i < 4000; ++i) {
    const double k1 = slope(f), k2 = slope(f + 0.5 * h * k1), k3 = slope(f + 0.5 * h * k2), k4 = slope(f + h * k3);
    f += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return f;
}

TEST(Dahl, FollowsItsEquationBetweenTurns) {
  const auto law = made("dahl", {sigma, limit});
  for (const double f : {-1.9, -0.4, 0.0, 1.3})
    for (const double travel : {-0.3, -0.01, 0.02, 0.15, 0.6}) {
      double next = 0.0;
      const LawAnswer answer = law->advance({0.1, 0.0}, &f, {0.1 + travel, 1.0}, &next);
      EXPECT_NEAR(answer.force, dahl_in_small_steps(f, travel), 1e-10) << f << " " << travel;
      EXPECT_EQ(next, answer.force);
      // In two parts.
      double half = 0.0, whole = 0.0;
      law->advance({0.1, 0.0}, &f, {0.1 + 0.4 * travel, 0.0}, &half);
      law->advance({0.1 + 0.4 * travel, 0.0}, &half, {0.1 + travel, 0.0}, &whole);
      EXPECT_NEAR(whole, next, 1e-14);
    }
}

// friction-family reference, section 10: F = s Fc + (F_r - s Fc) exp(-sigma |u - u_r|/Fc). A Bouc-Wen element with n =
// 1, gamma = 0 and beta = sigma/Fc is the same law.
TEST(Dahl, IsABoucWenElementOfTheFirstOrder) {
  const auto dahl = made("dahl", {sigma, limit}), wen = made("bouc_wen", {sigma, 0.0, 1.0, sigma / limit, 0.0, 1.0});
  double f = 0.0, z = 0.0, u = 0.0, lost = 0.0, lost_by_wen = 0.0;
  for (const double to : {0.05, 0.3, 0.1, -0.4, -0.39, 0.0, 0.02}) {
    double f1 = 0.0, z1 = 0.0;
    const LawAnswer a = dahl->advance({u, 0.0}, &f, {to, 1.0}, &f1), b = wen->advance({u, 0.0}, &z, {to, 1.0}, &z1);
    EXPECT_NEAR(a.force, b.force, 1e-14);
    EXPECT_NEAR(a.by_u, b.by_u, 1e-13);
    lost += dahl->dissipated({u, 0.0}, &f, {to, 1.0}, &f1);
    lost_by_wen += wen->dissipated({u, 0.0}, &z, {to, 1.0}, &z1);
    EXPECT_NEAR(dahl->stored_energy(to, &f1), wen->stored_energy(to, &z1), 1e-14);
    u = to;
    f = f1;
    z = z1;
  }
  EXPECT_NEAR(lost, lost_by_wen, 1e-3 * lost);  // whose quadrature crosses the kink at z = 0
}

TEST(Dahl, StoresAndDissipatesItsWork) {
  const auto law = made("dahl", {sigma, limit});
  for (const double f : {-1.7, 0.3, 1.9})
    for (const double travel : {-0.8, -0.02, 1e-9, 0.05, 0.4}) {
      // The work of the exponential in closed form.
      const double way = std::copysign(1.0, travel), x = sigma * std::abs(travel) / limit;
      const double work = limit * limit / sigma * (x - (f * way / limit - 1.0) * std::expm1(-x));
      double next = 0.0;
      law->advance({0.0, 0.0}, &f, {travel, 0.0}, &next);
      const double lost = law->dissipated({0.0, 0.0}, &f, {travel, 0.0}, &next);
      EXPECT_GE(lost, 0.0);
      EXPECT_NEAR(law->stored_energy(travel, &next) - law->stored_energy(0.0, &f) + lost, work, 1e-15);
    }
}

TEST(Dahl, HasTheSlopesThatBelongToItsForce) {
  const auto law = made("dahl", {sigma, limit});
  const auto* own = dynamic_cast<const LawSlopes*>(law.get());
  ASSERT_NE(own, nullptr);
  const auto end = [&](double u0, double f, double u1) {
    double next = 0.0;
    return law->advance({u0, 0.0}, &f, {u1, 0.0}, &next).force;
  };
  for (const double f : {-1.5, 0.2})
    for (const double travel : {-0.07, 0.03}) {
      double slopes[10] = {};
      own->slopes({0.0, 0.0}, &f, {travel, 0.0}, slopes);
      constexpr double h = 1e-6;
      EXPECT_NEAR(slopes[0], (end(0.0, f, travel + h) - end(0.0, f, travel - h)) / (2.0 * h), 1e-6);
      EXPECT_NEAR(slopes[2], (end(h, f, travel) - end(-h, f, travel)) / (2.0 * h), 1e-6);
      EXPECT_NEAR(slopes[4], (end(0.0, f + h, travel) - end(0.0, f - h, travel)) / (2.0 * h), 1e-8);
      for (int i = 0; i < 5; ++i) EXPECT_EQ(slopes[5 + i], slopes[i]);
    }
}

TEST(Dahl, LoadsAndUnloadsWithOtherSlopesAwayFromZero) {
  const auto law = made("dahl", {sigma, limit});
  const double f = 1.0;
  EXPECT_EQ(law->at({0.0, 1.0}, &f).by_u, 15.0);
  EXPECT_EQ(law->at({0.0, -1.0}, &f).by_u, 45.0);
  EXPECT_EQ(law->at({0.0, 0.0}, &f).by_u, 30.0);
}

TEST(Dahl, RefusesWhatItCannotBe) {
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_THROW(made("dahl", {bad, 1.0}), InvalidInput) << bad;
    EXPECT_THROW(made("dahl", {1.0, bad}), InvalidInput) << bad;
  }
}

}  // namespace
}  // namespace rubato::model
