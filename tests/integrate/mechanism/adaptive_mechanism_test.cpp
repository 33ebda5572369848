#include <rubato/integrate/adaptive_march.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/constrained_space.hpp>
#include <rubato/integrate/constrained/constrained_stepper.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <support/double_pendulum.hpp>
#include <support/locking_bars.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace rubato {
namespace {

using namespace integrate;

/// A march with the paper's settings, and what was seen on the way.
struct Seen final : Observer {
  std::function<void(const system::State&, const system::State&)> look;
  bool accepted(const system::State& before, const system::State& after) override {
    if (look) look(before, after);
    return true;
  }
};

struct March {
  system::State state;
  AdaptiveReport report;
  std::vector<LockEvent> events;
};

March march_paper(const system::Mechanism& mechanism, double tolerance, double first, double end,
                  Seen* seen = nullptr) {
  const auto method = make_method("hht", {{"alpha", -0.15}});
  const auto& alpha = std::get<GeneralizedAlpha>(method.formula);
  const auto stepper = make_stepper(method, mechanism);
  system::MechanismEquations equations(mechanism);
  March result;
  const auto start = make_consistent(equations, mechanism.start());
  EXPECT_TRUE(start.is_consistent);
  result.state = start.state;
  const auto estimator = make_estimator(InertiaJump{tolerance, mechanism.reference(), true}, alpha,
                                        make_error_space(mechanism, result.state, tolerance), result.state, end);
  StepPlan plan;
  plan.controller = CardonaCassano{};
  plan.first = first;
  plan.smallest = 1e-12;
  plan.rebuild = false;
  plan.locate_events = true;
  MechanismTimeline timeline(mechanism, 1e-12 * end);
  result.report = march(*stepper, *estimator, plan, timeline, result.state, end, seen);
  result.events = timeline.events();
  EXPECT_EQ(result.report.march.end, MarchEnd::reached);
  EXPECT_EQ(result.report.failed, 0);
  return result;
}

double pendulum_error(const system::State& state) {
  const auto exact = testing::double_pendulum_at(5.0);
  double largest = 0.0;
  for (int i = 0; i < 4; ++i)
    largest = std::max(largest, std::abs(testing::double_pendulum_position(state, i) - exact[std::size_t(i)]));
  return largest;
}

TEST(AdaptiveDoublePendulum, TakesTheStepsOfThePublishedController) {
  // The replication made no stop at the kinks of the force: 877 steps, none rejected, an error of 1.5e-3 m at most.
  const system::Mechanism mechanism(testing::double_pendulum(false));
  const March run = march_paper(mechanism, 1e-4, 1e-3, 5.0);
  EXPECT_NEAR(double(run.report.march.steps), 877.0, 0.03 * 877.0);
  EXPECT_LE(run.report.rejected, 3);
  EXPECT_LT(pendulum_error(run.state), 2e-3);
}

TEST(AdaptiveDoublePendulum, MeetsTheKinksThatATableTells) {
  const system::Mechanism mechanism(testing::double_pendulum());
  int met = 0;
  Seen seen;
  seen.look = [&](const system::State&, const system::State& after) { met += after.t == 0.5 || after.t == 1.0; };
  const March run = march_paper(mechanism, 1e-4, 1e-3, 5.0, &seen);
  EXPECT_EQ(met, 2);
  EXPECT_LT(pendulum_error(run.state), 2e-3);
}

TEST(AdaptiveDoublePendulum, IsTheMoreExactTheSmallerTheTolerance) {
  // Controlled per step, with a method of second order: the error follows TOL^(2/3), 4.6 a tenth.
  const system::Mechanism mechanism(testing::double_pendulum());
  double last = 0.0;
  for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
    const double error = pendulum_error(march_paper(mechanism, tolerance, 1e-4, 5.0).state);
    if (last > 0.0) {
      EXPECT_GT(last / error, 3.0) << tolerance;
      EXPECT_LT(last / error, 7.0) << tolerance;
    }
    last = error;
  }
}

