#include "support/models.hpp"

#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/marching/time_marching.hpp>
#include <rubato/steady/periodic/periodic_solver.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

namespace rubato::steady {
namespace {

using std::numbers::pi;

constexpr double limit = 0.2, dashpot = 0.5, frequency = 2.0, period = 2.0 * pi / frequency;

/// A mass of 1 kg on a dashpot, held by one slider alone.
system::LocallyNonlinear mass_on_a_slider(std::vector<system::LoadTerm> loads, double damping = dashpot) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = testing::sparse(damping * Matrix::Identity(1, 1));
  parts.stiffness = testing::sparse(Matrix::Zero(1, 1));
  parts.sliders = {{"contact", 0, ground, 10.0, limit}};
  parts.loads = system::Loads(std::move(loads));
  parts.coordinates = {"mass"};
  return system::LocallyNonlinear(std::move(parts));
}

struct Route {
  std::string name;
  double tolerance;  ///< of amplitudes and drifts
};
const Route routes[] = {{"periodic", 1e-9}, {"harmonic_balance", 1e-3}, {"time_marching", 1e-3}};

SteadyResponse respond(const std::string& route, const system::LocallyNonlinear& system) {
  const SteadyRequest request{{{0}}, {1}, true};
  std::unique_ptr<SteadySolver> solver;
  if (route == "periodic")
    solver = std::make_unique<PeriodicSolver>(system, request);
  else if (route == "harmonic_balance")
    solver = std::make_unique<HarmonicBalanceSolver>(system, request);
  else
    solver = std::make_unique<TimeMarchingSolver>(system, TimeMarchingOptions{}, request);
  SteadyResponse response;
  solver->solve(excitation_of(system), SteadyStart::unloaded, response);
  return response;
}

/// How far a coordinate of the exact flow from rest walks in a period, once so many are over.
double drift_of_exact_flow(const system::LocallyNonlinear& system, Index coordinate, double of_period, int periods) {
  struct Nothing final : integrate::ExactVisitor {
    bool sample(const system::State&, const integrate::ExactWork&) override { return true; }
    bool transition(const system::State&, const integrate::Transition&, const integrate::ExactWork&) override {
      return true;
    }
  } nothing;
  integrate::ExactFlow flow(system);
  system::State state = system.start();
  flow.advance(state, periods * of_period, {}, nothing);
  const double before = state.q[coordinate];
  flow.advance(state, (periods + 1) * of_period, {}, nothing);
  return state.q[coordinate] - before;
}

// Once it slides and never turns, m v' + c v = f - limit: the velocity is its mean (f0 - limit) / c and the linear
// answer to the harmonic part, 0.1 / |c + i w m|, which is smaller.
TEST(Drift, IsThatOfTheMeanForceWhereASliderNeverTurns) {
  const auto system = mass_on_a_slider({testing::harmonic(0, 0.5, 0.0), testing::harmonic(0, 0.1, frequency)});
  for (const Route& route : routes) {
    SCOPED_TRACE(route.name);
    const SteadyResponse r = respond(route.name, system);
    ASSERT_EQ(r.status, SteadyStatus::drifting);
    ASSERT_EQ(r.drift.size(), 1);
    const double expected = (0.5 - limit) / dashpot * period;
    EXPECT_NEAR(r.drift[0], expected, route.tolerance * expected);
    const double swing = 0.1 / std::hypot(dashpot, frequency);
    EXPECT_NEAR(r.velocity_amplitude[0], swing, route.tolerance * expected);
    EXPECT_NEAR(r.dissipated[0], limit * expected, route.tolerance * expected);
    EXPECT_NEAR(r.slip_share[0], 1.0, 1e-12);
    EXPECT_TRUE(std::isnan(r.mean[0]));
  }
}

// The mean of the first force is below the limit, that of the second zero; but more of the second pulls one way for a
// short time than the other way for a long one, and friction holds more of the latter. The exact flow from rest walks
// as far a period.
TEST(Drift, IsThatOfTheExactFlowWhereForcesPullMoreOneWay) {
  const std::vector<system::LoadTerm> pushed{testing::harmonic(0, 0.1, 0.0), testing::harmonic(0, 0.5, frequency)},
      jerked{testing::harmonic(0, 0.4, frequency), testing::harmonic(0, 0.3, 2.0 * frequency)};
  for (const auto& loads : {pushed, jerked}) {
    const auto system = mass_on_a_slider(loads);
    const double expected = drift_of_exact_flow(system, 0, period, 40);  // exp(-c t / m) = 5e-28
    ASSERT_GT(std::abs(expected), 1e-3);
    for (const Route& route : routes) {
      SCOPED_TRACE(route.name);
      const SteadyResponse r = respond(route.name, system);
      ASSERT_EQ(r.status, SteadyStatus::drifting);
      EXPECT_NEAR(r.drift[0], expected, route.tolerance * r.amplitude[0]);
      EXPECT_NEAR(r.input_work, r.viscous_work + r.dissipated.sum(), route.tolerance * r.input_work);
    }
  }
}

TEST(Drift, IsNoneWhereTheForceIsTheSameBothWays) {
  const auto system = mass_on_a_slider({testing::harmonic(0, 0.5, frequency)});
  for (const Route& route : routes) {
    SCOPED_TRACE(route.name);
    const SteadyResponse r = respond(route.name, system);
    EXPECT_EQ(r.status, SteadyStatus::converged);
    EXPECT_EQ(r.drift.size(), 0);
  }
}

// The same loads as above, and a spring as weak as that: friction and it balance somewhere.
TEST(Drift, EndsWhereASpringHoldsTheStructure) {
  system::LocallyNonlinear::Parts parts;
  const auto free = mass_on_a_slider({testing::harmonic(0, 0.1, 0.0), testing::harmonic(0, 0.5, frequency)});
  parts.mass = free.mass();
  parts.damping = free.damping();
  parts.stiffness = testing::sparse(0.05 * Matrix::Identity(1, 1));
  parts.sliders = free.sliders();
  parts.loads = free.loads();
  parts.coordinates = free.coordinates();
  const system::LocallyNonlinear system(std::move(parts));
  for (const Route& route : routes) {
    SCOPED_TRACE(route.name);
    EXPECT_EQ(respond(route.name, system).status, SteadyStatus::converged);
  }
}

// Nothing limits the speed.
TEST(Drift, GrowsForEverWithoutADashpot) {
  const auto system = mass_on_a_slider({testing::harmonic(0, 0.5, 0.0), testing::harmonic(0, 0.1, frequency)}, 0.0);
  for (const Route& route : routes) {
    SCOPED_TRACE(route.name);
    const SteadyResponse r = respond(route.name, system);
    EXPECT_EQ(r.status, SteadyStatus::unbounded);
    EXPECT_EQ(r.amplitude[0], std::numeric_limits<double>::infinity());
  }
}

// The shape of the motion that nothing resists is known to round-off: the first mass seems to move in it, and its
// dashpot to resist. time_marching found a drift of 1e9 m a period, at a speed beside which the acceleration of a
// period is nothing.
TEST(Drift, GrowsForEverBesideAMassWithADashpot) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(2, 2));
  Matrix first = Matrix::Zero(2, 2);
  first(0, 0) = 1.0;
  parts.damping = testing::sparse(2.0 * first);
  parts.stiffness = testing::sparse(100.0 * first);
  parts.sliders = {{"contact", 0, 1, 30.0, 0.5}};
  parts.loads = system::Loads({testing::harmonic(0, 3.0, frequency), testing::harmonic(1, 0.8, 0.0)});
  parts.coordinates = {"held", "free"};
  const system::LocallyNonlinear system(std::move(parts));
  for (const Route& route : routes) {
    SCOPED_TRACE(route.name);
    EXPECT_EQ(respond(route.name, system).status, SteadyStatus::unbounded);
  }
}

