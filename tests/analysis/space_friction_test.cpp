#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

// What friction does in space alone; joint_friction_test.cpp has what it does in the plane too.
namespace rubato {
namespace {

using testing::bar_on_pin;
using testing::block_in_guide;
using ::testing::HasSubstr;
using testing::in_plane;
using testing::in_space;
using testing::Laid;
using testing::MechanismStudy;
using testing::transient;
using testing::verdict;

constexpr double gravity = 9.81;

// With a side force of 9 N across the plane the guide presses with the norm of both: no plane holds that.
TEST(SpaceJointFriction, IsPressedByWhatIsAcrossTheWayInBothDirections) {
  const numerics::Vector3 side = 9.0 * in_space.tilted.direction_of(0.0, 0.0, 1.0);
  std::string text =
      block_in_guide(in_space, 0.3, "friction = { coefficient = 0.5, normal_load = \"reaction\" }", 2.0) +
      in_space.gravity() + transient("{ tolerance = 1e-4 }", 1.5);
  const char* axes[] = {"x", "y", "z"};
  for (Index i = 0; i < 3; ++i)
    text +=
        std::string("[[force]]\non = \"block.") + axes[i] + "\"\nexpression = \"" + std::to_string(side[i]) + "\"\n";
  const MechanismStudy ran(text);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double normal = std::hypot(2.0 * gravity * std::cos(0.3), 9.0);
  const double slowing = gravity * std::sin(0.3) + 0.5 * normal / 2.0;
  EXPECT_NEAR(ran.at(0, "run.events", "time"), 2.0 / slowing, 1e-6);  // the force has six digits
}

// A bar about a dry pin, in the plane and in a tilted plane of space. About a fixed axis the step in space is that in
// the plane: Newton's tolerance and the resolution of events come between them.
std::string pin(const Laid& laid, const std::string& friction, const std::string& more) {
  return bar_on_pin(laid, more + "friction = { coefficient = 0.25, " + friction + ", radius = 0.3 }") + laid.gravity() +
         transient("0.005", 4.0);
}

void expect_the_same_swings(const std::string& friction, const std::string& more) {
  const MechanismStudy plane(pin(in_plane, friction, more)), space(pin(in_space, friction, more));
  ASSERT_EQ(plane.report.status, analysis::RunStatus::done) << plane.report.message;
  ASSERT_EQ(space.report.status, analysis::RunStatus::done) << space.report.message;
  const auto& events = plane.table("run.events");
  ASSERT_GE(events.rows.size(), 1u);
  ASSERT_EQ(space.table("run.events").rows.size(), events.rows.size());
  for (std::size_t i = 0; i < events.rows.size(); ++i) {
    EXPECT_NEAR(space.at(i, "run.events", "time"), events.rows[i][0], 1e-7) << i;
    EXPECT_EQ(space.at(i, "run.events", "event"), events.rows[i][2]) << i;
  }
  const std::size_t rows = plane.table("run").rows.size();
  ASSERT_EQ(space.table("run").rows.size(), rows);
  for (std::size_t row = 0; row < rows; row += 20) {
    EXPECT_NEAR(space.at(row, "run", "angle", "pin"), plane.at(row, "run", "angle", "pin"), 1e-7) << row;
    EXPECT_NEAR(space.at(row, "run", "friction_moment", "pin"), plane.at(row, "run", "friction_moment", "pin"), 1e-5)
        << row;
  }
  EXPECT_NEAR(space.last("run.energy", "friction_dissipated"), plane.last("run.energy", "friction_dissipated"), 1e-6);
  EXPECT_NEAR(space.last("run.energy", "residue"), plane.last("run.energy", "residue"), 1e-6);
}

TEST(SpaceJointFriction, SwingsOnAPreloadedPinAsInThePlane) {
  expect_the_same_swings("preload = 8.0", "angle = -0.2\nstiffness = 30.0\nrest = 0.0\n");
}

TEST(SpaceJointFriction, SwingsOnItsOwnReactionAsInThePlane) {
  expect_the_same_swings("normal_load = \"reaction\"", "angle = 0.25\nstiffness = 30.0\nrest = 0.0\n");
}

// A bar on two pins through one hole, both dry: preloads add up, and the bar slips where the load passes their sum, one
// newton metre and three. Shares of a reaction are not determined, and told.
std::string on_two_pins(const std::string& second) {
  return R"(
[[body]]
name = "bar"
mass = 2.0
inertia = [0.1, 0.1, 0.1]
position = [0.5, 0.0, 0.0]
[[joint]]
name = "one"
type = "revolute"
between = ["ground", "bar"]
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 1.0]
friction = { coefficient = 0.1, preload = 100.0, radius = 0.1 }
[[joint]]
name = "two"
type = "revolute"
between = ["ground", "bar"]
at = [0.0, 0.0, 0.3]
axis = [0.0, 0.0, 1.0]
friction = { coefficient = 0.1, radius = 0.1, )" +
         second + R"( }
[[force]]
on = "bar.rz"
expression = "5*t"
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[analysis]]
name = "run"
type = "transient"
step = 0.01
duration = 1.0
)";
}

TEST(SpaceJointFriction, AddsUpThePreloadsOfTwoPins) {
  const MechanismStudy ran(on_two_pins("preload = 300.0"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& events = ran.table("run.events");
  EXPECT_NEAR(events.rows.back()[0], 0.8, 1e-6);
  // (0.1 + 2*0.5^2) angle'' = 5 (t - 0.8) from there: 5 (t - 0.8)^3/6 over it. The step errs by h^2/12 angle''' 0.2 s,
  // 1.4e-5.
  EXPECT_NEAR(ran.last("run", "angle", "one"), 5.0 * 0.008 / 6.0 / 0.6, 2e-5);
}

TEST(SpaceJointFrictionFault, NamesTheReactionThatNothingDetermines) {
  EXPECT_THAT(verdict(on_two_pins("normal_load = \"reaction\"")),
              HasSubstr("the friction of \"two\" follows a reaction that is not determined: what \"two.x\" "
                        "holds is held by other joints too"));
}

// A rotor of 0.1 kg m2 on an upright pin: its whole weight lies along the axis, and its shoulder rubs. From 5 rad/s it
// stops after J w/(mu r m g) under a constant moment, for which the step is exact.
TEST(SpaceJointFriction, IsPressedByAWeightAlongThePin) {
  const MechanismStudy ran(R"(
[[body]]
name = "rotor"
mass = 2.0
inertia = [0.06, 0.06, 0.1]
position = [0.0, 0.0, 0.0]
angular_velocity = [0.0, 0.0, 5.0]
[[joint]]
name = "pin"
type = "revolute"
between = ["ground", "rotor"]
at = [0.0, 0.0, -0.3]
axis = [0.0, 0.0, 1.0]
friction = { coefficient = 0.2, normal_load = "reaction", radius = 0.05 }
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[analysis]]
name = "run"
type = "transient"
step = 0.01
duration = 4.0
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double moment = 0.2 * 0.05 * 2.0 * gravity, stop = 0.1 * 5.0 / moment;
  ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
  EXPECT_NEAR(ran.at(0, "run.events", "time"), stop, 1e-8);
  EXPECT_NEAR(ran.last("run", "angle", "pin"), 0.5 * 5.0 * stop, 1e-8);
  EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 0.5 * 0.1 * 25.0, 1e-8);
}

}  // namespace
}  // namespace rubato
