#include <rubato/core/error.hpp>
#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/linear/linear_response.hpp>
#include <rubato/steady/marching/time_marching.hpp>

#include "support/contact_problems.hpp"
#include "support/harmonic_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

// Steady responses with contacts that stick, slip, open and close, with sliders that a stop presses, and with stops, by
// samples and by marches, against orbits that a reference of the friction family has to eleven digits (problems C, W
// and S: exact piecewise linear flows; two directions by an integrator of eighth order with events).
namespace rubato::steady {
namespace {

using testing::observing;

/// Half peak to peak of each coordinate, and the work of each contact over a period.
struct Orbit {
  double w;
  std::vector<double> amplitude, work;
};

const std::vector<Orbit> coupled_orbits{{0.9, {1.93114428152, 0.410834030775}, {2.42354608658}},
                                        {1.2, {2.26347587318, 0.603182672721}, {2.60815313529}},
                                        {1.5, {1.04932049949, 2.88344718882}, {1.27679787474}},
                                        {2.1, {0.316776266927, 0.598317467254}, {0.114154003692}}};
const std::vector<Orbit> wedge_orbits{
    {8.3, {0.28122877694, 0.46382799773, 0.39622249159, 0.076193507817}, {0.69441278128, 0.50567634777}},
    {8.8, {0.05450094966, 0.30130107102, 0.20740340101, 0.079601839583}, {0.6773071866, 0.38724995594}}};
const std::vector<Orbit> space_orbits{{0.9, {2.231606667, 0.608954496, 0.2738893539}, {3.485626482}},
                                      {1.2, {1.624344006, 2.040535643, 0.3842063884}, {4.136846906}},
                                      {1.6, {0.7690779349, 0.5330234895, 1.620972012}, {0.8962136567}},
                                      {2.0, {0.3665304549, 0.274221635, 0.566395461}, {0.1769050225}}};

void expect_orbit(const SteadyResponse& found, const Orbit& orbit, double tolerance) {
  EXPECT_EQ(found.status, SteadyStatus::converged);
  EXPECT_LE(found.error, tolerance);
  double largest = 0.0, work = 0.0;
  for (const double a : orbit.amplitude) largest = std::max(largest, a);
  for (const double w : orbit.work) work = std::max(work, w);
  for (std::size_t i = 0; i < orbit.amplitude.size(); ++i)
    EXPECT_NEAR(found.amplitude[static_cast<Index>(i)], orbit.amplitude[i], tolerance * largest) << i;
  ASSERT_EQ(found.law_dissipated.size() >= static_cast<Index>(orbit.work.size()), true);
  for (std::size_t i = 0; i < orbit.work.size(); ++i)
    EXPECT_NEAR(found.law_dissipated[static_cast<Index>(i)], orbit.work[i], 10.0 * tolerance * work) << i;
}

SteadyResponse march(const system::LocallyNonlinear& system, const SteadyRequest& request, double tolerance) {
  TimeMarchingOptions options;
  options.tolerance = tolerance;
  SteadyResponse response;
  TimeMarchingSolver(system, options, request).solve(excitation_of(system), SteadyStart::unloaded, response);
  return response;
}

TEST(ContactsBySamples, KeepTheirStatedErrorOnOrbitsThatSlipAndOpen) {
  constexpr double tolerance = 1e-4;
  for (const Orbit& orbit : coupled_orbits) {
    SCOPED_TRACE(orbit.w);
    expect_orbit(testing::respond(testing::coupled(orbit.w, true), observing({0, 1}), tolerance), orbit, tolerance);
  }
  for (const Orbit& orbit : space_orbits) {
    SCOPED_TRACE(orbit.w);
    expect_orbit(testing::respond(testing::in_space(0.3, orbit.w), observing({0, 1, 2}), tolerance), orbit, tolerance);
  }
}

// A wedge that contacts alone hold: in the limit where they all stick the structure has a balance, and from there they
// are released.
TEST(ContactsBySamples, HoldAWedgeBetweenBlades) {
  constexpr double tolerance = 1e-3;
  for (const Orbit& orbit : wedge_orbits) {
    SCOPED_TRACE(orbit.w);
    expect_orbit(testing::respond(testing::wedge(0.35, 3.0, orbit.w), observing({0, 1, 2, 3}), tolerance), orbit,
                 tolerance);
  }
}

// What presses on a slider follows from the motion of another coordinate.
TEST(PressedSlidersBySamples, AreTheContactThatTheyMake) {
  constexpr double tolerance = 1e-4;
  for (const Orbit& orbit : coupled_orbits) {
    SCOPED_TRACE(orbit.w);
    expect_orbit(testing::respond(testing::coupled(orbit.w, false), observing({0, 1}), tolerance), orbit, tolerance);
  }
}

TEST(ContactsByMarches, KeepTheirStatedErrorOnOrbitsThatSlipAndOpen) {
  constexpr double tolerance = 1e-3;
  for (const std::size_t i : {0u, 2u}) {
    SCOPED_TRACE(coupled_orbits[i].w);
    expect_orbit(march(testing::coupled(coupled_orbits[i].w, true), observing({0, 1}), tolerance), coupled_orbits[i],
                 tolerance);
    SCOPED_TRACE(space_orbits[i].w);
    expect_orbit(march(testing::in_space(0.3, space_orbits[i].w), observing({0, 1, 2}), tolerance), space_orbits[i],
                 tolerance);
  }
}

// Two-sided stops: no closed form, but both routes.
TEST(StopsBySamples, SwingAsMarchesDo) {
  auto parts = testing::masses(Vector::Ones(1), Vector::Constant(1, 0.2), Vector::Ones(1));
  parts.loads = system::Loads({testing::harmonic(0, 1.0, 1.3)});
  parts.stops = {{"right", 0, ground, 0.6, 2.0, 0.0}, {"left", ground, 0, 0.9, 1.5, 0.0}};
  const system::LocallyNonlinear system(parts);
  const SteadyResponse balanced = testing::respond(system, observing({0}), 1e-4);
  const SteadyResponse marched = march(system, observing({0}), 1e-4);
  EXPECT_EQ(marched.status, SteadyStatus::converged);
  EXPECT_NEAR(balanced.amplitude[0], marched.amplitude[0],
              2.0 * (balanced.error + marched.error) * marched.amplitude[0]);
  EXPECT_GT(balanced.amplitude[0], 0.75);  // it reaches both
  parts.stops.front().damping = 0.1;       // a force that jumps has no balance by samples
  EXPECT_THROW(HarmonicBalanceSolver(system::LocallyNonlinear(parts), observing({0}), {}), InvalidInput);
}

// Stuck and pressed, or sliding without friction, the contact is a spring in each direction.
TEST(ContactsInLimits, AreSprings) {
  const double w = 0.8;
  const auto spring = [&](double along, double across) {
    auto parts =
        testing::masses(Vector::Ones(2), Eigen::Vector2d(0.04, 0.06), Eigen::Vector2d(1.0 + along, 1.0 + across));
    parts.loads = testing::coupled(w, true).loads();
    return system::LocallyNonlinear(std::move(parts));
  };
  const auto compare = [&](LinearResponse found, LinearResponse expected, const system::LocallyNonlinear& system) {
    SteadyResponse one, other;
    found.solve(excitation_of(system), SteadyStart::unloaded, one);
    expected.solve(excitation_of(system), SteadyStart::unloaded, other);
    EXPECT_LE((one.amplitude - other.amplitude).norm(), 1e-12 * other.amplitude.norm());
  };
  const auto contact = testing::coupled(w, true);
  compare(stuck_limit(contact, observing({0, 1})), free_limit(spring(1.0, 2.0), observing({0, 1})), contact);
  compare(free_limit(contact, observing({0, 1})), free_limit(spring(0.0, 0.0), observing({0, 1})), contact);
}

}  // namespace
}  // namespace rubato::steady
