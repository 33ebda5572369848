#include "support/models.hpp"

#include <rubato/steady/periodic/periodic_solver.hpp>

#include <rubato/core/error.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace rubato::steady {
namespace {

using testing::chain;
using testing::damper_model;
using testing::single_mass;

SteadyResponse solve(const system::LocallyNonlinear& system, SteadyRequest request,
                     SteadyStart start = SteadyStart::unloaded) {
  PeriodicSolver solver(system, std::move(request));
  SteadyResponse response;
  solver.solve(excitation_of(system), start, response);
  return response;
}

double imbalance(const SteadyResponse& r) {
  return std::abs(r.input_work - r.viscous_work - r.dissipated.sum()) / std::abs(r.input_work);
}

// The steady state of the thesis's table 3.1, event-driven in 40 digits (reference page, section 3).
TEST(PeriodicSolver, FindsTheSteadyStateOfOneMassWithASlider) {
  const SteadyResponse r = solve(single_mass(0.15), {{{0}}, {1, 2, 3}});
  EXPECT_EQ(r.status, SteadyStatus::converged);
  EXPECT_LT(r.residual, 1e-10);
  EXPECT_NEAR(r.amplitude[0], 0.2942542080903754, 1e-14);
  EXPECT_NEAR(r.dissipated[0], 0.0865525248542252, 1e-14);
  EXPECT_NEAR(r.viscous_work, 0.543603660209531, 1e-13);
  EXPECT_NEAR(r.input_work, 0.630156185063756, 1e-13);
  EXPECT_EQ(r.transitions, 4);
  // The loop of a slider between +-A: 4 mu N (A - mu N / kT).
  EXPECT_NEAR(r.dissipated[0], 4 * 0.15 * (r.amplitude[0] - 0.15), 1e-14);
  EXPECT_NEAR(std::abs(r.harmonics(0, 1)), 0.0, 1e-15);  // half-wave symmetric: no even harmonics
  EXPECT_GT(std::abs(r.harmonics(0, 2)), 1e-4);
}

TEST(PeriodicSolver, FindsTheSteadyAmplitudesOfTheDamperModel) {
  const SteadyResponse r = solve(damper_model(), {{{0}, {1}, {1, 4}}, {1}});
  EXPECT_NEAR(r.amplitude[0], 0.0313777807495, 1e-13);
  EXPECT_NEAR(r.amplitude[1], 0.53295660136, 1e-11);
  EXPECT_NEAR(r.amplitude[2], r.amplitude[1], 1e-12);  // the damper rests under opposite forces
  EXPECT_LT(imbalance(r), 1e-10);
}

// Peaks of the response over frequency (reference page, section 3), at the frequencies of the peaks.
TEST(PeriodicSolver, GivesThePeaksOfOneMass) {
  const struct {
    double load, amplitude, omega;
  } peaks[] = {{0.1, 1.08867757048, 0.687575081},
               {0.3, 0.953146352429, 0.657293279},
               {0.8, 0.694210394916, 0.968311264},
               {1.2, 0.696387871444, 1.16513079},
               {1.6, 0.755928946018, 1.22474487}};
  for (const auto& peak : peaks)
    EXPECT_NEAR(solve(single_mass(0.5 * peak.load, peak.omega), {{{0}}}).amplitude[0], peak.amplitude, 1e-11)
        << peak.load;
}

// Without friction the response has a closed form.
TEST(PeriodicSolver, IsTheLinearResponseWithoutFriction) {
  for (const double omega : {0.3, 0.99, 1.0, 2.7}) {
    const SteadyResponse r = solve(single_mass(0.0, omega, 0.05), {{{0}}, {1}});
    const std::complex<double> exact = 1.0 / std::complex<double>(1.0 - omega * omega, 0.05 * omega);
    EXPECT_NEAR(r.amplitude[0], std::abs(exact), 1e-12 * std::abs(exact));
    EXPECT_NEAR(std::abs(r.harmonics(0, 0) - exact), 0.0, 1e-11 * std::abs(exact));
    EXPECT_NEAR(r.velocity_amplitude[0], omega * std::abs(exact), 1e-11 * std::abs(exact));
    EXPECT_NEAR(r.acceleration_amplitude[0], omega * omega * std::abs(exact), 1e-11 * std::abs(exact));
    EXPECT_NEAR(r.rms[0], std::abs(exact) / std::sqrt(2.0), 1e-12 * std::abs(exact));
    EXPECT_NEAR(r.viscous_work, std::numbers::pi * 0.05 * omega * std::norm(exact), 1e-11);
  }
}

// Den Hartog 1931, eq. 9: the amplitude of a mass on dry friction that never stops, the limit of a contact that is ever
// stiffer. The friction turns within sqrt(m / kT), by which amplitudes differ.
TEST(PeriodicSolver, FollowsContactsThatAreNearlyRigid) {
  const double limit = 0.3;
  for (const double stiffness : {1e8, 1e10, 1e12})
    for (const double r : {0.65, 0.8, 1.3}) {
      SCOPED_TRACE(::testing::Message() << "kT = " << stiffness << " N/m, " << r << " rad/s");
      system::LocallyNonlinear::Parts parts;
      parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
      parts.damping = testing::sparse(Matrix::Zero(1, 1));
      parts.sliders = {{"contact", 0, ground, stiffness, limit}};
      parts.loads = system::Loads({testing::harmonic(0, 1.0, r)});
      parts.coordinates = {"mass"};
      const SteadyResponse response = solve(system::LocallyNonlinear(std::move(parts)), {{{0}}});
      const double response_function = 1.0 / (1.0 - r * r);
      const double half_turn = std::numbers::pi / r;
      const double damping_function = std::sin(half_turn) / (r * (1.0 + std::cos(half_turn)));
      EXPECT_EQ(response.status, SteadyStatus::converged);
      EXPECT_NEAR(
          response.amplitude[0],
          std::abs(response_function) * std::sqrt(1.0 - std::pow(limit * damping_function / response_function, 2)),
          0.5 / std::sqrt(stiffness));
    }
}

TEST(PeriodicSolver, SaysThatAResonanceWithoutDampingIsUnbounded) {
  const SteadyResponse r = solve(single_mass(0.0, 1.0, 0.0), {{{0}}, {1}});
  EXPECT_EQ(r.status, SteadyStatus::unbounded);
  EXPECT_TRUE(std::isinf(r.amplitude[0]));
}

// A static load breaks the half-wave symmetry: the mean moves, and even harmonics appear.
TEST(PeriodicSolver, CarriesAStaticLoad) {
  const auto model = [](double load) {
    system::LocallyNonlinear::Parts parts;
    parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
    parts.damping = testing::sparse(0.1 * Matrix::Identity(1, 1));
    parts.sliders = {{"contact", 0, ground, 1.0, 0.3}};
    parts.loads = system::Loads({testing::harmonic(0, 1.0, 0.8), testing::harmonic(0, load, 0.0)});
    parts.coordinates = {"mass"};
    return system::LocallyNonlinear(std::move(parts));
  };
  const SteadyResponse without = solve(model(0.0), {{{0}}, {1, 2}}), with = solve(model(0.4), {{{0}}, {1, 2}});
  EXPECT_NEAR(without.mean[0], 0.0, 1e-14);
  // The slider slips both ways, so that it carries no static load in the end: the spring does, and the rest is the
  // same.
  EXPECT_NEAR(with.mean[0], 0.4, 1e-12);
  EXPECT_NEAR(with.amplitude[0], without.amplitude[0], 1e-11);
  EXPECT_LT(imbalance(with), 1e-10);
}

// A slider that never slips keeps the offset it is given, within its limit.
TEST(PeriodicSolver, KeepsTheOffsetOfASliderThatNeverSlips) {
  const auto model = [](double omega) {
    system::LocallyNonlinear::Parts parts;
    parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
    parts.damping = testing::sparse(0.1 * Matrix::Identity(1, 1));
    parts.sliders = {{"contact", 0, ground, 1.0, 1.0}};
    parts.loads = system::Loads({testing::harmonic(0, 0.3, omega)});
    parts.start.q = Vector::Constant(1, 3.0);
    parts.start.v = Vector::Zero(1);
    parts.start.slider_force = Vector::Zero(1);
    parts.coordinates = {"mass"};
    return system::LocallyNonlinear(std::move(parts));
  };
  const auto system = model(3.0);
  const SteadyResponse unloaded = solve(system, {{{0}}}), rest = solve(system, {{{0}}}, SteadyStart::rest);
  EXPECT_EQ(unloaded.offset[0], 0.0);
  EXPECT_EQ(unloaded.mean[0], 0.0);
  // Released from 3 m the slider slips and comes to rest with a force: 2 x + offset = 0 in the mean.
  EXPECT_GT(std::abs(rest.offset[0]), 0.01);
  EXPECT_NEAR(rest.mean[0], -0.5 * rest.offset[0], 1e-10);
  EXPECT_NEAR(rest.amplitude[0], unloaded.amplitude[0], 1e-11);

  // From a point before, which came from rest, the offset is carried over.
  PeriodicSolver solver(system, {{{0}}});
  SteadyResponse first, second;
  system::Excitation excitation = excitation_of(system);
  solver.solve(excitation, SteadyStart::rest, first);
  excitation.angular_frequency = 3.2;
  solver.solve(excitation, SteadyStart::previous, second);
  EXPECT_NEAR(second.offset[0], first.offset[0], 1e-12);
  solver.solve(excitation, SteadyStart::unloaded, second);
  EXPECT_NEAR(second.offset[0], 0.0, 1e-15);  // the round-off of kT u and fc
}

// Amplitude and phase of a wave, from its samples: they lie on the orbit.
TEST(PeriodicSolver, SamplesTheWaveform) {
  const auto system = damper_model(25.0, 7.4, -8.0);
  PeriodicSolver solver(system, {{{3}}, {1}});
  SteadyResponse r;
  solver.solve(excitation_of(system), SteadyStart::unloaded, r);
  const Waveform wave = solver.waveform(256);
  EXPECT_NEAR(wave.position.row(3).maxCoeff(), r.amplitude[0], 1e-3 * r.amplitude[0]);
  EXPECT_LE(wave.position.row(3).maxCoeff(), r.amplitude[0] * (1.0 + 1e-12));
  // The area of the loop of the samples, against the friction work; the trapezoidal rule on 256 points.
  for (Index i = 0; i < 2; ++i) {
    double area = 0.0;
    for (Index j = 0; j < 256; ++j) {
      const Index next = (j + 1) % 256;
      area += 0.5 * (wave.slider_force(i, j) + wave.slider_force(i, next)) *
              (wave.displacement(i, next) - wave.displacement(i, j));
    }
    EXPECT_NEAR(area, r.dissipated[i], 2e-3 * r.dissipated[i] + 1e-6);
  }
}

// Continued along a sweep and started afresh, the answers are the same to the tolerance.
TEST(PeriodicSolver, AnswersAlikeWhereverItComesFrom) {
  const auto system = damper_model(35.0, 7.0, -8.0);
  PeriodicSolver swept(system, {{{1}, {3}}, {1}}), fresh(system, {{{1}, {3}}, {1}});
  system::Excitation excitation = excitation_of(system);
  SteadyResponse a, b;
  for (int i = 0; i <= 60; ++i) {
    excitation.angular_frequency = 6.0 + 0.05 * i;
    swept.solve(excitation, SteadyStart::unloaded, a);
    fresh.forget();
    fresh.solve(excitation, SteadyStart::unloaded, b);
    ASSERT_EQ(a.status, SteadyStatus::converged);
    ASSERT_EQ(b.status, SteadyStatus::converged);
    // Both residuals are below 1e-12; the response amplifies them by at most 1/(pi zeta) = 16.
    EXPECT_NEAR(a.amplitude[1], b.amplitude[1], 1e-10 * a.amplitude[1]);
    EXPECT_LT(imbalance(a), 1e-10);
  }
}

// Equal sliders under opposite forces slip and stick together; a point continued from its neighbours starts where both
// are at their limits with a rate that is nearly round-off.
TEST(PeriodicSolver, FollowsSymmetricalSlidersToATightTolerance) {
  const auto system = damper_model(10.0, 7.5);
  PeriodicSolver solver(system, {{{3}}, {1}, false}, {1e-13});
  system::Excitation excitation = excitation_of(system);
  SteadyResponse r;
  for (int k = 0; k < 24; ++k) {
    excitation.limits.setConstant(0.5 * std::pow(10.0, 3.0 * k / 63));
    for (int i = 0; i <= 16; ++i) {
      excitation.angular_frequency = 7.0 + 1.5 * i / 16;
      solver.solve(excitation, SteadyStart::unloaded, r);
      ASSERT_EQ(r.status, SteadyStatus::converged) << excitation.limits[0] << ' ' << excitation.angular_frequency;
      EXPECT_LT(r.residual, 1e-12);
      EXPECT_NEAR(r.dissipated[0], r.dissipated[1], 1e-10 * r.dissipated[0]);
    }
  }
}

// With five iterations and no marching, a point is found afresh, but not from one of loads a thousand times as large.
TEST(PeriodicSolver, StartsAfreshWhereThePointBeforeLeadsNowhere) {
  const auto system = damper_model(25.0, 7.4, -8.0);
  PeriodicSolver solver(system, {{{3}}}, {1e-12, 5, 0}), fresh(system, {{{3}}}, {1e-12, 5, 0});
  system::Excitation excitation = excitation_of(system), large = excitation;
  large.harmonics[0].amplitude *= 1000.0;
  SteadyResponse first, second, expected;
  solver.solve(large, SteadyStart::unloaded, first);
  solver.solve(excitation, SteadyStart::unloaded, second);
  fresh.solve(excitation, SteadyStart::unloaded, expected);
  EXPECT_EQ(first.status, SteadyStatus::converged);
  EXPECT_EQ(second.status, SteadyStatus::converged);
  EXPECT_GT(second.iterations, 5);
  EXPECT_NEAR(second.amplitude[0], expected.amplitude[0], 1e-11);
}

/// Random structures of up to 12 coordinates and sliders that share them; loads of any phase, with static ones and
/// second and third harmonics; limits over three decades, some of them zero.
system::LocallyNonlinear random_model(unsigned seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto u = [&] { return uniform(generator); };
  const auto n = 2 + static_cast<Index>(u() * 11), m = 1 + static_cast<Index>(u() * 12);
  const auto any = [&] { return static_cast<Index>(u() * static_cast<double>(n)); };
  system::LocallyNonlinear::Parts parts;
  Vector mass(n);
  for (double& x : mass) x = 0.5 + 2.0 * u();
  Matrix k = Matrix::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    k(i, i) += i == 0 || u() < 0.5 ? 0.5 + u() : 0.0;
    if (i == 0) continue;
    const double joint = 0.5 + 3.0 * u();
    k(i, i) += joint;
    k(i - 1, i - 1) += joint;
    k(i, i - 1) = k(i - 1, i) = -joint;
  }
  Matrix c = 0.03 * (0.2 + u()) * k;
  c.diagonal() += 0.02 * u() * mass;
  parts.mass = testing::sparse(mass.asDiagonal().toDenseMatrix());
  parts.stiffness = testing::sparse(k);
  parts.damping = testing::sparse(c);
  for (Index i = 0; i < m; ++i) {
    const Index first = any(), second = u() < 0.3 ? ground : any();
    const double limit = u() < 0.05 ? 0.0 : std::pow(10.0, -2.0 + 3.0 * u());
    parts.sliders.push_back({"s", first, first == second ? ground : second, 0.3 + 3.0 * u(), limit});
  }
  const double omega = 0.2 + 2.2 * u();
  std::vector<system::LoadTerm> loads{testing::harmonic(any(), 1.0, omega, 6.0 * u())};
  for (const double order : {0.0, 1.0, 2.0, 3.0})
    if (u() < 0.3) loads.push_back(testing::harmonic(any(), 2.0 * u() - 1.0, order * omega, 6.0 * u()));
  parts.loads = system::Loads(std::move(loads));
  parts.coordinates.assign(static_cast<std::size_t>(n), "x");
  return system::LocallyNonlinear(std::move(parts));
}

