#include <support/laid_steps.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

// Dry joints that are at their limits for long, or that nothing presses: what is left of their forces is round-off,
// and must not let them go.
namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::in_plane;
using testing::MechanismStudy;
using testing::transient;

class JointsAtTheirLimit : public ::testing::TestWithParam<int> {
 public:
  static std::string run(double duration, const std::string& equal, const std::string& tolerance = "1e-5") {
    return transient(testing::step_of_kind(GetParam(), equal, tolerance), duration);
  }
};
INSTANTIATE_TEST_SUITE_P(Steps, JointsAtTheirLimit, ::testing::Values(0, 1, 2));

std::string body(const char* name, double x, double y, const char* more = "") {
  return fmt::format("[[body]]\nname = \"{}\"\nmass = 1.0\ninertia = 0.01\nposition = [{}, {}]\n{}", name, x, y, more);
}

std::string joint(const char* name, const char* type, const char* from, const char* to, double y, const char* keys) {
  return fmt::format("[[joint]]\nname = \"{}\"\ntype = \"{}\"\nbetween = [\"{}\", \"{}\"]\nat = [0.0, {}]\n{}\n", name,
                     type, from, to, y, keys);
}

// A block on a block, with one coefficient everywhere: as both slow down the upper one needs just what holds it.
TEST_P(JointsAtTheirLimit, StopTwoBlocksAtOnce) {
  const char* const slide = "axis = [1.0, 0.0]\nfriction = { coefficient = 0.3, normal_load = \"reaction\" }";
  const MechanismStudy ran(
      body("lower", 0.0, 0.0, "velocity = [1.0, 0.0]\n") + body("upper", 0.0, 0.1, "velocity = [1.0, 0.0]\n") +
      joint("floor", "prismatic", "ground", "lower", -0.05, slide) +
      joint("between", "prismatic", "lower", "upper", 0.05, slide) + in_plane.gravity() + run(0.6, "0.0005"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double way = 1.0 / (2.0 * 0.3 * 9.81);
  EXPECT_NEAR(ran.last("run", "displacement", "floor"), way, 1e-8);
  EXPECT_NEAR(ran.last("run", "displacement", "between"), 0.0, 1e-8);
  EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 1.0, 1e-8);
}

// An arm that friction holds, and on it one that nothing loads: the limit of its pin is nothing.
TEST_P(JointsAtTheirLimit, HoldAnArmThatNothingPresses) {
  const MechanismStudy ran(
      body("arm", 0.0, 0.0) + body("free arm", 0.15, 0.0) +
      joint("pin", "revolute", "ground", "arm", 0.0, "friction = { coefficient = 0.3, preload = 20, radius = 0.05 }") +
      joint("unloaded", "revolute", "arm", "free arm", 0.0,
            "friction = { coefficient = 0.3, normal_load = \"reaction\", radius = 0.05 }") +
      "[[force]]\non = \"arm.rz\"\nexpression = \"0.2*sin(9*t)\"\n" + run(1.0, "0.0005"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_TRUE(ran.table("run.events").rows.empty());
  EXPECT_NEAR(ran.last("run", "angle", "unloaded"), 0.0, 1e-9);
}

// While nothing moves nothing but the formula tells how fast it swings: 20 half waves in each of the steps that a run
// of 10 s would take.
TEST(JointsAtRest, MeetAFormulaThatSwingsFast) {
  const MechanismStudy ran(testing::block_in_guide(in_plane, 0.0, "friction = { coefficient = 0.3, preload = 10.0 }") +
                           "[[force]]\non = \"block.x\"\nexpression = \"3.5*sin(2*pi*50*t)\"\n" +
                           transient("{ tolerance = 1e-4 }", 10.0));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_EQ(ran.table("run.events").rows.size(), 2000u);
  EXPECT_NEAR(ran.at(0, "run.events", "time"), std::asin(3.0 / 3.5) / (100.0 * std::numbers::pi), 1e-9);
}

std::string motor(const char* name, double y, const char* law) {
  return joint(name, "revolute", "ground", "arm", y, fmt::format("drive = \"{}\"", law).c_str());
}

// Least-norm multipliers would share out what contradicts, and rows stay apart.
TEST(ContradictoryDrives, EndTheRunAndAreNamed) {
  for (const std::string& second :
       {motor("motor 2", 0.0, "1.1*t^2"), joint("hinge", "revolute", "ground", "arm", 0.1, "")})
    for (const char* step : {"0.001", "{ tolerance = 1e-4 }"}) {
      const MechanismStudy ran(body("arm", 0.5, 0.0) + motor("motor 1", 0.0, "t^2") + second + transient(step, 1.0));
      EXPECT_EQ(ran.report.status, analysis::RunStatus::failed);
      EXPECT_THAT(ran.report.message, HasSubstr("the joints and drives cannot all be satisfied: \""));
      EXPECT_LT(std::abs(ran.last("run", "angle", "motor 1")), 1e-3);
    }
}

// A force that jumps from nothing to ten times what the block's friction holds: no row shows more than the limit.
TEST(JointsAtTheirLimit, ShowNoMoreThanTheyHoldWhereALoadJumps) {
  for (const char* step : {"{ tolerance = 1e-4 }", "0.01"}) {
    const MechanismStudy ran(std::string(R"text(
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
axis = [1.0, 0.0]
friction = { coefficient = 0.5, preload = 20.0 }
[[force]]
on = "block.x"
expression = "t >= 0.5 ? 100 : 4"
[[analysis]]
name = "run"
type = "transient"
duration = 1.0
step = )text") + step);
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    double before = 0.0;
    for (std::size_t row = 0; row < ran.table("run").rows.size(); ++row) {
      const double friction = ran.at(row, "run", "friction_force", "rail");
      EXPECT_LE(std::abs(friction), 10.0 * (1.0 + 1e-6));
      if (ran.at(row, "run", "time") <= 0.5) before = friction;
    }
    EXPECT_NEAR(before, -4.0, 1e-9) << step;  // up to the jump it holds what there is
    EXPECT_NEAR(ran.last("run", "friction_force", "rail"), -10.0, 1e-9);
  }
}

// A lever of 1 kg on a prop is lifted by 10 t N in its middle: the prop lets go when the weight is borne, its dry hinge
// of 0.3 N m later. What steps between take from interpolation must not be taken for either.
TEST(JointsAtTheirLimit, LetALeverGoFromItsPropAndThenSlip) {
  for (const char* step : {"{ tolerance = 1e-5 }", "0.001", "0.0002"}) {
    const MechanismStudy ran(std::string(R"text(
[gravity]
acceleration = [0.0, -9.81]
[[body]]
name = "lever"
mass = 1.0
inertia = 0.05
position = [0.5, 0.0]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "lever"]
at = [0.0, 0.0]
friction = { coefficient = 0.3, preload = 2.0, radius = 0.5 }
[[joint]]
name = "prop"
type = "strut"
between = ["ground", "lever"]
at = [1.0, -1.0]
to = [1.0, 0.0]
lock = { at = 0.9999, kind = "stop" }
[[force]]
on = "lever.y"
expression = "10*t"
[[analysis]]
name = "run"
type = "transient"
initial = "static"
duration = 1.2
output = { times = [1.2] }
step = )text") + step);
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << step << ": " << ran.report.message;
    const auto& events = ran.table("run.events");
    ASSERT_GE(events.rows.size(), 3u);
    EXPECT_NEAR(ran.at(1, "run.events", "time"), 0.981, 1e-6) << step;
    EXPECT_NEAR(ran.last("run.events", "time"), 1.041, 1e-4) << step;  // the arm lies 1e-4 rad low
    // I phi'' = 5 (t - 1.041) with I = 0.05 + 0.25
    EXPECT_NEAR(ran.last("run", "angle", "hinge"), -1e-4 + 5.0 / 0.3 * std::pow(1.2 - 1.041, 3) / 6.0, 2e-5) << step;
  }
}

// The strut of a swinging bar is shortest, and longest, where it points at the pin: friction turns round there,
// whatever has latched elsewhere. All that is dissipated is the limit of 0.5 N times the way of the strut.
TEST_P(JointsAtTheirLimit, TurnRoundInDeadCentresBesideALatch) {
  const std::string bar = body("bar", 1.0, 0.0) + joint("pin", "revolute", "ground", "bar", 0.0, "") +
                          "[[joint]]\nname = \"dry\"\ntype = \"strut\"\nbetween = [\"ground\", \"bar\"]\n"
                          "at = [0.5, 2.0]\nto = [0.5, 0.5]\nfriction = { coefficient = 0.1, preload = 5.0 }\n" +
                          in_plane.gravity() + run(4.0, "0.0005");
  const std::string latched =
      body("slide", 0.0, 0.0) + joint("guide", "prismatic", "ground", "slide", 0.0,
                                      "axis = [1.0, 0.0]\nlock = { at = 0.0, kind = \"latch\", side = \"below\" }");
  const MechanismStudy ran(latched + bar), alone(bar);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& steps = ran.table("run").rows;
  double way = 0.0, before = 0.0;
  int turns = 0;
  for (std::size_t row = 1; row < steps.size(); ++row) {
    const double by = ran.at(row, "run", "displacement", "dry") - ran.at(row - 1, "run", "displacement", "dry");
    way += std::abs(by);
    turns += by * before < 0.0 ? 1 : 0;
    before = by;
    EXPECT_GE(ran.at(row, "run.energy", "friction_dissipated"),
              ran.at(row - 1, "run.energy", "friction_dissipated") - 1e-9);
  }
  EXPECT_GT(turns, 5);
  EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 0.5 * way, 0.01 * way);
  EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), alone.last("run.energy", "friction_dissipated"), 1e-4);
}

}  // namespace
}  // namespace rubato
