#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_space.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>
#include <rubato/model/joints/plane_joints.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace rubato {
namespace {

using namespace integrate;

/// A bar of 1 kg and 1 m, hung level by `hinges` pins through one hole.
model::Mechanism hung_bar(int hinges) {
  model::Mechanism m(2);
  const Index bar = m.add_node("bar", {0.5, 0.0, 0.0});
  m.add_mass(bar, 1.0, 1.0 / 12.0);
  for (int i = 0; i < hinges; ++i)
    m.joints.push_back(model::make_plane_revolute("hinge " + std::to_string(i + 1), m.plane_point(0, 0.0, 0.0),
                                                  m.plane_point(bar, 0.0, 0.0)));
  m.gravity = {0.0, -9.81, 0.0};
  return m;
}

system::State marched(const system::Mechanism& mechanism, double h, double end, NewtonPlan newton = {}) {
  const auto method = make_method("generalized_alpha", {{"rho_inf", 0.9}});
  const auto stepper = make_stepper(method, mechanism, newton);
  system::MechanismEquations equations(mechanism);
  system::State state = make_consistent(equations, mechanism.start()).state;
  shift_acceleration(equations, state, stepper->shift() * h);
  const auto report = march(*stepper, state, h, end);
  EXPECT_EQ(report.end, MarchEnd::reached);
  return state;
}

TEST(RedundantConstraints, AreFoundAndTheOthersAreNot) {
  const system::Mechanism single(hung_bar(1)), twofold(hung_bar(2));
  system::MechanismEquations of_single(single), of_twofold(twofold);
  EXPECT_TRUE(make_consistent(of_single, single.start()).redundant.empty());
  const auto start = make_consistent(of_twofold, twofold.start());
  EXPECT_TRUE(start.is_consistent);
  ASSERT_EQ(start.redundant.size(), 2u);
  // One hinge's worth, of either hinge.
  EXPECT_NE(twofold.rows()[std::size_t(start.redundant[0])].back(),
            twofold.rows()[std::size_t(start.redundant[1])].back());
}

TEST(RedundantConstraints, ShareTheLoadWithTheLeastReactionsAndMoveTheSame) {
  const system::Mechanism single(hung_bar(1)), twofold(hung_bar(2));
  const system::State one = marched(single, 1e-3, 2.0), two = marched(twofold, 1e-3, 2.0);
  // The share of 1e-10 of the multipliers in the constraints moves positions by as much of a step's correction.
  EXPECT_LT((one.q - two.q).cwiseAbs().maxCoeff(), 1e-8);
  for (Index i = 0; i < 2; ++i) {
    EXPECT_NEAR(two.multiplier[i], 0.5 * one.multiplier[i], 1e-5);
    EXPECT_NEAR(two.multiplier[i + 2], 0.5 * one.multiplier[i], 1e-5);
  }
}

TEST(RedundantConstraints, AreToldApartFromContradictions) {
  model::Mechanism m = hung_bar(1);
  const Index bar = 1;
  for (const double length : {0.8, 0.9})
    m.joints.push_back(model::make_plane_distance("link " + std::to_string(length).substr(0, 3),
                                                  m.plane_point(0, 1.0, 0.8), m.plane_point(bar, 1.0, 0.0), length));
  const system::Mechanism mechanism(std::move(m));
  system::MechanismEquations equations(mechanism);
  const auto start = make_consistent(equations, mechanism.start());
  EXPECT_FALSE(start.is_consistent);
  EXPECT_GT(start.gap, 0.01);
  EXPECT_FALSE(start.redundant.empty());
}

/// Windows of rods of 1 m and 1 kg side by side (IFToMM library of computational benchmark problems, "N-four-bar"):
/// upright at the start, their upper corners moving at 1 m/s.
model::Mechanism windows(int count) {
  model::Mechanism m(2);
  std::vector<Index> upright, level;
  for (int i = 0; i <= count; ++i) {
    upright.push_back(m.add_node("upright " + std::to_string(i), {double(i), 0.5, 0.5 * std::numbers::pi}));
    m.add_mass(upright.back(), 1.0, 1.0 / 12.0);
    auto& velocity = m.nodes[std::size_t(upright.back())].velocity;
    velocity[0] = 0.5;
    velocity[5] = -1.0;
  }
  for (int i = 0; i < count; ++i) {
    level.push_back(m.add_node("level " + std::to_string(i), {i + 0.5, 1.0, 0.0}));
    m.add_mass(level.back(), 1.0, 1.0 / 12.0);
    m.nodes[std::size_t(level.back())].velocity[0] = 1.0;
  }
  const auto pin = [&](Index a, Index b, double x, double y) {
    m.joints.push_back(model::make_plane_revolute("pin " + std::to_string(m.joints.size()), m.plane_point(a, x, y),
                                                  m.plane_point(b, x, y)));
  };
  for (int i = 0; i <= count; ++i) pin(0, upright[std::size_t(i)], i, 0.0);
  for (int i = 0; i < count; ++i) {
    pin(upright[std::size_t(i)], level[std::size_t(i)], i, 1.0);
    pin(level[std::size_t(i)], upright[std::size_t(i) + 1], i + 1.0, 1.0);
  }
  m.gravity = {0.0, -9.81, 0.0};
  return m;
}

/// Turn of the uprights: they stay parallel, so that the windows are one pendulum. RK4 with steps of 1e-5 s: 1e-15.
double turn_of_windows(int count, double end) {
  const double n = count, inertia = (n + 1.0) / 3.0 + n, weight = 9.81 * (0.5 * (n + 1.0) + n);
  const auto slope = [&](double turn) { return weight / inertia * std::sin(turn); };
  const int steps = int(std::lround(end / 1e-5));
  const double h = end / steps;
  double a = 0.0, w = 1.0;
  for (int i = 0; i < steps; ++i) {
    const double k1 = slope(a), k2 = slope(a + 0.5 * h * w), k3 = slope(a + 0.5 * h * (w + 0.5 * h * k1));
    const double k4 = slope(a + h * (w + 0.5 * h * k2));
    a += h * (w + h / 6.0 * (k1 + k2 + k3));
    w += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return a;
}

TEST(FourBars, PassTheirSingularPositionsAndStayAPendulum) {
  for (const int count : {1, 2, 5}) {
    const system::Mechanism mechanism(windows(count));
    double last = 0.0;
    for (const double h : {2e-3, 1e-3}) {
      const system::State state = marched(mechanism, h, 10.0);
      const double turn = turn_of_windows(count, 10.0);
      const double error = std::abs(0.5 * std::numbers::pi - turn - state.q[5]);
      EXPECT_LT(error, 3e3 * h * h) << count << " windows, h = " << h;
      if (last > 0.0) {
        EXPECT_NEAR(last / error, 4.0, 0.8) << count;
      }
      last = error;
    }
  }
}

/// Two windows whose uprights stand at an angle from the line of the hinges and turn by -5 rad/s.
system::State windows_near_line(const system::Mechanism& mechanism, double angle) {
  system::State state = mechanism.start();
  const double c = std::cos(angle), s = std::sin(angle), rate = -5.0;
  for (Index bar = 0; bar < 5; ++bar) {
    const bool is_upright = bar < 3;
    const double at = double(is_upright ? bar : bar - 3), reach = is_upright ? 0.5 : 1.0;
    state.q.segment<3>(3 * (bar + 1)) << at + (is_upright ? 0.0 : 0.5) + reach * c, reach * s, is_upright ? angle : 0.0;
    state.v.segment<3>(3 * bar) << -reach * s * rate, reach * c * rate, is_upright ? rate : 0.0;
  }
  system::MechanismEquations equations(mechanism);
  const ConsistentStart start = make_consistent(equations, state);
  EXPECT_TRUE(start.is_consistent);
  EXPECT_LT(start.position_moved, 1e-12);
  return start.state;
}

TEST(FourBars, EndNoStepInLineWhereThatIsAvoided) {
  const system::Mechanism mechanism(windows(2));
  const auto method = make_method("generalized_alpha", {{"rho_inf", 0.9}});
  NewtonPlan plan;
  const auto plain = make_stepper(method, mechanism, plan);
  plan.avoids_singular_ends = true;
  const auto careful = make_stepper(method, mechanism, plan);
  const system::State from = windows_near_line(mechanism, 1e-3);
  double h = 2e-4;
  system::State to = from;
  // The angle falls almost evenly: each correction of the step leaves a hundredth and less of the last.
  for (int i = 0; i < 4; ++i) {
    ASSERT_EQ(plain->attempt(from, h, h, to).outcome, StepOutcome::accepted);
    h += (to.q[5] - 1e-6) / 5.0;
  }
  EXPECT_EQ(plain->attempt(from, h, h, to).outcome, StepOutcome::accepted);
  EXPECT_EQ(careful->attempt(from, h, h, to).outcome, StepOutcome::singular);
  for (const double other : {0.5 * h, 1.5 * h}) {
    ASSERT_EQ(careful->attempt(from, other, other, to).outcome, StepOutcome::accepted);
    EXPECT_NEAR(to.q[8], to.q[5], 1e-9) << "the uprights are parallel";
  }
}

TEST(FourBars, PassTheirSingularPositionsWithStepsThatChooseThemselves) {
  const system::Mechanism mechanism(windows(2));
  const auto method = make_method("generalized_alpha", {{"rho_inf", 0.9}});
  NewtonPlan newton;
  newton.projects_velocities = newton.avoids_singular_ends = true;
  const auto stepper = make_stepper(method, mechanism, newton);
  system::MechanismEquations equations(mechanism);
  const double turn = turn_of_windows(2, 10.0);
  for (const double tolerance :
       {3.2186073460081994e-6, 1.0902536648152616e-6}) {  // two of which some step would end in line to 1e-6 rad
    system::State state = make_consistent(equations, mechanism.start()).state;
    const auto estimator = make_estimator(LocalError{tolerance}, std::get<GeneralizedAlpha>(method.formula),
                                          make_error_space(mechanism, state, tolerance), state, 10.0);
    StepPlan plan;
    plan.smallest = 1e-11;
    plan.largest = 0.2;
    MechanismTimeline timeline(mechanism, 1e-11);
    const auto report = march(*stepper, *estimator, plan, timeline, state, 10.0);
    EXPECT_EQ(report.march.end, MarchEnd::reached) << tolerance;
    EXPECT_LT(std::abs(0.5 * std::numbers::pi - turn - state.q[5]), 3e3 * std::pow(report.largest_step, 2));
  }
}

TEST(FourBars, KeepTheirEnergyOverTenSeconds) {
  const system::Mechanism mechanism(windows(2));
  const system::State state = marched(mechanism, 1e-3, 10.0);
  Vector product;
  mechanism.times_mass(state.v, product);
  double energy = 0.5 * state.v.dot(product);
  for (Index node = 1; node <= 5; ++node) energy += 9.81 * state.q[3 * node + 1];
  const double start = 0.5 * (3.0 / 3.0 + 2.0) + 9.81 * (1.5 + 2.0);
  EXPECT_NEAR(energy, start, 0.1);  // of 34 J that go to and fro; a crossing on the wrong branch is far off
}

}  // namespace
}  // namespace rubato
