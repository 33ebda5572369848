#include <rubato/integrate/steady/time_marching.hpp>

#include <support/models.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rubato::integrate {
namespace {

using testing::damper_model;
using testing::harmonic;
using testing::single_mass;

SteadyRequest observing(std::initializer_list<Index> coordinates) {
  SteadyRequest request;
  for (const Index i : coordinates) request.observed.push_back({i, ground});
  return request;
}

SteadyResponse response_of(const system::LocallyNonlinear& system, TimeMarchingOptions options, SteadyRequest request,
                           SteadyStart start = SteadyStart::unloaded) {
  TimeMarchingSolver solver(system, std::move(options), std::move(request));
  SteadyResponse response;
  solver.solve(excitation_of(system), start, response);
  return response;
}

TimeMarchingOptions with_method(const std::string& name, double tolerance = 1e-3, int steps = 0) {
  TimeMarchingOptions options;
  options.method = make_method(name);
  options.tolerance = tolerance;
  options.steps_per_period = steps;
  return options;
}

// Reference page, section 3: m = c = k = kT = f0 = 1, limit 0.15, omega = 2.
constexpr double single_amplitude = 0.2942542080903754;
constexpr double single_friction = 0.0865525248542252, single_viscous = 0.543603660209531,
                 single_input = 0.630156185063756;

TEST(TimeMarching, FindsTheAmplitudeOfTheSingleMassWithinItsTolerance) {
  const auto system = single_mass(0.15);
  for (const char* method : {"generalized_alpha", "average_acceleration", "exponential", "wilson_theta", "rk4", "hht",
                             "central_difference"}) {
    SCOPED_TRACE(method);
    const auto response = response_of(system, with_method(method), observing({0}));
    EXPECT_EQ(response.status, SteadyStatus::converged);
    EXPECT_LT(response.error, 1e-3);
    EXPECT_NEAR(response.amplitude[0], single_amplitude, 1e-3 * single_amplitude);
    EXPECT_EQ(response.transitions, 4);
    // Works follow the amplitude, and transitions are known to a step: a percent.
    EXPECT_NEAR(response.dissipated[0], single_friction, 0.01 * single_friction);
    EXPECT_NEAR(response.viscous_work, single_viscous, 0.01 * single_viscous);
    EXPECT_NEAR(response.input_work, single_input, 0.01 * single_input);
  }
}

TEST(TimeMarching, FindsTheSteadyBladesOfTheDamperModel) {
  const auto response = response_of(damper_model(10.0, 10.0), with_method("generalized_alpha"), observing({0, 1}));
  EXPECT_EQ(response.status, SteadyStatus::converged);
  // Against the largest observed, which is the blade.
  EXPECT_NEAR(response.amplitude[0], 0.0313777807495, 1e-3 * 0.53295660136);
  EXPECT_NEAR(response.amplitude[1], 0.53295660136, 1e-3 * 0.53295660136);
}

TEST(TimeMarching, FindsTheOptimumOfTheDamperModel) {
  const auto system = damper_model(34.7788, 7.777456595);
  for (const char* method : {"average_acceleration", "exponential"}) {
    SCOPED_TRACE(method);
    const auto response = response_of(system, with_method(method), observing({1, 3}));
    EXPECT_EQ(response.status, SteadyStatus::converged);
    EXPECT_NEAR(response.amplitude[0], 3.45279383277, 1e-3 * 3.45279383277);
    EXPECT_NEAR(response.amplitude[1], 3.45279383277, 1e-3 * 3.45279383277);
  }
}

TEST(TimeMarching, ClosesTheBalanceOfEnergyWithAverageAccelerationToTheRoundOff) {
  auto options = with_method("average_acceleration", 1e-3, 100);
  options.periodicity = 1e-12;
  const auto response = response_of(damper_model(34.7788, 7.7, -8.0), options, observing({1}));
  ASSERT_EQ(response.status, SteadyStatus::converged);
  // The sums close exactly over a step; what is stored differs at the ends of the period by its residual.
  EXPECT_NEAR(response.input_work, response.viscous_work + response.dissipated.sum(), 1e-9 * response.input_work);
  EXPECT_GT(response.dissipated.minCoeff(), 0.0);
}

TEST(TimeMarching, LosesAmplitudeInProportionToTheSquareOfTheStep) {
  // In full stick there are no transitions: the structure is linear and the order is seen undisturbed.
  const auto system = damper_model(1000.0, 7.6);
  double error[3];
  int steps = 64;
  const double exact = response_of(system, with_method("exponential", 1e-3, 4096), observing({1})).amplitude[0];
  for (double& e : error) {
    auto options = with_method("average_acceleration", 1e-3, steps);
    options.periodicity = 1e-11;
    e = response_of(system, options, observing({1})).amplitude[0] - exact;
    steps *= 2;
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.1);
  EXPECT_NEAR(std::log2(error[1] / error[2]), 2.0, 0.1);
}

TEST(TimeMarching, LeavesASliderInFullStickWithItsOffset) {
  // The mass starts displaced, the slider slips on the way to its steady motion and keeps what it was left with.
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = testing::sparse(0.2 * Matrix::Identity(1, 1));
  parts.stiffness = parts.mass;
  parts.loads = system::Loads({harmonic(0, 0.1, 2.0)});
  parts.sliders = {{"contact", 0, ground, 1.0, 0.5}};
  parts.start.q = Vector::Constant(1, 2.0);
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear system(std::move(parts));
  const auto rest = response_of(system, with_method("exponential"), observing({0}), SteadyStart::rest);
  const auto unloaded = response_of(system, with_method("exponential"), observing({0}), SteadyStart::unloaded);
  ASSERT_EQ(rest.status, SteadyStatus::converged);
  ASSERT_EQ(unloaded.status, SteadyStatus::converged);
  EXPECT_EQ(rest.slip_share[0], 0.0);
  EXPECT_GT(std::abs(rest.offset[0]), 0.05);
  EXPECT_NEAR(unloaded.offset[0], 0.0, 1e-9);
  // Both swing alike, about different places: k mean + kT mean + offset = 0.
  EXPECT_NEAR(rest.amplitude[0], unloaded.amplitude[0], 1e-4 * unloaded.amplitude[0]);
  EXPECT_NEAR(rest.mean[0], -0.5 * rest.offset[0], 1e-4 * unloaded.amplitude[0]);

  // A solver that was left at one point keeps its offset at the next only if asked to.
  TimeMarchingSolver solver(system, with_method("exponential"), observing({0}));
  SteadyResponse response;
  auto excitation = excitation_of(system);
  solver.solve(excitation, SteadyStart::rest, response);
  excitation.angular_frequency = 2.05;
  solver.solve(excitation, SteadyStart::previous, response);
  EXPECT_NEAR(response.offset[0], rest.offset[0], 1e-9);
  solver.solve(excitation, SteadyStart::unloaded, response);
  EXPECT_NEAR(response.offset[0], 0.0, 1e-9);
}

TEST(TimeMarching, SaysThatAnUndampedTransientOfHalfTheFrequencyIsSubharmonic) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = testing::sparse(0.0 * Matrix::Identity(1, 1));
  parts.stiffness = parts.mass;  // natural frequency 1, forced at 2
  parts.loads = system::Loads({harmonic(0, 1.0, 2.0)});
  parts.start.q = Vector::Constant(1, 0.5);
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear system(std::move(parts));
  const auto response = response_of(system, with_method("exponential", 1e-3, 64), observing({0}), SteadyStart::rest);
  EXPECT_EQ(response.status, SteadyStatus::subharmonic);
  EXPECT_EQ(response.periods, 2);
}

