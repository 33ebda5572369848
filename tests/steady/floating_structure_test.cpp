#include "support/harmonic_response.hpp"

#include <rubato/core/error.hpp>
#include <rubato/steady/marching/time_marching.hpp>
#include <rubato/steady/periodic/periodic_solver.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

// Structures that nothing holds: a satellite, a rig on soft cords. Their rigid motion has no stiffness and no damping.
namespace rubato::steady {
namespace {

using testing::observing;

/// Masses of 1.7 and 1.2 kg with a spring of 1.5 N/m, a dashpot of 0.1 N s/m and a slider of 3 N/m and 0.2 N between
/// them.
system::LocallyNonlinear floating() {
  Matrix mass = Matrix::Zero(2, 2), between(2, 2);
  mass.diagonal() << 1.7, 1.2;
  between << 1.0, -1.0, -1.0, 1.0;
  return testing::structure(mass, 0.1 * between, 1.5 * between, {{"s", 0, 1, 3.0, 0.2}}, {});
}

system::Excitation load(double angular_frequency) {
  ComplexVector once = ComplexVector::Zero(2), twice = once;
  once[0] = 0.5;
  twice[1] = std::polar(0.3, 0.4);
  system::Excitation excitation;
  excitation.angular_frequency = angular_frequency;
  excitation.harmonics = {{1, once}, {2, twice}};
  excitation.constant = Vector::Zero(2);
  excitation.limits = Vector::Constant(1, 0.2);
  return excitation;
}

// While the slider sticks it is a spring: each order of the load against M, C and K with it. It lies where it was
// installed on average. It was sent off at speeds of any size, as one that walks, with amplitudes of 640 m.
TEST(FloatingStructure, VibratesAboutWhereItWasInstalled) {
  const auto system = floating();
  PeriodicSolver shooting(system, observing({0, 1}));
  HarmonicBalanceSolver balance(system, observing({0, 1}));
  SteadyResponse response, balanced;
  shooting.solve(load(2.0), SteadyStart::unloaded, response);
  ASSERT_EQ(response.status, SteadyStatus::converged);
  EXPECT_GT(response.slip_share[0], 0.1);
  balance.solve(load(2.0), SteadyStart::unloaded, balanced);
  ASSERT_EQ(balanced.status, SteadyStatus::converged);
  EXPECT_NEAR(balanced.amplitude[0], response.amplitude[0], 1e-4 * response.amplitude[0]);
  for (const double w : {4.0, 9.0, 20.0}) {
    SCOPED_TRACE(w);
    shooting.solve(load(w), SteadyStart::unloaded, response);
    balance.solve(load(w), SteadyStart::unloaded, balanced);
    ASSERT_EQ(response.status, SteadyStatus::converged);
    ASSERT_EQ(balanced.status, SteadyStatus::converged);
    ASSERT_EQ(response.slip_share[0], 0.0);
    double squares = 0.0;  // of the first mass: two orders
    for (const system::LoadHarmonic& part : load(w).harmonics) {
      const double k = part.order * w;
      const Matrix stiffness = Matrix(system.stiffness()) * (4.5 / 1.5) - k * k * Matrix(system.mass());
      ComplexMatrix z = stiffness.cast<Complex>() + Complex(0.0, k) * Matrix(system.damping()).cast<Complex>();
      squares += 0.5 * std::norm((z.partialPivLu().solve(part.amplitude))[0]);
    }
    EXPECT_NEAR(response.rms[0], std::sqrt(squares), 1e-9 * std::sqrt(squares));
    EXPECT_NEAR(balanced.rms[0], std::sqrt(squares), 1e-4 * std::sqrt(squares));
    EXPECT_NEAR(1.7 * response.mean[0] + 1.2 * response.mean[1], 0.0, 1e-12);
    EXPECT_LT(response.error, 1e-10);
  }
}

TEST(FloatingStructure, IsNotMarchedForUnderLoads) {
  const auto system = floating();
  TimeMarchingSolver marching(system, TimeMarchingOptions{}, observing({0}));
  SteadyResponse response;
  EXPECT_THROW(marching.solve(load(2.0), SteadyStart::unloaded, response), InvalidInput);
}

/// Loads that balance, and a static one that does not.
system::Excitation carrying_off(Index sliders) {
  ComplexVector once(2);
  once << 0.5, -0.5;
  system::Excitation excitation;
  excitation.angular_frequency = 2.0;
  excitation.harmonics = {{1, once}};
  excitation.constant = Vector::Unit(2, 0) * 0.4;
  excitation.limits = Vector::Constant(sliders, 0.2);
  return excitation;
}

// Far away what a period adds is nothing beside the way that was gone: the march came to rest 2.5e10 m from its start
// with an amplitude of 0.
TEST(FloatingStructure, IsCarriedOffByAStaticLoadThatNothingBalances) {
  Matrix mass = Matrix::Zero(2, 2), between(2, 2), to_ground = Matrix::Zero(2, 2);
  mass.diagonal() << 1.7, 1.2;
  between << 1.0, -1.0, -1.0, 1.0;
  to_ground(0, 0) = 0.1;
  for (const auto start : {SteadyStart::unloaded, SteadyStart::rest}) {
    for (const Matrix& damping : {Matrix(0.1 * between), Matrix(0.1 * between + to_ground)}) {
      const auto linear = testing::structure(mass, damping, 1.5 * between, {}, {});
      TimeMarchingSolver marching(linear, TimeMarchingOptions{}, observing({0, 1}));
      SteadyResponse response;
      marching.solve(carrying_off(0), start, response);
      EXPECT_EQ(response.status, SteadyStatus::unbounded);
      EXPECT_TRUE(marching.waveform(8).position.array().isNaN().all());
    }
    const auto sticking = floating();
    TimeMarchingSolver marching(sticking, TimeMarchingOptions{}, observing({0, 1}));
    SteadyResponse response;
    marching.solve(carrying_off(1), start, response);
    EXPECT_EQ(response.status, SteadyStatus::unbounded);
    system::Excitation balanced = carrying_off(1);  // and the point after it is told as if it were the first
    balanced.constant[1] = -0.4;
    marching.solve(balanced, start, response);
    EXPECT_EQ(response.status, SteadyStatus::converged);
  }
}

}  // namespace
}  // namespace rubato::steady
