#include <rubato/steady/marching/time_marching.hpp>

#include <rubato/core/error.hpp>
#include <rubato/steady/marching/quasi_periodic.hpp>

#include <support/harmonic_response.hpp>
#include <support/models.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace rubato::steady {
namespace {

using testing::damper_model;
using testing::harmonic;
using testing::observing;
using testing::single_mass;

SteadyResponse response_of(const system::LocallyNonlinear& system, TimeMarchingOptions options, SteadyRequest request,
                           SteadyStart start = SteadyStart::unloaded) {
  TimeMarchingSolver solver(system, std::move(options), std::move(request));
  SteadyResponse response;
  solver.solve(excitation_of(system), start, response);
  return response;
}

TimeMarchingOptions with_method(const std::string& name, double tolerance = 1e-3, int steps = 0) {
  TimeMarchingOptions options;
  options.method = integrate::make_method(name);
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
  parts.coordinates = {"mass"};
  // From rest every second period begins at rest again.
  for (const double start : {0.5, 0.0}) {
    parts.start.q = Vector::Constant(1, start);
    const system::LocallyNonlinear system(parts);
    const auto response = response_of(system, with_method("exponential", 1e-3, 64), observing({0}), SteadyStart::rest);
    EXPECT_EQ(response.status, SteadyStatus::subharmonic);
    EXPECT_EQ(response.periods, 2);
    EXPECT_LE(response.error, 1e-3);
  }
}

// m = k = 1, c = 0.1, a stop of 100 k without gap: the motion with the period of the load, of 0.1010, is unstable, and
// was called converged. The transient under an error of 1e-6 repeats after two periods with 1.56985, which hit the stop
// once.
TEST(TimeMarching, FindsTheMotionThatLastsBetweenStopsAndNoUnstableOne) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = testing::sparse(0.1 * Matrix::Identity(1, 1));
  parts.stops = {{"wall", 0, ground, 0.0, 100.0, 0.0}};
  parts.loads = system::Loads({harmonic(0, 1.0, 3.6)});
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear system(std::move(parts));
  const auto response =
      response_of(system, with_method("average_acceleration", 1e-3), observing({0}), SteadyStart::unloaded);
  EXPECT_EQ(response.status, SteadyStatus::subharmonic);
  EXPECT_EQ(response.periods, 2);
  EXPECT_NEAR(response.amplitude[0], 1.56985, 2e-3 * 1.56985);
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

// A contact of 1e5 k sticks for most of the period and rings at 316 rad/s where it comes to stick: the march may
// wander, but c = 0.1 bounds it. The periodic orbit has the amplitude 0.91939.
TEST(TimeMarching, DoesNotCallAStiffContactInfinite) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = testing::sparse(0.1 * Matrix::Identity(1, 1));
  parts.stiffness = parts.mass;
  parts.sliders = {{"contact", 0, ground, 1e5, 0.1}};
  parts.loads = system::Loads({harmonic(0, 1.0, 0.1)});
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear system(std::move(parts));
  const auto response = response_of(system, with_method("generalized_alpha"), observing({0}));
  EXPECT_NE(response.status, SteadyStatus::unbounded);
  EXPECT_TRUE(std::isfinite(response.amplitude[0]));
  if (response.status == SteadyStatus::converged) {
    EXPECT_NEAR(response.amplitude[0], 0.91939, 1e-3);
  }
}

