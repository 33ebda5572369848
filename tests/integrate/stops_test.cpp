#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/methods/alpha_step.hpp>
#include <rubato/integrate/stability.hpp>

#include "support/adaptive_run.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace rubato::integrate {
namespace {

constexpr double m = 2.0, k = 800.0, gap = 0.05, v0 = 0.8;

/// A free mass that flies at a stop on the ground.
system::LocallyNonlinear flying_mass(double damping, bool is_between_two = false, double stiffness = k) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(m * Matrix::Identity(1, 1));
  parts.damping = parts.stiffness = SparseMatrix(1, 1);
  parts.stops = {{"wall", 0, ground, gap, stiffness, damping}};
  if (is_between_two) parts.stops.push_back({"other", ground, 0, gap, stiffness, damping});
  parts.start.q = Vector::Zero(1);
  parts.start.v = Vector::Constant(1, v0);
  parts.coordinates = {"mass"};
  return system::LocallyNonlinear(std::move(parts));
}

class Impact : public ::testing::TestWithParam<std::string> {};

// Free flight is exact for every method, so that the gap closes at gap/v0 to the resolution, 1e-12 of the march, and
// the round-off of the times. In contact the mass is an oscillator for half a period, and its speed is reversed: to
// the tolerance, which is relative to the displacement of the whole march (about 0.1 m; in contact v = omega u).
TEST_P(Impact, LastsHalfAPeriodAndReversesTheSpeed) {
  const double end = 0.25, tolerance = 1e-6, omega = std::sqrt(k / m);
  const testing::AdaptiveRun passage = testing::run_adaptively(flying_mass(0.0), GetParam(), tolerance, end);
  EXPECT_EQ(passage.report.events, 2);
  EXPECT_NEAR(passage.nearest(gap / v0), gap / v0, 2e-12 * end);
  const double opening = gap / v0 + std::numbers::pi / omega, slack = 10.0 * tolerance * 0.1;
  EXPECT_NEAR(passage.nearest(opening), opening, slack / v0);
  EXPECT_NEAR(passage.end().v[0], -v0, slack * omega);
  EXPECT_NEAR(passage.end().q[0], gap - v0 * (end - opening), 2.0 * slack);
}

// u = v0 exp(-d t) sin(w t)/w until the force, and with it u'', vanishes: tan(w t) = -2 d w/(w^2 - d^2).
TEST_P(Impact, OnADampedStopEndsWhereTheForceVanishes) {
  const double c = 12.0, d = c / (2.0 * m), w = std::sqrt(k / m - d * d);
  const double contact = (std::numbers::pi - std::atan(2.0 * d * w / (w * w - d * d))) / w;
  const double rebound = v0 * std::exp(-d * contact) * (std::cos(w * contact) - d / w * std::sin(w * contact));
  ASSERT_LT(rebound, -0.3 * v0);
  const double end = 0.25, tolerance = 1e-6, slack = 10.0 * tolerance * 0.1;
  const testing::AdaptiveRun passage = testing::run_adaptively(flying_mass(c), GetParam(), tolerance, end);
  EXPECT_EQ(passage.report.events, 2);
  EXPECT_NEAR(passage.nearest(gap / v0), gap / v0, 2e-12 * end);
  EXPECT_NEAR(passage.nearest(gap / v0 + contact), gap / v0 + contact, slack / v0);
  EXPECT_NEAR(passage.end().v[0], rebound, slack * w);
  for (const auto& state : passage.states) EXPECT_GE(state.slider_force[0], 0.0);
}

// From one wall to the other and back: 2 (2 gap/v0 + pi/omega).
TEST_P(Impact, BetweenTwoStopsIsPeriodic) {
  const double period = 2.0 * (2.0 * gap / v0 + std::numbers::pi / std::sqrt(k / m)), tolerance = 1e-6;
  const testing::AdaptiveRun passage =
      testing::run_adaptively(flying_mass(0.0, true), GetParam(), tolerance, 2.0 * period);
  EXPECT_EQ(passage.report.events, 8);
  const double slack = 10.0 * tolerance * 0.1;
  EXPECT_NEAR(passage.end().q[0], 0.0, 4.0 * slack);
  EXPECT_NEAR(passage.end().v[0], v0, slack * std::sqrt(k / m));
}