TEST(AdaptiveDoublePendulum, KeepsToTheToleranceOfTheDefaultControl) {
  const system::Mechanism mechanism(testing::double_pendulum());
  const auto method = make_method("generalized_alpha", {{"rho_inf", 0.9}});
  NewtonPlan newton;
  newton.projects_velocities = true;
  const auto stepper = make_stepper(method, mechanism, newton);
  system::MechanismEquations equations(mechanism);
  double last = 0.0;
  for (const double tolerance : {1e-3, 1e-4}) {
    system::State state = make_consistent(equations, mechanism.start()).state;
    const auto estimator = make_estimator(LocalError{tolerance}, std::get<GeneralizedAlpha>(method.formula),
                                          make_error_space(mechanism, state, tolerance), state, 5.0);
    StepPlan plan;
    plan.smallest = 1e-12;
    plan.largest = 0.1;
    plan.locate_events = true;
    MechanismTimeline timeline(mechanism, 1e-12);
    const auto report = march(*stepper, *estimator, plan, timeline, state, 5.0);
    EXPECT_EQ(report.march.end, MarchEnd::reached);
    // Relative to l/sqrt(m) = sqrt(42/7) m, within the factor of ten that the estimator promises.
    const double error = pendulum_error(state);
    EXPECT_LT(error, 10.0 * tolerance * std::sqrt(6.0));
    if (last > 0.0) {
      EXPECT_GT(last / error, 5.0);  // proportional to the tolerance
    }
    last = error;
  }
}

struct BarsRun {
  March march;
  double angle_at_one = 0.0, largest_angle = 0.0, energy_residue = 0.0, kinetic_at_lock = 0.0, angle_at_end = 0.0;
  double kinetic_before = 0.0, kinetic_after = 0.0;  // of the steps on either side of the lock
};

/// Energy by the work of the drive, 2000 N m, while it acts.
BarsRun run_bars(testing::LockingLaw law, double tolerance) {
  auto bars = testing::locking_bars(law);
  const auto angle = bars.angle;
  const system::Mechanism mechanism(std::move(bars.mechanism));
  system::MechanismEquations equations(mechanism);
  Vector product(mechanism.size());
  BarsRun run;
  double drive_until = HUGE_VAL, work = 0.0;
  const auto kinetic = [&](const system::State& state) {
    mechanism.times_mass(state.v, product);
    return 0.5 * state.v.dot(product);
  };
  Seen seen;
  seen.look = [&](const system::State& before, const system::State& after) {
    const double a = angle.value(before.q.data()), b = angle.value(after.q.data());
    const bool is_engaged = !before.phase.empty() && before.phase[0] != 0;
    const bool is_latched = is_engaged && law != testing::LockingLaw::stop;
    if (!is_latched) work += 2000.0 * (b - a);
    if (is_engaged && drive_until == HUGE_VAL) {
      drive_until = before.t;
      run.kinetic_after = kinetic(before);
    }
    if (drive_until == HUGE_VAL) run.kinetic_before = kinetic(after);
    run.largest_angle = std::max(run.largest_angle, b);
    if (before.t < 1.0 && after.t >= 1.0) {
      const double share = (1.0 - before.t) / (after.t - before.t);  // cubic through angles and rates
      const auto rate = [&](const system::State& s) {
        std::vector<double> padded(std::size_t(mechanism.size()) + 1, 0.0);
        std::copy(s.v.data(), s.v.data() + s.v.size(), padded.begin() + 1);
        return angle.rate({s.t, model::Side::left, s.q.data(), padded.data() + 1, s.phase.data()});
      };
      const double h = after.t - before.t, r = 1.0 - share;
      run.angle_at_one = r * r * ((1.0 + 2.0 * share) * a + share * h * rate(before)) +
                         share * share * ((1.0 + 2.0 * r) * b - r * h * rate(after));
    }
  };
  run.march = march_paper(mechanism, tolerance, 1e-4, 1.6, &seen);
  run.angle_at_end = angle.value(run.march.state.q.data());
  equations.go_to(run.march.state, model::Side::left);
  run.energy_residue = kinetic(run.march.state) + equations.stored_energy() - work;
  return run;
}

