#include <rubato/integrate/exact/exact_flow.hpp>

#include "support/models.hpp"

#include <rubato/core/error.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace rubato::integrate {
namespace {

struct Trace final : ExactVisitor {
  bool sample(const system::State& state, const ExactWork& w) override {
    samples.push_back(state);
    work.push_back(w);
    return true;
  }
  bool transition(const system::State&, const Transition& transition, const ExactWork&) override {
    transitions.push_back(transition);
    return true;
  }
  std::vector<system::State> samples;
  std::vector<ExactWork> work;
  std::vector<Transition> transitions;
};

Trace run(const system::LocallyNonlinear& system, double t_end, const std::vector<double>& times,
          bool with_work = false) {
  ExactFlow flow(system);
  system::State state = system.start();
  Trace trace;
  const ExactReport report = flow.advance(state, t_end, times, trace, with_work);
  EXPECT_EQ(report.end, ExactEnd::reached);
  EXPECT_EQ(state.t, t_end);
  EXPECT_EQ(report.transitions, static_cast<long>(trace.transitions.size()));
  return trace;
}

std::vector<double> evenly(double from, double to, int intervals) {
  std::vector<double> times;
  for (int i = 0; i <= intervals; ++i) times.push_back(from + (to - from) * i / intervals);
  return times;
}

// A mass of 1 kg on 1 N/m under 1 N up to 4.3 s, where a table ends and zero follows: x = 1 - cos t, then a free
// vibration. It was wrong by 1.4 m of 2 m.
TEST(ExactFlow, LetsALoadJumpToZeroWhereItsTableEnds) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.damping = SparseMatrix(1, 1);
  parts.loads = system::Loads({{{0}, {1.0}, model::TableLaw{{0.0, 4.3}, {1, 1}, model::TableLaw::Beyond::zero, ""}}});
  parts.coordinates = {"x"};
  const system::LocallyNonlinear system(std::move(parts));
  const Trace trace = run(system, 10.0, evenly(0.0, 10.0, 20));
  for (const system::State& state : trace.samples)
    EXPECT_NEAR(state.q[0], 1.0 - std::cos(state.t) - (state.t < 4.3 ? 0.0 : 1.0 - std::cos(state.t - 4.3)), 1e-12);
}

// cos(w t) and 83,000 rad: 41,500 pieces, each with an error of some round-off, here four. Their times were rounded and
// their motion was not, which added up to 5e-8.
TEST(ExactFlow, KeepsThePhaseOverThousandsOfPieces) {
  constexpr double frequency = 83000.0;
  system::LocallyNonlinear::Parts parts;
  parts.mass = testing::sparse(Matrix::Identity(1, 1));
  parts.stiffness = testing::sparse(Matrix::Constant(1, 1, frequency * frequency));
  parts.damping = SparseMatrix(1, 1);
  parts.coordinates = {"x"};
  parts.start.q = Vector::Ones(1);
  parts.start.v = Vector::Zero(1);
  const system::LocallyNonlinear system(std::move(parts));
  const Trace trace = run(system, 1.0, {0.25, 0.5, 0.75, 1.0});
  for (const system::State& state : trace.samples)
    EXPECT_NEAR(state.q[0], std::cos(frequency * state.t), 0.5 * frequency * 4.0 * 2.2e-16) << state.t;
}

// Reference page, section 3, 40 digits; the checkpoints to 1e-10 of values of order 1.
TEST(ExactFlow, MeetsTheCheckpointsOfTheSingleMassWithASlider) {
  struct Checkpoint {
    double t, x, v, force;
  };
  const std::vector<Checkpoint> checkpoints{{1, 0.2028146530155483, 0.06934133830372177, 0.15},
                                            {2, -0.1348506464741284, -0.5546559867268541, -0.15},
                                            {5, 0.07972505716027838, -0.5658370273852997, -0.06150578283015906},
                                            {10, 0.09491237514468493, 0.5512402999421081, 0.15},
                                            {20, 0.2928231093790903, 0.05794934551597896, 0.15}};
  std::vector<double> times;
  for (const auto& c : checkpoints) times.push_back(c.t);
  const Trace trace = run(testing::single_mass(0.15), 50.0, times);
  ASSERT_EQ(trace.samples.size(), checkpoints.size());
  for (std::size_t i = 0; i < checkpoints.size(); ++i) {
    EXPECT_NEAR(trace.samples[i].q[0], checkpoints[i].x, 1e-12) << checkpoints[i].t;
    EXPECT_NEAR(trace.samples[i].v[0], checkpoints[i].v, 1e-12) << checkpoints[i].t;
    EXPECT_NEAR(trace.samples[i].slider_force[0], checkpoints[i].force, 1e-12) << checkpoints[i].t;
  }
  EXPECT_NEAR(trace.transitions.front().t, 0.69961448285324, 1e-13);
  EXPECT_EQ(trace.transitions.size(), 64u);
}