TEST(TimeMarching, SaysThatAnUndampedTransientWithoutCommonPeriodIsQuasiPeriodic) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = testing::sparse(0.0 * Matrix::Identity(1, 1));
  parts.stiffness = parts.mass;
  parts.loads = system::Loads({harmonic(0, 1.0, 1.0 + std::numbers::sqrt2)});
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear system(std::move(parts));
  const auto response = response_of(system, with_method("exponential", 1e-3, 64), observing({0}), SteadyStart::rest);
  EXPECT_EQ(response.status, SteadyStatus::quasi_periodic);
  // cos(w t) - cos(t) over 1 - w^2: nearly the sum of both within 64 periods of the force.
  const double w = 1.0 + std::numbers::sqrt2;
  EXPECT_NEAR(response.amplitude[0], 2.0 / (w * w - 1.0), 0.02 * response.amplitude[0]);
}

TEST(TimeMarching, SaysThatAnUndampedResonanceGrowsWithoutBound) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = testing::sparse(0.0 * Matrix::Identity(1, 1));
  parts.stiffness = parts.mass;
  parts.loads = system::Loads({harmonic(0, 1.0, 1.0)});
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear system(std::move(parts));
  for (const SteadyStart start : {SteadyStart::rest, SteadyStart::unloaded}) {
    const auto response = response_of(system, with_method("exponential", 1e-3, 64), observing({0}), start);
    EXPECT_EQ(response.status, SteadyStatus::unbounded);
  }
}

}  // namespace
}  // namespace rubato::integrate