// A chain of three that one slider holds, beside a static load. Very far away the force of the slider is what round-off
// makes of it, and balances anything: harmonic balance told `converged` with a mean of 4.5e14 m. The exact flow from
// rest walks.
TEST(Drift, IsNotLostInABalanceFarAway) {
  Matrix stiffness(3, 3);
  stiffness << 1.70679, -1.70679, 0.0, -1.70679, 4.63312, -2.92633, 0.0, -2.92633, 2.92633;
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Vector{{0.597243, 1.33168, 1.50341}}.asDiagonal());
  parts.damping = testing::sparse(0.196962 * stiffness);
  parts.stiffness = testing::sparse(stiffness);
  parts.sliders = {{"contact", 2, ground, 67.6213, 0.387845}};
  parts.coordinates = {"a", "b", "c"};
  const system::LocallyNonlinear system(parts);
  for (const auto& [share, w] : {std::pair{0.426659, 0.380956}, std::pair{0.362037, 0.484853}}) {
    SCOPED_TRACE(w);
    system::Excitation load;
    load.angular_frequency = w;
    load.harmonics = {{1, ComplexVector::Unit(3, 0) * (share * 0.577747)},
                      {2, ComplexVector::Unit(3, 2) * (share * Complex(0.212791, -0.172431))}};
    load.constant = Vector::Constant(3, 0.0935439);
    load.limits = Vector::Constant(1, 0.387845);
    const SteadyRequest request{{{0}, {2}}, {1}};
    SteadyResponse walking, balanced;
    PeriodicSolver(system, request).solve(load, SteadyStart::unloaded, walking);
    HarmonicBalanceSolver(system, request).solve(load, SteadyStart::unloaded, balanced);
    ASSERT_EQ(walking.status, SteadyStatus::drifting);
    ASSERT_EQ(balanced.status, SteadyStatus::drifting);
    EXPECT_NEAR(balanced.amplitude[0], walking.amplitude[0], 1e-6 * walking.amplitude[0]);
    EXPECT_NEAR(balanced.drift[1], walking.drift[1], 1e-6 * std::abs(walking.drift[1]));
    system::LocallyNonlinear::Parts loaded = parts;
    std::vector<system::LoadTerm> terms;
    for (Index i = 0; i < 3; ++i) terms.push_back(testing::harmonic(i, load.constant[i], 0.0));
    for (const system::LoadHarmonic& part : load.harmonics)
      for (Index i = 0; i < 3; ++i)
        if (part.amplitude[i] != 0.0)
          terms.push_back(
              testing::harmonic(i, std::abs(part.amplitude[i]), part.order * w, std::arg(part.amplitude[i])));
    loaded.loads = system::Loads(std::move(terms));
    const double marched = drift_of_exact_flow(system::LocallyNonlinear(std::move(loaded)), 2, 2.0 * pi / w, 60);
    ASSERT_GT(std::abs(marched), 1e-3);
    EXPECT_NEAR(walking.drift[1], marched, 1e-7 * std::abs(marched));
  }
}

}  // namespace
}  // namespace rubato::steady