// Reference page, section 3: per period in the steady state (from t = 100 on: exp(-0.5 t) of the transient is 1e-22).
TEST(ExactFlow, MeetsTheWorkPerPeriodOfTheSingleMassWithASlider) {
  const double period = std::numbers::pi, start = 32 * period;
  const auto times = evenly(start, start + period, 4096);
  const Trace trace = run(testing::single_mass(0.15), start + period, times, true);
  const ExactWork &a = trace.work.front(), &b = trace.work.back();
  EXPECT_NEAR(b.slider - a.slider, 0.0865525248542252, 1e-11);
  EXPECT_NEAR(b.damper - a.damper, 0.543603660209531, 1e-11);
  EXPECT_NEAR(b.load - a.load, 0.630156185063756, 1e-11);
  // Half peak to peak: the largest sample, corrected by the parabola through it (error h^4 = 1e-13).
  double largest = 0.0;
  for (const auto& state : trace.samples) {
    const double acceleration = std::cos(2.0 * state.t) - state.v[0] - state.q[0] - state.slider_force[0];
    largest = std::max(largest, state.q[0] - 0.5 * state.v[0] * state.v[0] / acceleration *
                                                 (std::abs(state.v[0]) < 1e-3 && acceleration < 0.0 ? 1.0 : 0.0));
  }
  EXPECT_NEAR(largest, 0.2942542080903754, 1e-10);
}

// Reference page, section 4, table of the transient: 14 digits, to 1e-9 as an absolute error of values up to 6.
TEST(ExactFlow, MeetsTheCheckpointsOfTheUnderPlatformDamper) {
  const Trace trace = run(testing::damper_model(), 20.0, {1.0, 5.0, 20.0});
  const double expected[3][4] = {{-0.029680504974954, 0.30791720111048, -6.4107969232704, 0.79641059552489},
                                 {0.017150203594007, -0.5425940743629, -1.4764180118269, -5},
                                 {0.019759059662894, -0.30503353525048, -4.3666849544964, -3.3678520252846}};
  for (std::size_t i = 0; i < 3; ++i) {
    const system::State& state = trace.samples[i];
    EXPECT_NEAR(state.q[0], expected[i][0], 1e-12);
    EXPECT_NEAR(state.q[1], expected[i][1], 1e-12);
    EXPECT_NEAR(state.v[1], expected[i][2], 1e-11);
    EXPECT_NEAR(state.slider_force[0], expected[i][3], 1e-11);
    EXPECT_NEAR(state.q[2], -state.q[0], 1e-13);
    EXPECT_NEAR(state.q[3], -state.q[1], 1e-13);
    EXPECT_NEAR(state.q[4], 0.0, 1e-13);
  }
}

// Reference page, section 4: steady amplitudes at 10 rad/s, 12 digits. The slowest transient has died by exp(-0.06 *
// 400). The turning point of the cubic between two of 2048 samples a period leaves h^4/384 of the fourth derivative:
// 1e-12.
TEST(ExactFlow, MeetsTheSteadyAmplitudesOfTheUnderPlatformDamper) {
  const double period = 2.0 * std::numbers::pi / 10.0, start = 640.0 * period;
  const Trace trace = run(testing::damper_model(), start + 1.01 * period, evenly(start, start + 1.01 * period, 2068));
  const auto half_peak_to_peak = [&](Index i) {
    double high = -1e9, low = 1e9;
    for (std::size_t k = 1; k < trace.samples.size(); ++k) {
      const system::State &a = trace.samples[k - 1], &b = trace.samples[k];
      if (a.v[i] * b.v[i] > 0.0) continue;
      const double s = a.v[i] / (a.v[i] - b.v[i]), h = b.t - a.t;
      const double q =
          a.q[i] + (b.q[i] - a.q[i]) * s * s * (3 - 2 * s) + h * s * (1 - s) * (a.v[i] * (1 - s) - b.v[i] * s);
      high = std::max(high, q);
      low = std::min(low, q);
    }
    return 0.5 * (high - low);
  };
  EXPECT_NEAR(half_peak_to_peak(0), 0.0313777807495, 1e-11);
  EXPECT_NEAR(half_peak_to_peak(1), 0.53295660136, 1e-11);
}

