#include <rubato/integrate/catalogue.hpp>
#include <rubato/model/laws/jenkins.hpp>
#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/marching/time_marching.hpp>

#include <support/harmonic_response.hpp>
#include <support/models.hpp>
#include <support/random_model.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

// Sliders and stops as laws of the general route in steady responses, and a slider pressed by a stop.
namespace rubato::steady {
namespace {

using testing::observing;

system::LocallyNonlinear with_laws(const system::LocallyNonlinear& closed) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = closed.mass();
  parts.damping = closed.damping();
  parts.stiffness = closed.stiffness();
  parts.loads = closed.loads();
  parts.coordinates = closed.coordinates();
  for (const auto& slider : closed.sliders()) {
    parts.laws.push_back(
        {slider.name, "slider", slider.first, slider.second, model::make_jenkins(slider.stiffness, 0.25)});
    parts.laws.back().normal.value = 4.0 * slider.limit;
  }
  for (const auto& stop : closed.stops())
    parts.laws.push_back(
        {stop.name, "stop", stop.first, stop.second, model::make_one_sided_spring(stop.stiffness, stop.gap)});
  return system::LocallyNonlinear(std::move(parts));
}

SteadyResponse marched(const system::LocallyNonlinear& system, std::initializer_list<Index> observed, int steps) {
  TimeMarchingOptions options;
  options.steps_per_period = steps;
  options.tolerance = 1e-7;
  TimeMarchingSolver solver(system, options, observing(observed));
  SteadyResponse response;
  solver.solve(excitation_of(system), SteadyStart::unloaded, response);
  EXPECT_EQ(response.status, SteadyStatus::converged);
  return response;
}

TEST(ContactsAsLaws, SwingByHarmonicsAsTheirClosedFormsDo) {
  for (const double limit : {0.05, 0.15, 0.4}) {
    SCOPED_TRACE(limit);
    const auto closed = testing::single_mass(limit);
    const SteadyResponse expected = testing::respond(closed, observing({0}), 1e-6);
    const SteadyResponse found = testing::respond(with_laws(closed), observing({0}), 1e-6);
    EXPECT_NEAR(found.amplitude[0], expected.amplitude[0], 2e-6 * expected.amplitude[0]);
    EXPECT_NEAR(found.law_dissipated[0], expected.dissipated[0], 1e-5 * expected.input_work);
  }
  const auto damper = testing::damper_model(10.0, 4.0, 7.0);
  const SteadyResponse expected = testing::respond(damper, observing({1, 4}), 1e-5);
  const SteadyResponse found = testing::respond(with_laws(damper), observing({1, 4}), 1e-5);
  for (Index i = 0; i < 2; ++i)
    EXPECT_NEAR(found.amplitude[i], expected.amplitude[i],
                2.0 * (found.error + expected.error) * expected.amplitude[i]);
}

// Both march by the same steps to the same orbit.
TEST(ContactsAsLaws, SwingByMarchesAsTheirClosedFormsDo) {
  const auto damper = testing::damper_model(10.0, 4.0, 7.0);
  const SteadyResponse expected = marched(damper, {1, 4}, 200), found = marched(with_laws(damper), {1, 4}, 200);
  for (Index i = 0; i < 2; ++i) EXPECT_NEAR(found.amplitude[i], expected.amplitude[i], 1e-5 * expected.amplitude[i]);
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = testing::sparse(0.2 * Matrix::Identity(1, 1));
  parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.loads = system::Loads({testing::harmonic(0, 1.0, 0.8)});
  parts.stops = {{"stop", 0, ground, 0.5, 9.0, 0.0}};
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear stopped(std::move(parts));
  const SteadyResponse a = marched(stopped, {0}, 400), b = marched(with_laws(stopped), {0}, 400);
  EXPECT_NEAR(b.amplitude[0], a.amplitude[0], 1e-5 * a.amplitude[0]);
}

// x'' + .04 x' + x + T = .8 cos(w t), z'' + .06 z' + z + N = 1.5 + .9 cos(w t + pi/3), kT = 1, kn = 2, mu = .4: half
// peak-to-peak of x and z and the work of a period, by the exact piecewise linear flow.
TEST(NormalForces, OfAStopAreMetByMarchesToTheSteadyState) {
  struct Case {
    double w, x, z, work;
  };
  for (const Case& one :
       {Case{0.9, 1.93114428152, 0.410834030775, 2.42354608658},
        Case{1.2, 2.26347587318, 0.603182672721, 2.60815313529}, Case{1.5, 1.04932049949, 2.88344718882, 1.27679787474},
        Case{2.1, 0.316776266927, 0.598317467254, 0.114154003692}}) {
    SCOPED_TRACE(one.w);
    system::LocallyNonlinear::Parts parts;
    Matrix damping = Matrix::Zero(2, 2);
    damping.diagonal() << 0.04, 0.06;
    parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(2, 2));
    parts.damping = testing::sparse(damping);
    parts.loads = system::Loads({testing::harmonic(0, 0.8, one.w), testing::harmonic(1, 1.5, 0.0),
                                 testing::harmonic(1, 0.9, one.w, std::numbers::pi / 3.0)});
    parts.coordinates = {"x", "z"};
    parts.stops = {{"presses", 1, ground, 0.0, 2.0, 0.0}};
    parts.laws = {{"rubs", "slider", 0, ground, model::make_jenkins(1.0, 0.4)}};
    parts.laws.front().normal.stop = 0;
    const system::LocallyNonlinear system(std::move(parts));
    const SteadyResponse r = marched(system, {0, 1}, 2000);
    EXPECT_NEAR(r.amplitude[0], one.x, 1e-4 * one.x);
    EXPECT_NEAR(r.amplitude[1], one.z, 1e-4 * one.z);
    EXPECT_NEAR(r.law_dissipated[0], one.work, 3e-4 * one.work);
  }
}

}  // namespace
}  // namespace rubato::steady
