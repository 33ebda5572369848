#include <rubato/integrate/steady/harmonic_balance.hpp>

#include "support/models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rubato::integrate {
namespace {

using testing::damper_model;
using testing::single_mass;

SteadyRequest observing(std::initializer_list<Index> coordinates) {
  SteadyRequest request;
  for (const Index i : coordinates) request.observed.push_back({i, ground});
  return request;
}

SteadyResponse respond(const system::LocallyNonlinear& system, const SteadyRequest& request, double tolerance = 1e-6,
                       int most_harmonics = 201) {
  HarmonicBalanceSolver solver(system, request, {.tolerance = tolerance, .most_harmonics = most_harmonics});
  SteadyResponse response;
  solver.solve(excitation_of(system), SteadyStart::unloaded, response);
  EXPECT_EQ(response.status, SteadyStatus::converged);
  return response;
}

// Reference page, section 3, 40 digits. The series is truncated at an estimated 1e-6 of the amplitude.
TEST(HarmonicBalance, MeetsTheSteadyStateOfTheSingleMassWithASlider) {
  const auto system = single_mass(0.15);
  const SteadyResponse r = respond(system, observing({0}));
  EXPECT_NEAR(r.amplitude[0], 0.2942542080903754, 1e-6 * 0.294);
  EXPECT_NEAR(r.dissipated[0], 0.0865525248542252, 1e-6);
  EXPECT_NEAR(r.viscous_work, 0.543603660209531, 3e-6);
  EXPECT_NEAR(r.input_work, 0.630156185063756, 3e-6);
  EXPECT_NEAR(r.input_work, r.viscous_work + r.dissipated[0], 1e-10);
  EXPECT_EQ(r.transitions, 4);
}

TEST(HarmonicBalance, MeetsThePeaksOfTheSingleMass) {
  struct Peak {
    double normal_load, amplitude, frequency;
  };
  for (const Peak& p : {Peak{0.0, 1.15470053838, 0.707106781},
                        {0.1, 1.08867757048, 0.687575081},
                        {0.3, 0.953146352429, 0.657293279},
                        {0.8, 0.694210394916, 0.968311264},
                        {1.2, 0.696387871444, 1.16513079},
                        {2.0, 0.755928946018, 1.22474487}}) {
    const auto system = single_mass(0.5 * p.normal_load, p.frequency);
    const SteadyResponse r = respond(system, observing({0}));
    EXPECT_NEAR(r.amplitude[0], p.amplitude, 2e-6 * p.amplitude) << p.normal_load << " error " << r.error;
    EXPECT_LE(std::abs(r.amplitude[0] / p.amplitude - 1.0), r.error + 1e-9);
  }
}

TEST(HarmonicBalance, MeetsTheSteadyAmplitudesOfTheDamperModel) {
  const auto at_ten = respond(damper_model(10.0, 10.0), observing({0, 1, 4}));
  EXPECT_NEAR(at_ten.amplitude[0], 0.0313777807495, 1e-6);
  EXPECT_NEAR(at_ten.amplitude[1], 0.53295660136, 1e-6);
  EXPECT_NEAR(at_ten.amplitude[2], 0.0, 1e-12);
  const auto optimum = respond(damper_model(34.7788, 7.777456595), observing({1}));
  EXPECT_NEAR(optimum.amplitude[0], 3.45279383277, 4e-6);
}

}  // namespace
}  // namespace rubato::integrate