TEST(TimeMarching, FollowsPointsSideBySideAsOneByOne) {
  const auto system = damper_model(10.0, 7.5, -8.0);
  const std::array<double, 9> preloads = {0, 5, 10, 25, 50, 100, 200, 500, 1000};
  for (const char* method : {"exponential", "average_acceleration"}) {
    SCOPED_TRACE(method);
    auto options = with_method(method, 1e-3, 96);
    options.periodicity = 1e-10;  // so that what is left of the transients differs by less than what is asserted
    TimeMarchingSolver together(system, options, observing({1, 3}));
    std::vector<system::Excitation> points(preloads.size(), excitation_of(system));
    std::vector<SteadyResponse> responses(preloads.size());
    ASSERT_GE(together.lanes(), 9);
    for (std::size_t i = 0; i < points.size(); ++i) points[i].limits.setConstant(0.5 * preloads[i]);
    for (const double omega : {7.5, 7.55, 7.6}) {
      for (system::Excitation& point : points) point.angular_frequency = omega;
      together.solve_lanes(points, SteadyStart::previous, responses);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      SCOPED_TRACE(preloads[i]);
      TimeMarchingSolver alone(system, options, observing({1, 3}));
      SteadyResponse response;
      alone.solve(points[i], SteadyStart::unloaded, response);
      EXPECT_EQ(responses[i].status, SteadyStatus::converged);
      EXPECT_EQ(responses[i].transitions, response.transitions);
      for (Index k = 0; k < 2; ++k) {
        EXPECT_NEAR(responses[i].amplitude[k], response.amplitude[k], 1e-7 * response.amplitude[k]);
        EXPECT_NEAR(std::abs(responses[i].harmonics(k, 0) - response.harmonics(k, 0)), 0.0, 1e-7);
        EXPECT_NEAR(responses[i].acceleration_amplitude[k], response.acceleration_amplitude[k], 1e-5 * 64.0);
      }
    }
  }
}

TEST(TimeMarching, SaysHowFarItsAmplitudesAreFromTheExactOnes) {
  // Over a coarse grid of preloads and frequencies, against 2048 steps a period: errors some 300 times smaller.
  const auto system = damper_model(10.0, 7.5, -8.0);
  TimeMarchingSolver reference(system, with_method("exponential", 1e-3, 2048), observing({1, 3}));
  for (const double preload : {5.0, 50.0, 200.0}) {
    std::vector<system::Excitation> points;
    std::vector<Vector> exact;
    SteadyResponse response;
    for (double omega = 6.0; omega < 9.01; omega += 0.25) {
      points.push_back(excitation_of(system));
      points.back().angular_frequency = omega;
      points.back().limits.setConstant(0.5 * preload);
      reference.solve(points.back(), SteadyStart::previous, response);
      exact.push_back(response.amplitude);
    }
    for (const char* method : {"exponential", "generalized_alpha", "rk4"}) {
      SCOPED_TRACE(method);
      TimeMarchingSolver solver(system, with_method(method), observing({1, 3}));
      int worse_than_said = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        solver.solve(points[i], SteadyStart::previous, response);
        const double error = (response.amplitude - exact[i]).cwiseAbs().maxCoeff() / exact[i].maxCoeff();
        EXPECT_EQ(response.status, SteadyStatus::converged);
        EXPECT_LE(response.error, 1e-3);
        EXPECT_LE(error, 1e-3);
        worse_than_said += error > response.error ? 1 : 0;
      }
      // It is an estimate, cautious but no bound.
      EXPECT_LE(worse_than_said, 1);
    }
  }
}

