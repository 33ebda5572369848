#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/marching/time_marching.hpp>
#include <rubato/steady/periodic/periodic_solver.hpp>

#include <support/models.hpp>
#include <support/random_model.hpp>

#include <gtest/gtest.h>

#include <memory>

namespace rubato::steady {
namespace {

TimeMarchingOptions marching_of(std::uint64_t seed) {
  TimeMarchingOptions options;
  if (seed % 2 == 1) options.method = integrate::make_method("exponential");
  return options;
}

// Three routes that share no formula: the exact flow and Newton's method on its period; Fourier series; steps in time.
// The motion of a damped structure with sliders is unique (two motions never part: the energy of their difference
// decays), so that their amplitudes must agree, each within the error that it states for itself.
//
// Coverage, against `periodic`: the true error is at most 0.76 of what harmonic balance says on this thousand, and at
// most 0.60 of what time marching says; on 1,260 other seeds, which nobody looked at while the estimates were made,
// 0.71 and 0.73. All of them converged.
void expect_agreement(std::uint64_t seed) {
  SCOPED_TRACE(seed);
  const auto system = testing::random_model(seed);
  const SteadyRequest request = testing::random_request(seed, system.size());
  const system::Excitation excitation = excitation_of(system);
  const char* const names[] = {"periodic", "harmonic_balance", "time_marching"};
  std::unique_ptr<SteadySolver> solvers[] = {std::make_unique<PeriodicSolver>(system, request),
                                             std::make_unique<HarmonicBalanceSolver>(system, request),
                                             std::make_unique<TimeMarchingSolver>(system, marching_of(seed), request)};
  const double tolerances[] = {1e-8, 1e-3, 1e-3};
  SteadyResponse responses[3];
  for (int route = 0; route < 3; ++route) {
    solvers[route]->solve(excitation, SteadyStart::unloaded, responses[route]);
    EXPECT_EQ(responses[route].status, SteadyStatus::converged) << names[route];
    EXPECT_LE(responses[route].error, tolerances[route]) << names[route];
  }
  const double largest = responses[0].amplitude.maxCoeff();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < a; ++b)
      EXPECT_LE((responses[a].amplitude - responses[b].amplitude).cwiseAbs().maxCoeff(),
                (responses[a].error + responses[b].error) * largest)
          << names[a] << " and " << names[b];
}

/// Two masses, the second on a dashpot, and between them a spring and a slider, under loads of w and 2 w.
system::LocallyNonlinear two_masses(double w) {
  system::LocallyNonlinear::Parts parts;
  Matrix mass = Matrix::Zero(2, 2), damping = Matrix::Zero(2, 2), stiffness(2, 2);
  mass.diagonal() << 0.79, 0.5;
  stiffness << 69.3, -26.4, -26.4, 26.4;
  damping(1, 1) = 5.73;
  damping += 2.89 * mass + 0.0295 * stiffness;
  parts.mass = testing::sparse(mass);
  parts.damping = testing::sparse(damping);
  parts.stiffness = testing::sparse(stiffness);
  parts.sliders = {{"contact", 0, 1, 12.1, 0.00758}};
  parts.loads = system::Loads({testing::harmonic(0, 0.0169, w), testing::harmonic(1, 0.0627, 2.0 * w, 0.873)});
  parts.coordinates = {"first", "second"};
  return system::LocallyNonlinear(std::move(parts));
}

// At 4.18 rad/s the slider slips, at 10.7 rad/s it never does and bears the offset 0, which is that of a start without
// force: the mean is 0 then. periodic moved the offset with the matrix of a pass in which the slider had slipped, gave
// up and said that it had converged with a mean of 0.15 of the amplitude; time_marching took what crept at its limit
// for one that slips.
TEST(RoutesAgree, OnTheMeanOfASliderThatSlippedAtThePointBefore) {
  const auto slips = two_masses(4.18366), sticks = two_masses(10.6871);
  const SteadyRequest request{{{0, ground}, {1, ground}}, {1}, true};
  std::unique_ptr<SteadySolver> solvers[] = {
      std::make_unique<PeriodicSolver>(slips, request), std::make_unique<HarmonicBalanceSolver>(slips, request),
      std::make_unique<TimeMarchingSolver>(slips, TimeMarchingOptions{}, request)};
  for (auto& solver : solvers) {
    SteadyResponse response;
    solver->solve(excitation_of(slips), SteadyStart::unloaded, response);
    EXPECT_GT(response.slip_share[0], 0.02);
    solver->solve(excitation_of(sticks), SteadyStart::unloaded, response);
    ASSERT_EQ(response.status, SteadyStatus::converged);
    EXPECT_LE(response.mean.cwiseAbs().maxCoeff(), 1e-3 * response.amplitude.maxCoeff());
  }
}

TEST(RoutesAgree, OnASampleOfRandomStructures) {
  for (std::uint64_t seed = 1000; seed < 1030; ++seed) expect_agreement(seed);
}

// In parts, which run side by side.
class RoutesAgreeOnAThousand : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RoutesAgreeOnAThousand, RandomStructures) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) expect_agreement(100 * GetParam() + seed);
}

INSTANTIATE_TEST_SUITE_P(Hundred, RoutesAgreeOnAThousand, ::testing::Range<std::uint64_t>(0, 10));

}  // namespace
}  // namespace rubato::steady