// The published settings leave an error of 2.7e-3 rad (stop) and 1.4e-3 rad (latch) after the impact.
TEST(AdaptiveLockingBars, TakeTheStepsOfThePublishedControllerThroughAKinkThatNobodyKnows) {
  const BarsRun run = run_bars(testing::LockingLaw::formula, 1e-4);
  EXPECT_NEAR(double(run.march.report.march.steps), 1617.0, 0.05 * 1617.0);
  EXPECT_NEAR(double(run.march.report.rejected), 52.0, 5.0);
  EXPECT_NEAR(run.angle_at_end, 2.436617153, 2.7e-3);
}

TEST(AdaptiveLockingBars, MeetAnElasticStopAndLeaveIt) {
  const BarsRun run = run_bars(testing::LockingLaw::stop, 1e-4);
  ASSERT_EQ(run.march.events.size(), 2u);
  EXPECT_TRUE(run.march.events[0].has_engaged);
  EXPECT_FALSE(run.march.events[1].has_engaged);
  EXPECT_NEAR(run.march.events[0].t, 1.371521056, 2e-5);
  EXPECT_NEAR(run.march.events[1].t, 1.417882747, 1e-3);
  EXPECT_NEAR(run.angle_at_one, 1.9370165052, 1e-3);
  EXPECT_NEAR(run.largest_angle, 3.15576038, 1e-3);
  EXPECT_NEAR(run.angle_at_end, 2.436617153, 2.7e-3);
  EXPECT_LT(std::abs(run.energy_residue), 8.0);
}

TEST(AdaptiveLockingBars, ConvergeToTheReferenceOnItsMesh) {
  const BarsRun run = run_bars(testing::LockingLaw::stop, 1e-6);
  ASSERT_EQ(run.march.events.size(), 2u);
  EXPECT_NEAR(run.march.events[0].t, 1.371521056, 2e-5);
  EXPECT_NEAR(run.angle_at_one, 1.9370165052, 1e-4);
  EXPECT_NEAR(run.largest_angle, 3.15576038, 1e-4);
  EXPECT_NEAR(run.march.events[1].t, 1.417882747, 1e-4);
  EXPECT_NEAR(run.angle_at_end, 2.436617153, 2e-4);
  EXPECT_NEAR(run.kinetic_before, 4187.6565, 0.5);
}

TEST(AdaptiveLockingBars, LatchAsTheReferenceDoesAndMakeNoEnergy) {
  const BarsRun run = run_bars(testing::LockingLaw::latch, 1e-4);
  EXPECT_NEAR(double(run.march.report.march.steps), 1764.0, 0.05 * 1764.0);
  ASSERT_EQ(run.march.events.size(), 1u);
  EXPECT_NEAR(run.march.events[0].t, 1.371521056, 2e-5);
  EXPECT_NEAR(run.kinetic_before, 4187.6565, 4.0);  // TOL = 1e-4 loses 2 J until then
  EXPECT_NEAR(run.largest_angle, 3.15579837, 1.4e-3);
  EXPECT_NEAR(run.angle_at_end, 3.137850918, 1.5e-3);
  EXPECT_LE(run.energy_residue, 0.0);
  EXPECT_GT(run.energy_residue, -8.0);
}

TEST(AdaptiveLockingBars, MakeNoEnergyAtACoarseToleranceEither) {
  // A latch engaged at the end of a step that overshoots made 18349 J at this tolerance.
  const BarsRun run = run_bars(testing::LockingLaw::latch, 1e-2);
  EXPECT_LT(run.energy_residue, 0.0);
}