TEST(TimeMarching, AgreesAcrossFamiliesOnRandomModels) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> real(0.0, 1.0);
  for (int sample = 0; sample < 40; ++sample) {
    SCOPED_TRACE(sample);
    const Index n = 2 + sample % 5, m = 1 + sample % 4;
    system::LocallyNonlinear::Parts parts;
    Matrix a = Matrix::NullaryExpr(n, n, [&] { return real(random) - 0.5; });
    const Matrix k = 4.0 * Matrix::Identity(n, n) + a * a.transpose() * 8.0;
    Matrix b = Matrix::NullaryExpr(n, n, [&] { return real(random) - 0.5; });
    parts.mass = testing::sparse(Matrix::Identity(n, n) * (0.5 + real(random)));
    parts.damping = testing::sparse(0.02 * k + 0.1 * b * b.transpose());  // couples the modes
    parts.stiffness = testing::sparse(k);
    for (Index i = 0; i < m; ++i)
      parts.sliders.push_back({"s" + std::to_string(i), i % n, i % 2 == 0 ? ground : (i + 1) % n,
                               1.0 + 5.0 * real(random), 0.05 + real(random)});
    const double omega = 1.0 + 3.0 * real(random);
    parts.loads =
        system::Loads({harmonic(0, 1.0, omega, 6.0 * real(random)), harmonic(n - 1, real(random), 2.0 * omega),
                       harmonic(n / 2, real(random), 0.0), harmonic(n / 2, 0.3, 3.0 * omega, 1.0)});
    for (Index i = 0; i < n; ++i) parts.coordinates.push_back("x" + std::to_string(i));
    const system::LocallyNonlinear system(std::move(parts));
    const auto request = observing({0, n - 1});
    const auto alpha = response_of(system, with_method("generalized_alpha"), request);
    const auto exponential = response_of(system, with_method("exponential"), request);
    ASSERT_EQ(alpha.status, SteadyStatus::converged);
    ASSERT_EQ(exponential.status, SteadyStatus::converged);
    const double size = exponential.amplitude.maxCoeff();
    EXPECT_NEAR(alpha.amplitude[0], exponential.amplitude[0], (alpha.error + exponential.error) * size);
    EXPECT_NEAR(alpha.amplitude[1], exponential.amplitude[1], (alpha.error + exponential.error) * size);
    EXPECT_NEAR(alpha.input_work, alpha.viscous_work + alpha.dissipated.sum(), 0.01 * alpha.input_work);
  }
}

TEST(TimeMarching, FindsAChainOfManySlidersByTheSteppersToo) {
  // Sixty coordinates: beyond the lanes, and beyond Broyden's matrix.
  const auto system = testing::chain(60, 12, 0.5);
  auto options = with_method("average_acceleration", 1e-3);
  options.periodicity = 1e-7;
  const auto mixed = response_of(system, options, observing({20, 30}));
  ASSERT_EQ(mixed.status, SteadyStatus::converged);
  options.extrapolates = false;
  const auto marched = response_of(system, options, observing({20, 30}));
  EXPECT_EQ(marched.status, SteadyStatus::converged);
  EXPECT_NEAR(mixed.amplitude[0], marched.amplitude[0], (mixed.error + marched.error) * marched.amplitude.maxCoeff());
  EXPECT_LT(mixed.iterations, marched.iterations);
}

TEST(TimeMarching, RepeatsOneWaveformInItsNumbers) {
  const auto system = damper_model(34.7788, 7.7, -8.0);
  for (const bool uses_lanes : {true, false}) {
    auto options = with_method("average_acceleration", 1e-3, 400);
    options.uses_lanes = uses_lanes;
    TimeMarchingSolver solver(system, options, observing({1}));
    SteadyResponse response;
    solver.solve(excitation_of(system), SteadyStart::unloaded, response);
    const Waveform waveform = solver.waveform(1000);
    const auto blade = waveform.position.row(1);
    // Half peak to peak of 1000 samples misses the peak by (pi/1000)^2/2 at most.
    EXPECT_NEAR(0.5 * (blade.maxCoeff() - blade.minCoeff()), response.amplitude[0], 2e-5 * response.amplitude[0]);
    // Friction work is the area of the loop that the samples draw.
    const double limit = 0.5 * 34.7788;
    double area = 0.0;
    for (Index i = 0; i < 1000; ++i) {
      const Index next = (i + 1) % 1000;
      area += 0.5 * (waveform.slider_force(0, i) + waveform.slider_force(0, next)) *
              (waveform.displacement(0, next) - waveform.displacement(0, i));
    }
    EXPECT_NEAR(area, response.dissipated[0], 1e-3 * response.dissipated[0]);
    EXPECT_LE(waveform.slider_force.cwiseAbs().maxCoeff(), limit);
  }
}