// Undamped at resonance: x'' + x = cos t from rest is x = t sin t / 2, a repeated root of the structure and its load.
TEST(ExactFlow, FollowsAnUndampedResonance) {
  const Trace trace = run(testing::single_mass(0.0, 1.0, 0.0), 40.0, {10.0, 40.0});
  for (const auto& state : trace.samples) EXPECT_NEAR(state.q[0], 0.5 * state.t * std::sin(state.t), 1e-12);
}

// Critically damped (a defective matrix) and overdamped, free from x = 1.
TEST(ExactFlow, FollowsCriticallyDampedAndOverdampedMotion) {
  for (const double c : {2.0, 20.0}) {
    system::LocallyNonlinear::Parts parts;
    parts.mass = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
    parts.damping = testing::sparse(c * Matrix::Identity(1, 1));
    parts.start.q = Vector::Ones(1);
    parts.coordinates = {"x"};
    const system::LocallyNonlinear system(std::move(parts));
    for (const auto& state : run(system, 8.0, {1.0, 8.0}).samples) {
      const double t = state.t, a = 0.5 * c, d = std::sqrt(a * a - 1.0), r1 = -a + d, r2 = -a - d;
      const double x =
          c == 2.0 ? (1.0 + t) * std::exp(-t) : (r1 * std::exp(r2 * t) - r2 * std::exp(r1 * t)) / (r1 - r2);
      EXPECT_NEAR(state.q[0], x, 1e-14) << c;
    }
  }
}

system::LocallyNonlinear random_model(std::mt19937& random) {
  std::uniform_real_distribution<double> one(0.2, 2.0), any(-1.0, 1.0);
  const Index n = 2 + static_cast<Index>(random() % 7), m = 1 + static_cast<Index>(random() % 5);
  system::LocallyNonlinear::Parts parts;
  Matrix k = Matrix::Zero(n, n), mass = Matrix::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    mass(i, i) = one(random);
    const double stiffness = 10.0 * one(random);
    k(i, i) += stiffness;
    if (i > 0) k(i - 1, i - 1) += stiffness, k(i, i - 1) -= stiffness, k(i - 1, i) -= stiffness;
  }
  parts.mass = testing::sparse(mass);
  parts.stiffness = testing::sparse(k);
  parts.damping = testing::sparse(0.005 * k + 0.02 * mass);
  for (Index j = 0; j < m; ++j) {
    const auto first = static_cast<Index>(random() % static_cast<unsigned>(n));
    auto second = static_cast<Index>(random() % static_cast<unsigned>(n + 1)) - 1;
    if (second == first) second = ground;
    parts.sliders.push_back({"s" + std::to_string(j), first, second, 5.0 * one(random), 0.5 * one(random)});
  }
  std::vector<system::LoadTerm> loads{testing::harmonic(0, 0.5 * any(random), 0.0)};  // a static load
  for (int i = 0; i < 3; ++i)
    loads.push_back(testing::harmonic(static_cast<Index>(random() % static_cast<unsigned>(n)), 2.0 * any(random),
                                      2.0 * one(random), 3.0 * any(random)));
  parts.loads = system::Loads(std::move(loads));
  for (Index i = 0; i < n; ++i) parts.coordinates.push_back("x" + std::to_string(i));
  return system::LocallyNonlinear(std::move(parts));
}

double energy(const system::LocallyNonlinear& system, const system::State& state) {
  double sum = 0.5 * state.v.dot(system.mass() * state.v) + 0.5 * state.q.dot(system.stiffness() * state.q);
  for (Index i = 0; i < system.slider_count(); ++i)
    sum +=
        0.5 * state.slider_force[i] * state.slider_force[i] / system.sliders()[static_cast<std::size_t>(i)].stiffness;
  return sum;
}

// Sliders share coordinates, loads have any phases; the balance holds to the round-off of some thousand pieces.
TEST(ExactFlow, BalancesTheEnergyOfRandomModels) {
  std::mt19937 random(20261);
  long transitions = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto system = random_model(random);
    const Trace trace = run(system, 60.0, {60.0}, true);
    transitions += static_cast<long>(trace.transitions.size());
    const ExactWork& w = trace.work.back();
    EXPECT_GT(w.slider, -1e-14);
    EXPECT_NEAR(energy(system, trace.samples.back()) + w.damper + w.slider, w.load, 1e-11 * std::max(1.0, w.damper))
        << trial;
    for (Index i = 0; i < system.slider_count(); ++i)
      EXPECT_LE(std::abs(trace.samples.back().slider_force[i]), system.sliders()[static_cast<std::size_t>(i)].limit);
  }
  EXPECT_GT(transitions, 3000);
}