INSTANTIATE_TEST_SUITE_P(Methods, Impact,
                         ::testing::Values("generalized_alpha", "hht", "average_acceleration", "wilson_theta",
                                           "bogacki_shampine", "dormand_prince"),
                         [](const auto& info) { return info.param; });

// A contact of a millisecond or a microsecond in a march of a quarter of a second: far below the displacements that the
// tolerance is measured by, but the whole motion after it is what it makes of the velocity. Bound: a few tolerances of
// the speed.
TEST(HardStop, ReboundsWithinTheToleranceHoweverLooseItIs) {
  constexpr double end = 0.25;
  for (const double hard : {2e7, 1e10, 1e13})
    for (const double share : {0.0, 0.03, 0.3}) {  // of critical damping
      const double c = 2.0 * share * std::sqrt(hard * m), d = c / (2.0 * m), w = std::sqrt(hard / m - d * d);
      const double contact = (std::numbers::pi - std::atan(2.0 * d * w / (w * w - d * d))) / w;
      const double rebound = v0 * std::exp(-d * contact) * (std::cos(w * contact) - d / w * std::sin(w * contact));
      for (const std::string method : {"generalized_alpha", "hht", "wilson_theta", "dormand_prince"})
        for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
          // Wilson-theta takes its forces from beyond the step: of a contact that it has not met, or has left.
          const bool is_wilson = method == "wilson_theta";
          if (is_wilson && hard > 1e10) continue;
          const double few = is_wilson ? 6.0 : 3.0;
          const testing::AdaptiveRun passage =
              testing::run_adaptively(flying_mass(c, false, hard), method, tolerance, end);
          EXPECT_NEAR(passage.end().v[0], rebound, few * tolerance * v0)
              << method << " " << hard << " " << share << " " << tolerance;
        }
    }
}

class FixedSteps : public ::testing::TestWithParam<std::string> {};

