#include <rubato/steady/marching/time_marching.hpp>

#include <support/harmonic_response.hpp>
#include <support/laws.hpp>
#include <support/models.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rubato::steady {
namespace {

using testing::bouc_wen_mass;
using testing::duffing;
using testing::JenkinsLaw;
using testing::observing;

SteadyResponse march(const system::LocallyNonlinear& system, double tolerance, int steps = 0,
                     const std::string& method = "generalized_alpha", SteadyStart start = SteadyStart::unloaded) {
  TimeMarchingOptions options;
  options.method = integrate::make_method(method);
  options.tolerance = tolerance;
  options.steps_per_period = steps;
  TimeMarchingSolver solver(system, std::move(options), observing({0}));
  SteadyResponse response;
  solver.solve(excitation_of(system), start, response);
  EXPECT_EQ(response.status, SteadyStatus::converged);
  return response;
}

// friction-family reference, section 9: of masses on a Bouc-Wen element, n = 1 and 2.
TEST(LawsByMarching, MeetTheSteadyMotionOfABoucWenElement) {
  for (const auto& point : testing::bouc_wen_points) {
    const SteadyResponse r = march(bouc_wen_mass(point.n, point.angular_frequency), 1e-4);
    EXPECT_LT(r.error, 1e-4);
    EXPECT_NEAR(r.amplitude[0], point.amplitude, 1e-4 * point.amplitude) << point.n << " " << point.angular_frequency;
    // Works follow the square of the amplitude and more: the loop begins to yield.
    EXPECT_NEAR(r.law_dissipated[0], point.work, 1e-3 * point.work) << point.n << " " << point.angular_frequency;
    EXPECT_NEAR(r.input_work, r.viscous_work + r.law_dissipated[0], 1e-3 * r.input_work);
  }
}

TEST(LawsByMarching, MeetBothMotionsOfADuffingOscillatorThatLast) {
  // Section 6: at w = 1.2 one motion is large and one small; the one between them does not last.
  const auto system = duffing(1.2);
  const SteadyResponse from_rest = march(system, 1e-5, 0, "rk4", SteadyStart::rest);
  const double low = 0.417672948936, high = 2.54557670058;
  const double expected = from_rest.amplitude[0] < 1.0 ? low : high;
  EXPECT_NEAR(from_rest.amplitude[0], expected, 1e-5 * expected);
  // Along a sweep of rising frequencies the large one is kept.
  TimeMarchingOptions options;
  options.tolerance = 1e-5;
  TimeMarchingSolver solver(system, options, observing({0}));
  SteadyResponse r;
  system::Excitation excitation = excitation_of(system);
  for (double w = 0.8; w < 1.21; w += 0.04) {
    excitation.angular_frequency = w > 1.19 ? 1.2 : w;
    solver.solve(excitation, SteadyStart::previous, r);
    ASSERT_EQ(r.status, SteadyStatus::converged) << w;
  }
  EXPECT_NEAR(r.amplitude[0], high, 1e-5 * high);
  EXPECT_NEAR(std::abs(r.harmonics(0, 0)), 2.50919758111, 2e-5 * high);
}

TEST(LawsByMarching, GiveASliderWrittenAsALawTheMotionOfTheSlider) {
  const auto slider = testing::single_mass(0.15);
  const auto law = testing::single_mass_on(std::make_shared<JenkinsLaw>(1.0, 0.15));
  for (const char* method : {"average_acceleration", "exponential"}) {
    const SteadyResponse a = march(slider, 1e-3, 256, method), b = march(law, 1e-3, 256, method);
    // Both marches end within the periodicity of 1e-5 of the same map.
    EXPECT_NEAR(b.amplitude[0], a.amplitude[0], 1e-5 * a.amplitude[0]) << method;
    EXPECT_NEAR(b.law_dissipated[0], a.dissipated[0], 1e-4 * a.dissipated[0]) << method;
  }
}

TEST(LawsByMarching, WaitForTheMemoryToRepeat) {
  // A law that creeps a thirtieth of the way to the mean displacement in a period, under a mass that hardly feels it:
  // what the mass does repeats long before the law does, which has 1e-4 of the state to go at exp(-0.031 n) =
  // 1e-4/0.016.
  const auto system = testing::mass_on(std::make_shared<testing::CreepLaw>(1e-3, 0.01), 1.0, 1.0, 1.0, 2.0, 0.5);
  const SteadyResponse r = march(system, 1e-2);
  EXPECT_GT(r.iterations, 100);
}

TEST(LawsByMarching, FindTheMeanOfASpringThatIsNotOdd) {
  // x'' + x' + x + 0.3 x^2 = cos 2t, against a march of 2,000 steps of order four.
  const auto system = testing::single_mass_on(testing::spring("0.3*u^2"));
  const SteadyResponse r = march(system, 1e-4);
  const SteadyResponse fine = march(system, 1e-6, 2000, "rk4");
  EXPECT_LT(fine.mean[0], -0.01);
  EXPECT_NEAR(r.mean[0], fine.mean[0], 1e-4 * fine.amplitude[0]);
  EXPECT_NEAR(r.amplitude[0], fine.amplitude[0], 1e-4 * fine.amplitude[0]);
}

}  // namespace
}  // namespace rubato::steady