TEST(AdaptiveLockingBars, LoseTheEnergyThatARigidLatchTakes) {
  const BarsRun run = run_bars(testing::LockingLaw::rigid_latch, 1e-4);
  ASSERT_EQ(run.march.events.size(), 1u);
  EXPECT_NEAR(run.march.events[0].t, 1.371521056, 2e-5);
  const double lost = run.march.events[0].energy_lost;
  EXPECT_GT(lost, 0.0);
  EXPECT_NEAR(run.kinetic_before - run.kinetic_after, lost, 1e-9 * run.kinetic_before);
  EXPECT_NEAR(run.angle_at_end, std::numbers::pi, 1e-10);
  EXPECT_LT(run.energy_residue + lost, 1e-9 * run.kinetic_before);
}

/// A mass on a slide without spring that runs into a stop.
model::Mechanism slide(bool is_rigid, bool is_latch, double force) {
  model::Mechanism m(2);
  const Index mass = m.add_node("mass", {0.0, 0.0, 0.0});
  m.add_mass(mass, 2.0, 0.1);
  m.nodes[1].velocity[0] = 3.0;
  const auto ground_point = m.plane_point(0, 0.0, 0.0), point = m.plane_point(mass, 0.0, 0.0);
  m.joints.push_back(model::make_plane_prismatic("slide", ground_point, point, {1.0, 0.0}, 0.0));
  model::Lock lock;
  lock.name = "slide";
  model::PlaneCoordinate way;
  way.kind = model::PlaneCoordinate::Kind::displacement;
  way.along = {ground_point, point, {1.0, 0.0}};
  lock.s = way;
  lock.is_latch = is_latch;
  lock.at = 1.5;
  lock.stiffness = is_rigid ? 0.0 : 800.0;
  m.add_lock(lock);
  if (force != 0.0) m.forces.push_back({0, model::TableLaw{{0.0, 2.0, 2.0, 9.0}, {0.0, 0.0, force, force}, {}, ""}});
  m.reference = 2.0;
  return m;
}

TEST(MechanismLocks, ReturnAMassFromAnElasticStopAtItsSpeed) {
  const system::Mechanism mechanism(slide(false, false, 0.0));
  const March run = march_paper(mechanism, 1e-6, 1e-4, 2.0);
  ASSERT_EQ(run.events.size(), 2u);
  EXPECT_NEAR(run.events[0].t, 0.5, 1e-9);
  const double half_period = std::numbers::pi * std::sqrt(2.0 / 800.0);
  EXPECT_NEAR(run.events[1].t, 0.5 + half_period, 1e-4);
  EXPECT_NEAR(run.state.v[0], -3.0, 1e-3);  // 150 steps a half period: (omega h)^2/12 is 4e-5
}

TEST(MechanismLocks, HoldAMassAtARigidStopUntilItIsPulledAway) {
  const system::Mechanism mechanism(slide(true, false, -4.0));
  const March run = march_paper(mechanism, 1e-6, 1e-4, 3.0);
  ASSERT_EQ(run.events.size(), 2u);
  EXPECT_NEAR(run.events[0].t, 0.5, 1e-9);
  EXPECT_NEAR(run.events[0].energy_lost, 9.0, 1e-9);
  EXPECT_FALSE(run.events[1].has_engaged);
  EXPECT_NEAR(run.events[1].t, 2.0, 1e-2);
  EXPECT_NEAR(run.state.v[0], -2.0, 2e-2);  // a second of 2 m/s2
}

TEST(MechanismLocks, HoldALatchedMassForGood) {
  const system::Mechanism mechanism(slide(true, true, -4.0));
  const March run = march_paper(mechanism, 1e-6, 1e-4, 3.0);
  ASSERT_EQ(run.events.size(), 1u);
  EXPECT_NEAR(run.state.q[3], 1.5, 1e-12);
  EXPECT_NEAR(run.state.v[0], 0.0, 1e-14);
}

}  // namespace
}  // namespace rubato
