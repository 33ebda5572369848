#include <rubato/integrate/kinds/mechanism_kind.hpp>
#include <rubato/integrate/kinds/mechanism_start_state.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/build_mechanism.hpp>

#include <support/mechanism_study.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

// Equilibria of mechanisms that rest on stops or have latched, and runs that start there.
namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::MechanismStudy;

constexpr double weight = 2.0 * 9.81;
constexpr double found = 1e-9;  // of an equilibrium, relative

/// A flap of 2 kg, 1 m from its pin, a little above its lock at the horizontal, under its weight.
std::string flap(const std::string& lock, const std::string& analyses) {
  return R"(
[[body]]
name = "flap"
mass = 2.0
inertia = 0.1
position = [1.0, 0.0]
[[joint]]
name = "pin"
type = "revolute"
between = ["ground", "flap"]
at = [0.0, 0.0]
angle = 0.001
lock = { at = 0.0, kind = "stop")" +
         lock + R"( }
[[force]]
on = "flap.y"
expression = "t > 0.5 ? 100 : 0"
[gravity]
acceleration = [0.0, -9.81]
)" + analyses;
}
const std::string rest = R"(
[[analysis]]
name = "rest"
type = "static"
)";

TEST(StaticLocks, HoldAFlapOnItsElasticStop) {
  const MechanismStudy ran(flap(", stiffness = 1e4", rest));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  // k angle = m g cos(angle - 0.001), with the body 0.001 rad behind the angle of the pin
  const double angle = ran.at(0, "rest", "angle", "pin");
  EXPECT_NEAR(angle, -weight / 1e4 * std::cos(angle - 0.001), found * weight / 1e4);
  ASSERT_EQ(ran.report.findings.size(), 1u);
  EXPECT_EQ(ran.report.findings.front(), "held by the lock of \"pin\"");
}

TEST(StaticLocks, HoldAFlapOnItsRigidStop) {
  const MechanismStudy ran(flap("", rest));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.at(0, "rest", "angle", "pin"), 0.0, 1e-12);
  EXPECT_NEAR(ran.at(0, "rest", "reaction_lock_moment", "pin"), weight * std::cos(0.001), found * weight);
}

// It stands until the force of 100 N lifts it at 0.5 s: I phi'' = (100 - m g) cos phi from there, I = 2.1.
TEST(StaticLocks, AreWhereARunMayStart) {
  for (const char* lock : {"", ", stiffness = 1e8, damping = 100"}) {
    const MechanismStudy ran(flap(lock, R"(
[[analysis]]
name = "run"
type = "transient"
initial = "static"
step = { tolerance = 1e-6 }
duration = 0.55
output = { interval = 0.05 }
)"));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_TRUE(ran.report.warnings.empty());
    const double sunk = ran.at(0, "run", "angle", "pin");
    for (std::size_t row = 0; row <= 9; ++row) {
      EXPECT_NEAR(ran.at(row, "run", "angle", "pin"), sunk, 1e-12);
      EXPECT_NEAR(ran.at(row, "run", "angular_velocity", "pin"), 0.0, 1e-9);
    }
    // 0.05 s under 38.28 rad/s2: the cosine falls by 1e-3, and the elastic stop gives 2e-6 J back.
    EXPECT_NEAR(ran.at(11, "run", "angle", "pin"), 0.5 * (100.0 - weight) / 2.1 * 0.05 * 0.05, 2e-4);
  }
}

/// A block of 2 kg on a vertical rail which nothing but its lock holds.
std::string falling_block(const std::string& lock) {
  return R"(
[[body]]
name = "block"
mass = 2.0
inertia = 0.1
position = [0.0, 0.0]
[[joint]]
name = "rail"
type = "prismatic"
between = ["ground", "block"]
at = [0.0, 0.0]
axis = [0.0, 1.0]
)" + lock +
         R"(
[gravity]
acceleration = [0.0, -9.81]
)" + rest;
}

