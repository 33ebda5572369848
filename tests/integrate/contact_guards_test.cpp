#include <rubato/integrate/driver.hpp>

#include "support/adaptive_run.hpp"
#include "support/contact_problems.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

// Steps that choose themselves end where the ends of contacts meet and part, as they do at stops.
namespace rubato::integrate {
namespace {

using std::numbers::pi;

constexpr double released = 0.1;

/// A mass on a spring of 1 N/m, released at 0.1 m, against a contact or a stop at 0.
system::LocallyNonlinear rebounding(double stiffness, bool by_contact) {
  auto parts = testing::masses(Vector::Ones(1), Vector::Zero(1), Vector::Ones(1));
  parts.start.q = Vector::Constant(1, released);
  if (by_contact)
    parts.blocks = {testing::contact("contact", {0, 0.0, stiffness, 0.0, 0.0}, {{{{0, -1.0}}}})};
  else
    parts.stops = {{"stop", ground, 0, 0.0, stiffness, 0.0}};
  return system::LocallyNonlinear(std::move(parts));
}

/// Arcs of cosines: a half period of the spring, then one of both springs.
double rebound(double stiffness, double t) {
  const double w = std::sqrt(1.0 + stiffness);
  if (t < 0.5 * pi) return released * std::cos(t);
  const double s = std::fmod(t - 0.5 * pi, pi + pi / w);
  return s < pi / w ? -released * std::sin(w * s) / w : released * std::sin(s - pi / w);
}

TEST(ContactGuards, KeepTheToleranceOfReboundsHoweverStiff) {
  constexpr double tolerance = 1e-3, end = 20.0;
  for (const char* method : {"generalized_alpha", "wilson_theta"})
    for (const double stiffness : {1e3, 1e6, 1e9, 1e12}) {
      SCOPED_TRACE(method);
      SCOPED_TRACE(stiffness);
      const auto run = testing::run_adaptively(rebounding(stiffness, true), method, tolerance, end);
      const auto at_stop = testing::run_adaptively(rebounding(stiffness, false), method, tolerance, end);
      const auto error_of = [&](const auto& one) {
        double largest = 0.0;
        for (const system::State& state : one.states)
          largest = std::max(largest, std::abs(state.q[0] - rebound(stiffness, state.t)));
        return largest;
      };
      if (method == std::string("generalized_alpha"))
        EXPECT_LE(error_of(run), 4.0 * tolerance * released);
      else
        EXPECT_LE(error_of(run), 4.0 * error_of(at_stop));
      EXPECT_LE(run.states.size(), at_stop.states.size() + at_stop.states.size() / 10);
    }
}

TEST(ContactGuards, TellWhereTheEndsMeetAndPart) {
  constexpr double stiffness = 1e4, end = 12.0;
  const auto system = rebounding(stiffness, true);
  const auto run = testing::run_adaptively(system, "generalized_alpha", 1e-5, end);
  const double w = std::sqrt(1.0 + stiffness);
  for (int bounce = 0; bounce < 3; ++bounce) {
    const double meets = 0.5 * pi + bounce * (pi + pi / w);
    EXPECT_LE(run.distance(meets), 2e-5);
    EXPECT_LE(run.distance(meets + pi / w), 2e-5);
  }
}

// With friction in two directions beside separation.
TEST(ContactGuards, KeepTheToleranceWithFriction) {
  // Problem S of the friction family, transient from rest at w = 1.6: x, y, z at t = 10 by fine equal steps.
  const auto system = testing::in_space();
  const auto stepper = make_stepper(make_method("average_acceleration"), system);
  system::State fine = consistent_start(system, system.start()), half = fine;
  ASSERT_EQ(march(*stepper, fine, 1e-3, 10.0, nullptr, nullptr).end, MarchEnd::reached);
  ASSERT_EQ(march(*stepper, half, 5e-4, 10.0, nullptr, nullptr).end, MarchEnd::reached);
  const Vector expected = half.q + (half.q - fine.q) / 3.0;
  for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
    SCOPED_TRACE(tolerance);
    const auto run = testing::run_adaptively(system, "generalized_alpha", tolerance, 10.0);
    EXPECT_LE((run.end().q - expected).cwiseAbs().maxCoeff(), 3.0 * tolerance);
  }
}

}  // namespace
}  // namespace rubato::integrate