// Steps that know nothing of events: the rebound of a damped impact converges with first order at least.
TEST_P(FixedSteps, ConvergeToTheDampedRebound) {
  const double c = 12.0, d = c / (2.0 * m), w = std::sqrt(k / m - d * d), end = 0.25;
  const double contact = (std::numbers::pi - std::atan(2.0 * d * w / (w * w - d * d))) / w;
  const double rebound = v0 * std::exp(-d * contact) * (std::cos(w * contact) - d / w * std::sin(w * contact));
  const auto system = flying_mass(c);
  for (const double h : {1e-4, 1e-5}) {
    const auto stepper = make_stepper(make_method(GetParam()), system);
    system::State state = consistent_start(system, system.start());
    ASSERT_EQ(march(*stepper, state, h, end).end, MarchEnd::reached);
    // Within a step of the closing the dashpot, whose force jumps by c v0, is missed or added: c v0 h/m of velocity.
    EXPECT_NEAR(state.v[0], rebound, 2.0 * c * v0 * h / m) << h;
    EXPECT_EQ(state.slider_force[0], 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, FixedSteps,
                         ::testing::Values("generalized_alpha", "hht", "wbz", "average_acceleration",
                                           "linear_acceleration", "central_difference", "wilson_theta", "exponential",
                                           "rk4", "heun"),
                         [](const auto& info) { return info.param; });

/// Six masses in a chain with two sliders and four stops, two of them between the same masses.
system::LocallyNonlinear rattling_chain(double damping) {
  const auto linear = testing::chain(6, 2);
  system::LocallyNonlinear::Parts parts;
  parts.mass = linear.mass();
  parts.damping = linear.damping();
  parts.stiffness = linear.stiffness();
  parts.sliders = linear.sliders();
  parts.loads = linear.loads();
  parts.coordinates = linear.coordinates();
  parts.stops = {{"a", 0, ground, 0.5, 20.0, damping},
                 {"b", 2, 4, 0.6, 10.0, damping},
                 {"c", 4, 2, 0.6, 10.0, damping},
                 {"d", ground, 5, 1.0, 40.0, 0.0}};
  return system::LocallyNonlinear(std::move(parts));
}

double difference(const system::State& a, const system::State& b) { return (a.q - b.q).norm() + (a.v - b.v).norm(); }

// Many contacts at once against two hundred thousand steps of a method that knows nothing of events. The tolerance is
// relative to the response, some 10 m in its norm; transitions amplify errors by the differences of velocities.
TEST(RattlingChain, IsTheSameWhicheverMethodLocatesItsTransitions) {
  const double end = 20.0;
  for (const double damping : {0.0, 2.0}) {
    const auto system = rattling_chain(damping);
    const testing::AdaptiveRun fine = testing::run_adaptively(system, "dormand_prince", 1e-9, end),
                               coarse = testing::run_adaptively(system, "generalized_alpha", 1e-5, end);
    EXPECT_GT(fine.report.events, 20);
    EXPECT_EQ(fine.report.events, coarse.report.events);
    EXPECT_LT(difference(fine.end(), coarse.end()), 100.0 * 1e-5 * 10.0);
    if (damping > 0.0) continue;
    const auto stepper = make_stepper(make_method("rk4"), system);
    system::State state = consistent_start(system, system.start());
    ASSERT_EQ(march(*stepper, state, 1e-4, end).end, MarchEnd::reached);
    // A kink passed within a step h errs by the jump of the rate of force, some 100 N/s, times h^2: 1e-6 in all.
    EXPECT_LT(difference(fine.end(), state), 2e-6);
  }
}

// Wilson-theta and linear acceleration: the force at t + theta h is of a contact that a step which ends there has not
// met.
TEST(WilsonTheta, ComparesNoTwoSolutionsWhereThereAreStops) {
  const auto system = flying_mass(12.0);
  const Method method = make_method("wilson_theta");
  const auto stepper = make_stepper(method, system);
  EXPECT_THROW((void)make_estimator(Embedded{1e-3}, method, system, *stepper, 0.25), InvalidInput);
}

// A closed stop is a spring like others: omega h = 2.
TEST(StabilityLimit, IsThatOfTheClosedStop) {
  const ModelStability limit = stability_of(make_method("central_difference"), flying_mass(0.0));
  EXPECT_NEAR(limit.step, 2.0 / std::sqrt(k / m), 1e-6 * limit.step);
}

// A chain long enough for either implementation, sliders and damped and undamped stops on it, one between two masses.
TEST(SparseStep, AgreesWithTheDenseOneOnSlidersAndStops) {
  const auto linear = testing::chain(40, 4);
  system::LocallyNonlinear::Parts parts;
  parts.mass = linear.mass();
  parts.damping = linear.damping();
  parts.stiffness = linear.stiffness();
  parts.sliders = linear.sliders();
  parts.loads = linear.loads();
  parts.coordinates = linear.coordinates();
  parts.stops = {{"a", 13, ground, 0.5, 20.0, 0.0},
                 {"b", ground, 13, 0.7, 20.0, 3.0},
                 {"c", 20, 22, -0.1, 5.0, 1.0},
                 {"d", 20, 13, 0.2, 50.0, 0.0}};
  const system::LocallyNonlinear system(std::move(parts));
  for (const GeneralizedAlpha& p : {GeneralizedAlpha{}, std::get<GeneralizedAlpha>(make_method("hht").formula)}) {
    const auto dense = make_dense_alpha_step(p, system), sparse = make_sparse_alpha_step(p, system);
    const double h = 0.05;
    ASSERT_TRUE(dense->prepare(h) && sparse->prepare(h));
    system::State a = consistent_start(system, system.start()), b = a, from = a;
    std::vector<bool> has_pushed(4, false);
    double largest = 0.0;
    for (int step = 0; step < 1000; ++step) {
      std::vector<double> load;
      for (const auto& term : system.loads().terms()) load.push_back(model::value(term.law, h * step));
      ASSERT_EQ(dense->solve(from, load.data(), a).outcome, StepOutcome::accepted);
      ASSERT_EQ(sparse->solve(from, load.data(), b).outcome, StepOutcome::accepted);
      for (std::size_t j = 0; j < 4; ++j) has_pushed[j] = has_pushed[j] || a.slider_force[4 + Index(j)] > 0.0;
      largest = std::max(largest, a.slider_force.cwiseAbs().maxCoeff());
      ASSERT_LT((a.slider_force - b.slider_force).cwiseAbs().maxCoeff(), 1e-11 * largest) << step;
      ASSERT_LT((a.q - b.q).cwiseAbs().maxCoeff(), 1e-11 * largest) << step;
      from = a;
    }
    for (std::size_t j = 0; j < 4; ++j) EXPECT_TRUE(has_pushed[j]) << j;
  }
}

}  // namespace
}  // namespace rubato::integrate
