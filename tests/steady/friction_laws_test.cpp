#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/marching/time_marching.hpp>

#include <support/harmonic_response.hpp>
#include <support/laws.hpp>
#include <support/models.hpp>

#include <gtest/gtest.h>

#include <cmath>

// Steady motions of masses on laws of friction, by harmonic balance and by marching, against numbers computed elsewhere
// (friction-family reference) and against each other.
namespace rubato::steady {
namespace {

using testing::made;
using testing::mass_on;
using testing::observing;
using testing::respond;

SteadyResponse march(const system::LocallyNonlinear& system, double tolerance, int steps = 0,
                     const std::string& method = "generalized_alpha") {
  TimeMarchingOptions options;
  options.method = integrate::make_method(method);
  options.tolerance = tolerance;
  options.steps_per_period = steps;
  TimeMarchingSolver solver(system, std::move(options), observing({0}));
  SteadyResponse response;
  solver.solve(excitation_of(system), SteadyStart::unloaded, response);
  EXPECT_EQ(response.status, SteadyStatus::converged);
  return response;
}

// Section 10: m = 1, c = .05, k = 1, mu N = .5, F = 1, by shooting.
struct TanhPoint {
  double velocity, angular_frequency, amplitude, first;
};
constexpr TanhPoint tanh_points[] = {{0.01, 0.8, 2.12739446036, 2.14385005356},
                                     {0.01, 1.0, 7.26641049768, 7.26871386678},
                                     {0.1, 0.8, 2.10234285298, 2.11456242207},
                                     {0.1, 1.0, 7.26744558017, 7.26961841786}};

system::LocallyNonlinear tanh_mass(const TanhPoint& point) {
  return mass_on(made("smooth_friction", {0.5, 1.0, point.velocity}), 0.05, 1.0, 1.0, point.angular_frequency);
}

TEST(SmoothFrictionInSteadyMotion, IsThatOfShootingByHarmonics) {
  for (const TanhPoint& point : tanh_points) {
    SCOPED_TRACE(::testing::Message() << point.velocity << " " << point.angular_frequency);
    // Orders fall off slowly where the force all but jumps.
    const double tolerance = point.velocity < 0.05 ? 1e-4 : 1e-6;
    const SteadyResponse r = respond(tanh_mass(point), observing({0}), tolerance, 401);
    EXPECT_NEAR(r.amplitude[0], point.amplitude, tolerance * point.amplitude);
    EXPECT_NEAR(std::abs(r.harmonics(0, 0)), point.first, tolerance * point.first);
    EXPECT_NEAR(r.input_work, r.viscous_work + r.law_dissipated[0], 10.0 * tolerance * r.input_work);
  }
}

TEST(SmoothFrictionInSteadyMotion, IsThatOfShootingByMarching) {
  for (const TanhPoint& point : tanh_points) {
    SCOPED_TRACE(::testing::Message() << point.velocity << " " << point.angular_frequency);
    const SteadyResponse r = march(tanh_mass(point), 1e-4);
    EXPECT_NEAR(r.amplitude[0], point.amplitude, 1e-4 * point.amplitude);
    EXPECT_NEAR(r.input_work, r.viscous_work + r.law_dissipated[0], 1e-3 * r.input_work);
  }
}

// A Dahl element is a Bouc-Wen element of another table, whose steady motions are known.
TEST(DahlInSteadyMotion, IsThatOfTheSameBoucWenElement) {
  for (const double w : {0.9, 1.2, 1.6}) {
    SCOPED_TRACE(w);
    const auto dahl = mass_on(made("dahl", {1.5, 0.4}), 0.05, 1.0, 0.3, w);
    const auto wen = mass_on(made("bouc_wen", {1.5, 0.0, 1.0, 1.5 / 0.4, 0.0, 1.0}), 0.05, 1.0, 0.3, w);
    const SteadyResponse a = respond(dahl, observing({0}), 1e-6), b = respond(wen, observing({0}), 1e-6);
    EXPECT_NEAR(a.amplitude[0], b.amplitude[0], 1e-6 * b.amplitude[0]);
    EXPECT_NEAR(a.law_dissipated[0], b.law_dissipated[0], 1e-4 * b.law_dissipated[0]);
    EXPECT_NEAR(a.input_work, a.viscous_work + a.law_dissipated[0], 1e-5 * a.input_work);
    const SteadyResponse marched = march(dahl, 1e-4);
    EXPECT_NEAR(marched.amplitude[0], a.amplitude[0], 1e-4 * a.amplitude[0]);
    EXPECT_NEAR(marched.law_dissipated[0], a.law_dissipated[0], 1e-3 * a.law_dissipated[0]);
  }
}

// Section 8: m = 1, c = .01, k = 1, kT = 1, Fs = 1, chi = -.5, beta = .1, checked there by discrete sliders.
struct IwanPoint {
  double load, angular_frequency, amplitude;
};
constexpr IwanPoint iwan_points[] = {{0.02, 1.45, 0.0897531170606}, {0.02, 1.38, 0.204008685852},
                                     {0.02, 1.34, 0.299283407628},  {0.02, 1.2, 0.0414871758059},
                                     {0.2, 1.5, 0.399530561531},    {0.2, 1.4, 0.679171928624},
                                     {0.2, 1.25, 1.48279389507},    {0.2, 1.1, 0.355138167746}};
system::LocallyNonlinear iwan_mass(const IwanPoint& point) {
  return mass_on(made("iwan", {1.0, 1.0, -0.5, 0.1}), 0.01, 1.0, point.load, point.angular_frequency);
}

TEST(IwanInSteadyMotion, IsThatOfMasingsRulesByHarmonics) {
  for (const IwanPoint& point : iwan_points) {
    SCOPED_TRACE(::testing::Message() << point.load << " " << point.angular_frequency);
    const SteadyResponse r = respond(iwan_mass(point), observing({0}), 1e-6);
    EXPECT_NEAR(r.amplitude[0], point.amplitude, 1e-6 * point.amplitude);
    EXPECT_NEAR(r.input_work, r.viscous_work + r.law_dissipated[0], 1e-5 * r.input_work);
  }
}

TEST(IwanInSteadyMotion, IsThatOfMasingsRulesByMarching) {
  for (const IwanPoint& point : {iwan_points[2], iwan_points[4], iwan_points[6]}) {
    SCOPED_TRACE(::testing::Message() << point.load << " " << point.angular_frequency);
    const SteadyResponse r = march(iwan_mass(point), 1e-4);
    EXPECT_NEAR(r.amplitude[0], point.amplitude, 1e-4 * point.amplitude);
    EXPECT_NEAR(r.input_work, r.viscous_work + r.law_dissipated[0], 1e-3 * r.input_work);
  }
}

// A mean load makes loops that are not about zero: each stays within the first loading, and is forgotten once a period.
TEST(IwanInSteadyMotion, ClosesItsLoopsUnderAMeanLoad) {
  const auto system = mass_on(made("iwan", {1.0, 1.0, -0.5, 0.1}), 0.05, 1.0, 0.2, 1.3, 0.4);
  const SteadyResponse r = respond(system, observing({0}), 1e-5), marched = march(system, 1e-4);
  EXPECT_NEAR(r.amplitude[0], marched.amplitude[0], 2e-4 * r.amplitude[0]);
  // The mean depends on how the motion came about: a march passes larger motions on its way.
  EXPECT_NEAR(r.mean[0], marched.mean[0], 1e-2 * r.amplitude[0]);
  EXPECT_GT(r.mean[0], 0.1);
}

// Section 10: bristles far softer than those of the transient there, which a balance of harmonics follows.
TEST(LuGreInSteadyMotion, IsTheSameByHarmonicsAndByMarching) {
  for (const double w : {0.7, 1.3}) {
    SCOPED_TRACE(w);
    const auto system = mass_on(made("lugre", {20.0, 0.5, 0.1, 0.3, 0.4, 0.2}), 0.05, 1.0, 1.0, w);
    const SteadyResponse r = respond(system, observing({0}), 1e-4), marched = march(system, 1e-4);
    EXPECT_NEAR(r.amplitude[0], marched.amplitude[0], 3e-4 * r.amplitude[0]);
    EXPECT_NEAR(r.law_dissipated[0], marched.law_dissipated[0], 1e-3 * r.law_dissipated[0]);
    EXPECT_NEAR(r.input_work, r.viscous_work + r.law_dissipated[0], 2e-3 * r.input_work);
  }
}

// Section 7, at w = .8 between -1.18949144882 and 1.40830045242; u = x, so that it pulls back from x > 1.
TEST(CableInSteadyMotion, IsThatOfTheExactPieces) {
  const auto system = mass_on(made("cable", {9.0, 1.0}), 0.1, 1.0, 1.0, 0.8);
  const double amplitude = 0.5 * (1.40830045242 + 1.18949144882);
  EXPECT_NEAR(respond(system, observing({0}), 1e-6).amplitude[0], amplitude, 1e-6 * amplitude);
  EXPECT_NEAR(march(system, 1e-4).amplitude[0], amplitude, 1e-4 * amplitude);
}

}  // namespace
}  // namespace rubato::steady