// What it rests on stands in the table of events too, from which pictures are drawn.
TEST(StaticLocks, AreToldAtTheStartOfARun) {
  const MechanismStudy ran(flap("", R"(
[[analysis]]
name = "run"
type = "transient"
initial = "static"
step = { tolerance = 1e-4 }
duration = 0.6
)"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& events = ran.table("run.events");
  ASSERT_EQ(events.rows.size(), 2u);
  EXPECT_EQ(ran.at(0, "run.events", "time"), 0.0);
  EXPECT_NEAR(ran.at(1, "run.events", "time"), 0.5, 1e-9);
}

TEST(StaticLocks, CatchWhatWouldFallWithoutEnd) {
  const MechanismStudy stop(falling_block("lock = { at = -0.5, kind = \"stop\", stiffness = 1e3 }"));
  ASSERT_EQ(stop.report.status, analysis::RunStatus::done) << stop.report.message;
  EXPECT_NEAR(stop.at(0, "rest", "displacement", "rail"), -0.5 - weight / 1e3, found);
  const MechanismStudy latch(falling_block("lock = { at = -30.0, kind = \"latch\" }"));
  ASSERT_EQ(latch.report.status, analysis::RunStatus::done) << latch.report.message;
  EXPECT_NEAR(latch.at(0, "rest", "displacement", "rail"), -30.0, 1e-8);
  EXPECT_NEAR(latch.at(0, "rest", "reaction_lock_force", "rail"), weight, found * weight);
}

TEST(StaticLocks, WriteNothingWhereThereIsNoEquilibrium) {
  const MechanismStudy ran(falling_block("lock = { at = 0.5, kind = \"stop\" }"));
  EXPECT_EQ(ran.report.status, analysis::RunStatus::failed);
  EXPECT_THAT(ran.report.message, HasSubstr("no equilibrium was found"));
  EXPECT_FALSE(ran.sink.tables.contains("rest"));
}

// A bar of 2 m on a carriage that slides down stands on two props of 0.9 m at its ends, and its weight 0.5 m from its
// middle is shared 3 to 1.
TEST(StaticLocks, ShareALoad) {
  const MechanismStudy ran(R"(
[[body]]
name = "carriage"
mass = 1e-9
inertia = 1e-9
position = [0.0, 0.0]
[[body]]
name = "bar"
mass = 2.0
inertia = 0.5
position = [0.5, 0.0]
[[joint]]
name = "rail"
type = "prismatic"
between = ["ground", "carriage"]
at = [0.0, 0.0]
axis = [0.0, 1.0]
[[joint]]
name = "pin"
type = "revolute"
between = ["carriage", "bar"]
at = [0.0, 0.0]
[[joint]]
name = "left"
type = "strut"
between = ["ground", "bar"]
at = [-1.0, -1.0]
to = [-1.0, 0.0]
lock = { at = 0.9, kind = "stop" }
[[joint]]
name = "right"
type = "strut"
between = ["ground", "bar"]
at = [1.0, -1.0]
to = [1.0, 0.0]
lock = { at = 0.9, kind = "stop" }
[gravity]
acceleration = [0.0, -9.81]
)" + rest);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.at(0, "rest", "displacement", "left"), 0.9, 1e-10);
  EXPECT_NEAR(ran.at(0, "rest", "displacement", "right"), 0.9, 1e-10);
  EXPECT_NEAR(ran.at(0, "rest", "reaction_lock_force", "left"), 0.25 * weight, 1e-7 * weight);
  EXPECT_NEAR(ran.at(0, "rest", "reaction_lock_force", "right"), 0.75 * weight, 1e-7 * weight);
}

// A stop that holds where the search begins lets go what a spring pulls off it; a latch does not.
TEST(StaticLocks, LetGoWhatTheyWouldHaveToPull) {
  for (const char* kind : {"stop", "latch"}) {
    const auto study = io::read_study_text(R"(
[[body]]
name = "arm"
mass = 1.0
inertia = 0.2
position = [0.0, 0.0]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "arm"]
at = [0.0, 0.0]
stiffness = 10.0
rest = -0.4
lock = { at = 0.5, kind = ")" + std::string(kind) +
                                               "\" }" + rest,
                                           "study.toml");
    const system::Mechanism mechanism(model::build_mechanism(study.model, {}));
    std::vector<std::string> warnings;
    system::State state = integrate::assembled_start({}, mechanism, warnings, false);
    state.q[5] = 0.5;  // the angle of the body after the ground
    state.phase[0] = model::lock_engaged;
    const auto settled = integrate::MechanismKind(mechanism).find_equilibrium(state, {});
    ASSERT_EQ(settled.outcome, integrate::EquilibriumOutcome::found);
    const bool is_stop = std::string(kind) == "stop";
    EXPECT_NEAR(settled.state.q[5], is_stop ? -0.4 : 0.5, found);
    EXPECT_EQ(settled.state.phase[0], is_stop ? model::lock_open : model::lock_engaged);
  }
}

// A pendulum that may turn down to -0.05 rad, and a stop between its end and the ground that it would meet only beyond:
// what lies behind the first lock is not on the way.
TEST(StaticLocks, AreMetInTheOrderOfTheWay) {
  const MechanismStudy ran(R"(
[[body]]
name = "arm"
mass = 2.0
inertia = 0.2
position = [0.5, 0.0]
[[joint]]
name = "pin"
type = "revolute"
between = ["ground", "arm"]
at = [0.0, 0.0]
lock = { at = -0.05, kind = "stop" }
[[joint]]
name = "prop"
type = "strut"
between = ["ground", "arm"]
at = [1.0, -1.0]
to = [1.0, 0.0]
lock = { at = 0.9, kind = "stop" }
[gravity]
acceleration = [0.0, -9.81]
)" + rest);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.at(0, "rest", "angle", "pin"), -0.05, 1e-10);
  EXPECT_EQ(ran.report.findings.front(), "held by the lock of \"pin\"");
  EXPECT_NEAR(ran.at(0, "rest", "reaction_lock_force", "prop"), 0.0, 1e-12);
}

// Two rods of 0.5 m, and a stop that their ends could reach only at 1.02 m: the chain hangs down.
TEST(StaticLocks, OutOfReachDoNotMatter) {
  const MechanismStudy ran(R"(
[[body]]
name = "upper"
mass = 1.0
inertia = 0.02
position = [0.25, 0.0]
[[body]]
name = "lower"
mass = 1.0
inertia = 0.02
position = [0.5, 0.25]
angle = 1.5707963267948966
[[joint]]
name = "root"
type = "revolute"
between = ["ground", "upper"]
at = [0.0, 0.0]
[[joint]]
name = "knee"
type = "revolute"
between = ["upper", "lower"]
at = [0.5, 0.0]
[[joint]]
name = "reach"
type = "strut"
between = ["ground", "lower"]
at = [0.0, 0.0]
to = [0.5, 0.5]
lock = { at = 1.02, kind = "stop" }
[gravity]
acceleration = [0.0, -9.81]
)" + rest);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.at(0, "rest", "position", "upper.y"), -0.25, 1e-9);
  EXPECT_NEAR(ran.at(0, "rest", "position", "lower.y"), -0.75, 1e-9);
}

}  // namespace
}  // namespace rubato