class NoVisitor final : public integrate::ExactVisitor {
  bool sample(const system::State&, const integrate::ExactWork&) override { return true; }
  bool transition(const system::State&, const integrate::Transition&, const integrate::ExactWork&) override {
    return true;
  }
};

// The exact flow, followed for three periods, comes back to the state that was found.
TEST(PeriodicSolver, FindsOrbitsOfRandomStructures) {
  NoVisitor nothing;
  for (unsigned seed = 0; seed < 150; ++seed) {
    const auto system = random_model(seed);
    PeriodicSolver solver(system, {{{0}}, {1}});
    const system::Excitation excitation = excitation_of(system);
    SteadyResponse r;
    solver.solve(excitation, SteadyStart::unloaded, r);
    ASSERT_EQ(r.status, SteadyStatus::converged) << seed;
    EXPECT_LT(r.residual, 1e-10) << seed;
    EXPECT_LT(imbalance(r), 1e-10) << seed;
    system::State state = solver.state();
    integrate::ExactFlow flow(system);
    ASSERT_EQ(flow.advance(state, 3.0 * excitation.period(), {}, nothing).end, integrate::ExactEnd::reached);
    EXPECT_LT((state.q - solver.state().q).norm(), 1e-10 * (1.0 + state.q.norm())) << seed;
  }
}