// Where it looks, and where it was stopped and started again, does not move it but by round-off.
TEST(ExactFlow, DoesNotDependOnSamplesNorOnRestarts) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 20; ++trial) {
    const auto system = random_model(random);
    const Trace once = run(system, 30.0, {30.0}), often = run(system, 30.0, evenly(0.0, 30.0, 1000));
    system::State state = system.start();
    Trace parts;
    for (const double t : {7.3, 11.1, 30.0}) {
      ExactFlow flow(system);
      flow.advance(state, t, {}, parts);
    }
    EXPECT_LT((once.samples.back().q - often.samples.back().q).norm(), 1e-11) << trial;
    EXPECT_LT((once.samples.back().q - state.q).norm(), 1e-11) << trial;
    EXPECT_EQ(once.transitions.size(), parts.transitions.size()) << trial;
  }
}

// The flow depends on its start continuously, also where sliders at their limits are about to turn: with rates of 1e-16
// to 1e-9, inward or outward, it does what it does with none, to the size of the rate. The blades' displacements are
// fifty times the sliders', so that these rates pass through the round-off of the one and of the other. What the flow
// makes of a change is bounded by the energy in it: 1 m/s of a blade to 4 m/s, 0.4 m and 4 N. Round-off: 1e-12.
TEST(ExactFlow, DependsContinuouslyOnTheRatesAtWhichSlidersTurn) {
  const auto system = testing::damper_model(1.0, 7.375);
  ExactFlow flow(system);
  const auto end = [&](double q, double first_rate, double second_rate) {
    system::State state = system.start();
    state.q << 0.0, q, 0.0, -q, 0.0;
    state.v << 0.0, first_rate, 0.0, second_rate, 0.0;
    state.slider_force << std::copysign(0.5, q), -std::copysign(0.5, q);
    Trace trace;
    EXPECT_EQ(flow.advance(state, 3.0, {}, trace).end, ExactEnd::reached) << q << ' ' << first_rate;
    return state;
  };
  for (int k = 0; k < 20; ++k) {  // forces round up and down
    const double q = (k % 2 == 0 ? 2.5 : -2.5) + 0.0237 * k;
    const system::State still = end(q, 0.0, 0.0);
    for (double rate = 1e-16; rate < 1e-9; rate *= 3.0)
      for (const auto& [first, second] : {std::pair{rate, 0.0}, {-rate, 0.0}, {rate, -0.1 * rate}, {rate, rate}}) {
        const system::State moving = end(q, first, second);
        EXPECT_LT((moving.q - still.q).norm(), 1e-12 + rate) << q << ' ' << first << ' ' << second;
        EXPECT_LT((moving.v - still.v).norm(), 1e-11 + 8.0 * rate) << q << ' ' << first << ' ' << second;
        EXPECT_LT((moving.slider_force - still.slider_force).norm(), 1e-11 + 8.0 * rate) << q << ' ' << first;
      }
  }
}

// Opposite forces on two sectors, and equal sliders between: both turn at one instant but for round-off, and the damper
// stays at rest.
TEST(ExactFlow, TurnsSymmetricalSlidersTogether) {
  for (const double normal_load : {0.1, 1.2452, 7.0, 20.0}) {
    const auto system = testing::damper_model(normal_load, 7.375);
    const Trace trace = run(system, 200.0, {200.0});
    EXPECT_NEAR(trace.samples[0].q[4], 0.0, 1e-11);
    EXPECT_NEAR(trace.samples[0].q[1], -trace.samples[0].q[3], 1e-11);
    EXPECT_EQ(trace.transitions.size() % 2, 0u);
    for (std::size_t i = 0; i + 1 < trace.transitions.size(); i += 2)
      ASSERT_NEAR(trace.transitions[i].t, trace.transitions[i + 1].t, 1e-10);
  }
}

TEST(ExactFlow, RefusesFormulasOfTimeAndLargeModels) {
  EXPECT_THROW(ExactFlow{testing::chain(301, 1)}, InvalidInput);
  system::LocallyNonlinear::Parts parts;
  parts.mass = parts.damping = parts.stiffness = testing::sparse(Matrix::Identity(1, 1));
  parts.loads = system::Loads({{{0}, {1.0}, model::FormulaLaw{numerics::Formula("exp(-t)", {}, true)}}});
  const system::LocallyNonlinear system(std::move(parts));
  EXPECT_THROW(ExactFlow{system}, InvalidInput);
}

}  // namespace
}  // namespace rubato::integrate
