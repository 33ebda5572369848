#include <rubato/integrate/exact/exact_flow.hpp>
#include <rubato/steady/harmonic_balance/harmonic_balance.hpp>
#include <rubato/steady/linear/linear_response.hpp>
#include <rubato/steady/periodic/periodic_solver.hpp>

#include "support/harmonic_response.hpp"
#include "support/models.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace rubato::steady {
namespace {

using testing::damper_model;
using testing::expect_balance;
using testing::observing;
using testing::respond;
using testing::single_mass;
using testing::structure;

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

/// A chain of three to the ground with two sliders that share a coordinate and one to the ground, loads of two orders
/// with phases, and a static one; a dashpot makes the damping general.
system::LocallyNonlinear awkward(double limit, double static_load = 0.4) {
  Matrix k(3, 3), m = Matrix::Zero(3, 3), c;
  k << 3, -1, 0, -1, 3, -1, 0, -1, 2;
  m.diagonal() << 1.0, 2.0, 0.5;
  c = 0.05 * k;
  c(2, 2) += 0.1;
  const double w = 0.8;
  return structure(m, c, k,
                   {{"a", 0, 1, 2.0, limit}, {"b", 1, 2, 1.5, 0.7 * limit}, {"c", 0, ground, 1.0, 1.4 * limit}},
                   {testing::harmonic(0, 2.0, w, 0.3), testing::harmonic(2, 1.5, 2 * w, -1.0),
                    testing::harmonic(1, static_load, 0.0)});
}

// Marches with the exact event-driven flow until the transient has died out (the slowest mode decays as exp(-0.02 t) or
// faster) and samples one more period. The samples bracket the extremes of the motion to (pi / 4000)^2 / 2 = 3e-7.
struct Marched {
  Vector amplitude, mean;
};
Marched march(const system::LocallyNonlinear& system, double w, int periods) {
  struct Samples final : integrate::ExactVisitor {
    bool sample(const system::State& state, const integrate::ExactWork&) override {
      highest = count == 0 ? state.q : Vector(highest.cwiseMax(state.q));
      lowest = count == 0 ? state.q : Vector(lowest.cwiseMin(state.q));
      sum = count++ == 0 ? state.q : Vector(sum + state.q);
      return true;
    }
    bool transition(const system::State&, const integrate::Transition&, const integrate::ExactWork&) override {
      return true;
    }
    Vector highest, lowest, sum;
    int count = 0;
  } samples;
  integrate::ExactFlow flow(system);
  system::State state = system.start();
  const double period = 2.0 * std::numbers::pi / w, start = periods * period;
  flow.advance(state, start, {}, samples);
  std::vector<double> times;
  for (int i = 0; i < 4000; ++i) times.push_back(start + period * i / 4000);
  flow.advance(state, start + period, times, samples);
  return {0.5 * (samples.highest - samples.lowest), samples.sum / samples.count};
}

TEST(HarmonicBalance, AgreesWithTheExactFlowWhereNothingIsSymmetric) {
  for (const double limit : {0.05, 0.3, 0.8}) {
    const auto system = awkward(limit);
    const SteadyResponse r = respond(system, observing({0, 1, 2}), 1e-5);
    const Marched exact = march(system, 0.8, 150);
    // 1e-5 by truncation of the largest, and what is left of the transient: exp(-0.02 * 150 * 7.85) = 6e-11.
    for (Index i = 0; i < 3; ++i) {
      EXPECT_NEAR(r.amplitude[i], exact.amplitude[i], 1.1e-5 * exact.amplitude.maxCoeff()) << limit << " " << i;
      // Where a slider sticks for good the mean depends on where it came to stick.
      if (r.slip_share.minCoeff() > 0.0) {
        EXPECT_NEAR(r.mean[i], exact.mean[i], 1.1e-5 * exact.amplitude.maxCoeff()) << limit << " " << i;
      }
    }
    expect_balance(r);
  }
}

TEST(HarmonicBalance, ConvergesAsOrdersAreAdded) {
  // Reference page, section 5: at the damper optimum one harmonic misses by 2.6e-5, three by 1e-7.
  const auto system = damper_model(34.7788, 7.777456595);
  const double exact = 3.45279383277;
  SteadyResponse one, three;
  HarmonicBalanceSolver first(system, observing({1}), {.tolerance = 1.0, .most_harmonics = 1});
  first.solve(excitation_of(system), SteadyStart::unloaded, one);
  EXPECT_EQ(first.highest_order(), 1);
  EXPECT_NEAR(std::abs(one.amplitude[0] / exact - 1.0), 2.6e-5, 0.05e-5);
  SteadyRequest request = observing({1});
  request.harmonics = {1, 3};  // orders asked for are balanced
  HarmonicBalanceSolver second(system, request, {.tolerance = 1.0, .most_harmonics = 3});
  second.solve(excitation_of(system), SteadyStart::unloaded, three);
  EXPECT_EQ(second.highest_order(), 3);
  EXPECT_LT(std::abs(three.amplitude[0] / exact - 1.0), 5e-7);  // the page rounds to a power of ten
  EXPECT_GT(std::abs(three.harmonics(0, 1)), 0.0);
}

TEST(HarmonicBalance, BalancesTheWorkAtEveryPointWhateverTheTruncation) {
  const auto system = damper_model(25.0, 7.0, -8.0);
  HarmonicBalanceSolver solver(system, observing({1, 3}));
  system::Excitation excitation = excitation_of(system);
  SteadyResponse r;
  for (int i = 0; i <= 60; ++i) {
    excitation.angular_frequency = 6.0 + 0.05 * i;
    solver.solve(excitation, SteadyStart::unloaded, r);
    ASSERT_EQ(r.status, SteadyStatus::converged) << i;
    EXPECT_LE(r.error, 1e-3);
    expect_balance(r);
  }
}

// Free: limits of zero give the linear structure; full stick: so do springs in the place of the sliders.
TEST(HarmonicBalance, HasTheTwoLinearLimits) {
  const auto with = [](double limit) { return awkward(limit, 0.0); };
  const auto system = with(1.0);
  const double w = 0.8;
  const auto linear = [&](const SparseMatrix& stiffness) {
    ComplexMatrix harmonics(3, 2);
    for (int k = 1; k <= 2; ++k) {
      const ComplexMatrix z = Matrix(stiffness - k * w * k * w * system.mass()).cast<std::complex<double>>() +
                              std::complex<double>(0, k * w) * Matrix(system.damping()).cast<std::complex<double>>();
      ComplexVector f = ComplexVector::Zero(3);
      if (k == 1) f[0] = std::polar(2.0, 0.3);
      if (k == 2) f[2] = std::polar(1.5, -1.0);
      harmonics.col(k - 1) = z.partialPivLu().solve(f);
    }
    return harmonics;
  };
  SteadyRequest request = observing({0, 1, 2});
  request.harmonics = {1, 2};
  const SteadyResponse free = respond(with(0.0), request), stuck = respond(with(1e6), request);
  EXPECT_LT((free.harmonics - linear(system.stiffness())).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((stuck.harmonics - linear(system.stuck_stiffness())).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_EQ(stuck.transitions, 0);
  EXPECT_EQ(stuck.dissipated.sum() + free.dissipated.sum(), 0.0);
  EXPECT_LT(stuck.error, 1e-11);  // round-off alone
  EXPECT_EQ(stuck.offset.norm(), 0.0);
}

// A slider that slipped under a large load and then sticks keeps the offset at which it came to rest; unloaded it has
// none.
TEST(HarmonicBalance, RemembersTheOffsetOfASliderThatSticks) {
  const auto system = single_mass(0.5, 0.3, 0.3);
  HarmonicBalanceSolver solver(system, observing({0}), {.tolerance = 1e-5});
  system::Excitation strong = excitation_of(system), weak = strong;
  strong.constant = Vector::Constant(1, 2.0);
  weak.harmonics[0].amplitude *= 0.1;
  SteadyResponse r;
  solver.solve(strong, SteadyStart::unloaded, r);
  EXPECT_GT(r.slip_share[0], 0.0);
  EXPECT_NEAR(r.mean[0], 2.0,
              1e-3);  // the loop about its middle is symmetric: the spring alone carries the static load
  solver.solve(weak, SteadyStart::previous, r);
  EXPECT_EQ(r.slip_share[0], 0.0);
  // (k + kT) mean + offset = 0, with the offset at the lower limit: the force of the slider swings within its limits.
  EXPECT_LT(r.offset[0], -0.3);
  EXPECT_NEAR(2.0 * r.mean[0] + r.offset[0], 0.0, 1e-9);
  const double swing = r.amplitude[0];
  EXPECT_GE(r.mean[0] + r.offset[0] - swing, -0.5 - 1e-9);
  solver.solve(weak, SteadyStart::unloaded, r);
  EXPECT_EQ(r.offset[0], 0.0);
  EXPECT_EQ(r.mean[0], 0.0);
}

TEST(HarmonicBalance, SaysThatAResonanceWithoutDampingIsUnbounded) {
  // Omega = 1 is the natural frequency: 4 limit / pi = 0.127 does not hold back a load of 1.
  const SteadyRequest request = observing({0});
  for (const double limit : {0.0, 0.1}) {
    const auto system = single_mass(limit, 1.0, 0.0);
    HarmonicBalanceSolver solver(system, request);
    SteadyResponse r;
    solver.solve(excitation_of(system), SteadyStart::unloaded, r);
    EXPECT_EQ(r.status, SteadyStatus::unbounded);
    EXPECT_TRUE(std::isinf(r.amplitude[0]));
  }
  // Friction beyond that bounds it: with one order, pi f0 A = 4 limit (A - limit / kT).
  const auto held = single_mass(0.9, 1.0, 0.0);
  HarmonicBalanceSolver solver(held, request, {.tolerance = 1e-6, .most_harmonics = 401});
  SteadyResponse r;
  solver.solve(excitation_of(held), SteadyStart::unloaded, r);
  EXPECT_EQ(r.status, SteadyStatus::converged);
  EXPECT_TRUE(std::isfinite(r.amplitude[0]));
  EXPECT_NEAR(r.input_work, r.dissipated[0], 1e-9);
}

system::LocallyNonlinear rubbing_mass(double contact_stiffness, double limit, double w, double damping) {
  Matrix m(1, 1), c(1, 1);
  m << 1.0;
  c << damping;
  return structure(m, c, m, {{"contact", 0, ground, contact_stiffness, limit}}, {testing::harmonic(0, 1.0, w)});
}

// Contacts of a thousand to a million times the spring, which stick and slip, slip alone or hardly move, against the
// orbit: within the tolerance, and within what the answer says of itself.
TEST(HarmonicBalance, BalancesStiffContacts) {
  for (const double stiffness : {1e3, 1e4, 1e5, 1e6})
    for (const auto& [w, limit] : {std::pair{0.1, 0.1}, {0.5, 0.5}, {0.95, 0.5}, {0.95, 0.8}, {1.5, 0.3}, {0.3, 0.8}}) {
      SCOPED_TRACE(stiffness);
      SCOPED_TRACE(w);
      const auto system = rubbing_mass(stiffness, limit, w, 0.1);
      HarmonicBalanceSolver solver(system, observing({0}));
      PeriodicSolver orbit(system, observing({0}));
      SteadyResponse r, exact;
      solver.solve(excitation_of(system), SteadyStart::unloaded, r);
      orbit.solve(excitation_of(system), SteadyStart::unloaded, exact);
      ASSERT_EQ(exact.status, SteadyStatus::converged);
      EXPECT_EQ(r.status, SteadyStatus::converged);
      EXPECT_NEAR(r.amplitude[0], exact.amplitude[0], (r.error + 1e-9) * exact.amplitude[0]);
      EXPECT_LE(r.error, 1e-3);
    }
}

// J. P. Den Hartog, Trans. ASME 53 (1931) APM-107: one mass without damping under Coulomb friction L that never sticks,
// with b = w/omega_n: X = (f/k) sqrt(V^2 - (L/f)^2 U^2), V = 1/(1 - b^2), U = sin(pi/b)/(b (1 + cos(pi/b))).
TEST(HarmonicBalance, TakesRigidCoulombFriction) {
  for (const double stiffness : {1e6, 1e9, 1e15})
    for (const double w : {0.8, 1.5}) {
      const double limit = 0.3, v = 1.0 / (1.0 - w * w), angle = std::numbers::pi / w,
                   u = std::sin(angle) / (w * (1.0 + std::cos(angle)));
      const auto system = rubbing_mass(stiffness, limit, w, 0.0);
      HarmonicBalanceSolver solver(system, observing({0}));
      SteadyResponse r;
      solver.solve(excitation_of(system), SteadyStart::unloaded, r);
      EXPECT_EQ(r.status, SteadyStatus::converged) << stiffness << " " << w;
      const double exact = std::sqrt(v * v - limit * limit * u * u);
      EXPECT_NEAR(r.amplitude[0], exact, 1e-3 * exact) << stiffness << " " << w;
    }
}

// Where more orders would be needed than there may be, what comes back is the balance of those there are: its equations
// hold, so do its works, and its error says how far it is off.
TEST(HarmonicBalance, NeverAnswersWithAStageOfAContinuation) {
  const auto system = rubbing_mass(1e6, 0.8, 0.3, 0.1);
  HarmonicBalanceSolver solver(system, observing({0}), {.tolerance = 1e-3, .most_harmonics = 31});
  SteadyResponse r;
  solver.solve(excitation_of(system), SteadyStart::previous, r);
  EXPECT_EQ(r.status, SteadyStatus::not_converged);
  EXPECT_LT(r.residual, 1e-9);
  expect_balance(r);
  EXPECT_NEAR(r.amplitude[0], 0.550929, r.error * 0.550929);  // by the periodic orbit
  EXPECT_LT(r.error, 0.5);
}

// A frame of five storeys with a damper in each, 200 times as stiff as its columns: what one point leaves is no start
// for the next, which has another pattern of stick and slip. Along the line each point is found as by itself.
TEST(HarmonicBalance, IsNoWorseAlongALineThanPointByPoint) {
  const Index n = 5;
  Matrix m = Matrix::Identity(n, n), k = Matrix::Zero(n, n);
  std::vector<model::Slider> sliders;
  std::vector<system::LoadTerm> loads;
  for (Index i = 0; i < n; ++i) {
    const Index below = i == 0 ? ground : i - 1;
    k(i, i) += 100.0;
    if (i > 0) {
      k(i - 1, i - 1) += 100.0;
      k(i, i - 1) = k(i - 1, i) = -100.0;
    }
    sliders.push_back({"s" + std::to_string(i), i, below, 2e4, 2.4 * (1.05 - 0.15 * static_cast<double>(i))});
    loads.push_back(testing::harmonic(i, 1.0, 4.0));
  }
  const auto system = structure(m, 1e-3 * k, k, sliders, loads);
  HarmonicBalanceSolver line(system, observing({4, 0}));
  system::Excitation excitation = excitation_of(system);
  for (int i = 0; i < 10; ++i) {
    excitation.angular_frequency = 4.0 + 0.1 * i;
    SteadyResponse along, alone;
    line.solve(excitation, SteadyStart::unloaded, along);
    HarmonicBalanceSolver point(system, observing({4, 0}));
    point.solve(excitation, SteadyStart::unloaded, alone);
    ASSERT_EQ(alone.status, SteadyStatus::converged) << i;
    ASSERT_EQ(along.status, SteadyStatus::converged) << i;
    EXPECT_NEAR(along.amplitude[0], alone.amplitude[0], (along.error + alone.error + 1e-9) * alone.amplitude[0]) << i;
    // What is tried in vain with what the point before left, and no more.
    EXPECT_LE(along.iterations, alone.iterations + 200) << i;
  }
}

// A mass that only a slider ties to the ground has no static stiffness of its own: it rests where the slider leaves it.
TEST(HarmonicBalance, TakesAStructureThatOnlySlidersHold) {
  Matrix m(1, 1), c(1, 1), k(1, 1);
  m << 1.0;
  c << 0.1;
  k << 0.0;
  const auto system = structure(m, c, k, {{"s", 0, ground, 4.0, 0.5}},
                                {testing::harmonic(0, 0.3, 1.0), testing::harmonic(0, 0.1, 0.0)});
  const SteadyResponse r = respond(system, observing({0}));
  // It sticks: x = 0.1 / 4 + Re(0.3 / (4 - 1 + 0.1 i) exp(i t)).
  EXPECT_EQ(r.transitions, 0);
  EXPECT_NEAR(r.mean[0], 0.025, 1e-12);
  EXPECT_NEAR(r.amplitude[0], 0.3 / std::hypot(3.0, 0.1), 1e-12);
}

TEST(HarmonicBalance, GivesTheWaveformOfItsResponse) {
  const auto system = awkward(0.3);
  SteadyRequest request = observing({1});
  HarmonicBalanceSolver solver(system, request, {.tolerance = 1e-5, .most_harmonics = 201});
  SteadyResponse r;
  solver.solve(excitation_of(system), SteadyStart::unloaded, r);
  const Waveform wave = solver.waveform(2000);
  EXPECT_NEAR(0.5 * (wave.position.row(1).maxCoeff() - wave.position.row(1).minCoeff()), r.amplitude[0], 1e-5);
  // The area of the loop by the trapezoidal rule, h^2 at its kinks: (2 pi / 2000)^2 of the loop.
  for (Index j = 0; j < 3; ++j) {
    double area = 0.0;
    for (Index p = 0; p < 2000; ++p) {
      const Index next = (p + 1) % 2000;
      area += 0.5 * (wave.slider_force(j, p) + wave.slider_force(j, next)) *
              (wave.displacement(j, next) - wave.displacement(j, p));
    }
    EXPECT_NEAR(area, r.dissipated[j], 1e-4 * (1e-2 + r.dissipated[j]));
  }
}

// The chain has more unknowns than are solved without preconditioner: what that remembers must go as well.
TEST(HarmonicBalance, AnswersAlikeAfterForgetting) {
  const auto few = awkward(0.3), many = testing::chain(40, 8, 0.5);
  for (const system::LocallyNonlinear* system : {&few, &many}) {
    HarmonicBalanceSolver solver(*system, observing({0, 1, 2}));
    system::Excitation excitation = excitation_of(*system);
    SteadyResponse first, again;
    solver.solve(excitation, SteadyStart::unloaded, first);
    excitation.angular_frequency *= 0.9;
    solver.solve(excitation, SteadyStart::unloaded, again);
    solver.forget();
    solver.solve(excitation_of(*system), SteadyStart::unloaded, again);
    EXPECT_EQ(first.amplitude, again.amplitude);
    EXPECT_EQ(first.error, again.error);
  }
}

// Twenty sliders with some twenty orders each are solved by preconditioned products; the periodic orbit knows no
// orders.
TEST(HarmonicBalance, AgreesWithTheOrbitWhereManySlidersSlip) {
  const auto system = testing::chain(40, 20, 0.3);
  const SteadyRequest request = observing({13, 20, 39});
  const SteadyResponse r = respond(system, request, 1e-3);
  PeriodicSolver solver(system, request);
  SteadyResponse orbit;
  solver.solve(excitation_of(system), SteadyStart::unloaded, orbit);
  ASSERT_EQ(orbit.status, SteadyStatus::converged);
  EXPECT_GT(r.slip_share.minCoeff(), 0.0);
  expect_balance(r);
  const double largest = orbit.amplitude.maxCoeff();
  for (Index i = 0; i < 3; ++i) EXPECT_NEAR(r.amplitude[i], orbit.amplitude[i], 1e-3 * largest);
}

}  // namespace
}  // namespace rubato::steady