TEST(Excitation, KnowsTheCommonPeriod) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = parts.damping = testing::sparse(Matrix::Identity(1, 1));
  parts.loads = system::Loads({testing::harmonic(0, 1.0, 3.0), testing::harmonic(0, 2.0, 4.5, 0.3)});
  parts.coordinates = {"x"};
  const system::Excitation excitation = excitation_of(system::LocallyNonlinear(parts));
  EXPECT_NEAR(excitation.angular_frequency, 1.5, 1e-15);
  ASSERT_EQ(excitation.harmonics.size(), 2u);
  EXPECT_EQ(excitation.harmonics[0].order, 2);
  EXPECT_EQ(excitation.harmonics[1].order, 3);
  EXPECT_NEAR(std::arg(excitation.harmonics[1].amplitude[0]), 0.3, 1e-15);
  EXPECT_FALSE(excitation.is_half_wave_symmetric());
  parts.loads = system::Loads({testing::harmonic(0, 1.0, 3.0), testing::harmonic(0, 2.0, std::sqrt(2.0))});
  EXPECT_THROW(excitation_of(system::LocallyNonlinear(parts)), InvalidInput);
}

// Forces of two frequencies may push a chain that nothing but sliders holds on its way: this one walks 0.2 m a period
// for ever, as a transient shows. Far enough away the walk would be round-off of the position: that is no orbit either.
TEST(PeriodicSolver, TakesNoWalkForAnOrbit) {
  system::LocallyNonlinear::Parts parts;
  Vector mass(3);
  mass << 0.6845140700736068, 0.3275829134036167, 0.4040026583457988;
  const double first = 41.24021377000159, second = 19.888779810299482;
  Matrix k(3, 3);
  k << first, -first, 0.0, -first, first + second, -second, 0.0, -second, second;
  parts.mass = testing::sparse(mass.asDiagonal().toDenseMatrix());
  parts.stiffness = testing::sparse(k);
  parts.damping = testing::sparse(0.02554924503352102 * mass.asDiagonal().toDenseMatrix() + 0.006196847218834506 * k);
  parts.sliders = {{"strong", 0, ground, 1.0390431529711275, 0.4673182459810743 * 16.996279588441713},
                   {"weak", 1, ground, 56.694137668549125, 0.9664050727189776 * 0.020625237756364004}};
  const double w = 1.115219175335083;
  parts.loads = system::Loads({testing::harmonic(1, 3.5560775831818128, w, 2.609013441762306),
                               testing::harmonic(2, 2.776981873547507, 0.5 * w, 0.7923888146300833)});
  parts.coordinates = {"c0", "c1", "c2"};
  const system::LocallyNonlinear system(std::move(parts));
  PeriodicSolver solver(system, {{{0}, {1}, {2}}, {1}, false});
  SteadyResponse response;
  solver.solve(excitation_of(system), SteadyStart::unloaded, response);
  EXPECT_EQ(response.status, SteadyStatus::drifting);
  EXPECT_LE(response.residual, 1e-12);
  EXPECT_LT(imbalance(response), 1e-10);
}