TEST(TimeMarching, KeepsExplicitMethodsToTheirStableStep) {
  // The highest mode with the sliders stuck, 8.344 rad/s, allows 2/8.344 s to the central difference.
  const auto system = damper_model(10.0, 1.0);
  TimeMarchingSolver solver(system, with_method("central_difference"), observing({1}));
  const int least = solver.least_steps(1.0);
  EXPECT_GE(least, 2.0 * std::numbers::pi / (2.0 / 8.344109053436982));
  EXPECT_LE(least, 1.2 * 2.0 * std::numbers::pi / (2.0 / 8.344109053436982));
  SteadyResponse response;
  solver.solve(excitation_of(system), SteadyStart::unloaded, response);
  EXPECT_EQ(response.status, SteadyStatus::converged);
  TimeMarchingSolver coarse(system, with_method("central_difference", 1e-3, least - 1), observing({1}));
  EXPECT_THROW(coarse.solve(excitation_of(system), SteadyStart::unloaded, response), InvalidInput);
}

TEST(TimeMarching, RefusesMethodsThatCannotMarch) {
  const auto undamped = single_mass(0.15, 2.0, 0.0);
  EXPECT_THROW(TimeMarchingSolver(undamped, with_method("explicit_euler"), observing({0})), InvalidInput);
  EXPECT_THROW(TimeMarchingSolver(undamped, with_method("exact"), observing({0})), InvalidInput);
  EXPECT_THROW(TimeMarchingSolver(undamped, with_method("exponential", std::nan("")), observing({0})), InvalidInput);
}

// Two masses that know of each other through a slider that always sticks or is not there: forces without a common
// period, and the amplitude is the sum of both.
TEST(QuasiPeriodic, AddsTheAmplitudesOfIncommensurateForcesOnALinearMass) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = testing::sparse(0.2 * Matrix::Identity(1, 1));
  parts.stiffness = parts.mass;
  const double first = 1.5, second = 1.5 * std::numbers::phi;
  parts.loads = system::Loads({harmonic(0, 1.0, first), harmonic(0, 0.7, second)});
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear system(std::move(parts));
  const auto linear = [](double force, double w) { return force / std::hypot(1.0 - w * w, 0.2 * w); };
  const auto response = solve_quasi_periodic(system, with_method("exponential"), observing({0}), 200.0);
  EXPECT_EQ(response.status, SteadyStatus::quasi_periodic);
  // Within a window of 200 s the peaks of both meet to within some hundredths of a radian.
  const double sum = linear(1.0, first) + linear(0.7, second);
  EXPECT_LT(response.amplitude[0], sum * 1.001);
  EXPECT_GT(response.amplitude[0], sum * 0.99);
  EXPECT_NEAR(response.input_work, response.viscous_work, 0.01 * response.input_work);
}

TEST(QuasiPeriodic, SettlesWithASliderUnderTwoIncommensurateForces) {
  const double first = 7.7, second = 7.7 * std::numbers::sqrt2;
  const auto base = damper_model(10.0, first, 0.0);
  system::LocallyNonlinear::Parts parts;
  parts.mass = base.mass();
  parts.damping = base.damping();
  parts.stiffness = base.stiffness();
  parts.sliders = base.sliders();
  parts.coordinates = base.coordinates();
  parts.loads = system::Loads({harmonic(1, 20.0, first), harmonic(3, 20.0, second)});
  const system::LocallyNonlinear system(std::move(parts));
  EXPECT_THROW(excitation_of(system), InvalidInput);
  auto options = with_method("average_acceleration", 5e-3);
  const auto response = solve_quasi_periodic(system, options, observing({1, 3}), 60.0);
  EXPECT_EQ(response.status, SteadyStatus::quasi_periodic);
  EXPECT_LE(response.error, 5e-3);
  EXPECT_GT(response.dissipated.minCoeff(), 0.0);
  EXPECT_THROW(solve_quasi_periodic(system, options, observing({1}), std::nan("")), InvalidInput);
}

}  // namespace
}  // namespace rubato::steady