// The damper without its spring to the ground: only the contacts hold it. The static load on a blade makes neither half
// of the period the mirror of the other, so that nothing but friction says where the damper stands.
TEST(PeriodicSolver, FindsTheOrbitOfADamperThatOnlyItsContactsHold) {
  const auto base = damper_model(10.0, 7.6, -8.0);
  system::LocallyNonlinear::Parts parts;
  parts.mass = base.mass();
  parts.damping = base.damping();
  parts.stiffness = base.stiffness();
  parts.stiffness.coeffRef(4, 4) = 0.0;
  parts.damping.coeffRef(4, 4) = 0.0;
  parts.sliders = base.sliders();
  parts.coordinates = base.coordinates();
  parts.loads =
      system::Loads({testing::harmonic(1, 20.0, 7.6), testing::harmonic(3, -8.0, 7.6), testing::harmonic(3, 6.0, 0.0)});
  const system::LocallyNonlinear system(std::move(parts));
  PeriodicSolver solver(system, {{{1}, {3}, {4}}, {1}, false});
  SteadyResponse response;
  solver.solve(excitation_of(system), SteadyStart::unloaded, response);
  EXPECT_EQ(response.status, SteadyStatus::converged);
  EXPECT_LE(response.residual, 1e-12);
  EXPECT_GT(response.dissipated.minCoeff(), 0.0);
  EXPECT_NEAR(response.input_work, response.viscous_work + response.dissipated.sum(), 1e-10 * response.input_work);
  EXPECT_LT(solver.state().q.norm(), 1e3 * response.amplitude.maxCoeff());
}

TEST(PeriodicSolver, RefusesPeriodsThatHoldTooManyNaturalOnes) {
  const auto system = damper_model();
  PeriodicSolver solver(system, {{{0}}, {1}, false});
  system::Excitation slow = excitation_of(system);
  slow.angular_frequency = 1e-7;
  SteadyResponse response;
  EXPECT_THROW(solver.solve(slow, SteadyStart::unloaded, response), InvalidInput);
}

}  // namespace
}  // namespace rubato::steady
