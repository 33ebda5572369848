#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace rubato {
namespace {

using numerics::Vector3;
using std::numbers::pi;
using testing::block_in_guide;
using testing::example;
using ::testing::HasSubstr;
using testing::in_space;
using testing::MechanismStudy;
using testing::replaced;
using testing::replaced_everywhere;
using testing::TiltedPlane;
using testing::transient;
using testing::verdict;

const TiltedPlane& tilted = in_space.tilted;

std::string panel(const std::string& name) {
  return "[[body]]\nname = \"" + name +
         "\"\nmass = 4.0\ninertia = [0.2, 0.3, \"4/12\"]\nposition = " + tilted.point(0.0, 0.5) +
         "\nrotation = " + tilted.rotation() + "\n";
}

std::string hinge(const std::string& name, const std::string& first, const std::string& second, double y,
                  const std::string& rest, const std::string& lock) {
  return "[[joint]]\nname = \"" + name + "\"\ntype = \"revolute\"\nbetween = [\"" + first + "\", \"" + second +
         "\"]\nat = " + tilted.point(0.0, y) + "\naxis = " + tilted.normal() + "\nstiffness = 2.0\nrest = " + rest +
         "\ndamping = 0.4\nlock = " + lock + "\n";
}

const std::string fixed_step =
    "[[analysis]]\nname = \"deployment\"\ntype = \"transient\"\nstep = 0.01\nduration = 12.0\n";

/// The panels of the example, laid into a tilted plane.
std::string panels_in_space(const std::string& kind) {
  return panel("root") + panel("middle") + panel("outer") +
         hinge("wall", "ground", "root", 0.0, "\"-0.6*pi\"", "{ at = \"-pi/2\", " + kind + " }") +
         hinge("first", "root", "middle", 1.0, "\"1.1*pi\"", "{ at = \"pi\", " + kind + " }") +
         hinge("second", "middle", "outer", 0.0, "\"-1.1*pi\"", "{ at = \"-pi\", " + kind + " }") + fixed_step;
}

std::string panels_in_plane(const std::string& kind) {
  std::string text = example("deployable-panel");
  return replaced_everywhere(text.substr(0, text.find("[[analysis]]")), "kind = \"latch\"", kind) + fixed_step;
}

// About a fixed axis the exponential map adds angles: the step in space is that in the plane, and only Newton's
// tolerance (1e-10 of the size of the model) and the resolution of events come between them.
void expect_the_same_motion(const std::string& kind, std::size_t least_events) {
  const MechanismStudy plane(panels_in_plane(kind)), space(panels_in_space(kind));
  ASSERT_EQ(plane.report.status, analysis::RunStatus::done) << plane.report.message;
  ASSERT_EQ(space.report.status, analysis::RunStatus::done) << space.report.message;
  const auto& events = plane.table("deployment.events");
  ASSERT_GE(events.rows.size(), least_events);
  ASSERT_EQ(space.table("deployment.events").rows.size(), events.rows.size());
  for (std::size_t i = 0; i < events.rows.size(); ++i) {
    const auto& other = space.table("deployment.events").rows[i];
    EXPECT_NEAR(other[0], events.rows[i][0], 1e-7) << i;
    EXPECT_EQ(other[1], events.rows[i][1]) << i;
    EXPECT_EQ(other[2], events.rows[i][2]) << i;
    EXPECT_NEAR(other[3], events.rows[i][3], 1e-6) << i;
  }
  const std::size_t rows = plane.table("deployment").rows.size();
  ASSERT_EQ(space.table("deployment").rows.size(), rows);
  for (std::size_t row = 0; row < rows; row += 50)
    for (const char* joint : {"wall", "first", "second"})
      EXPECT_NEAR(space.at(row, "deployment", "angle", joint), plane.at(row, "deployment", "angle", joint), 1e-6)
          << joint << " at row " << row;
  for (const char* part : {"kinetic", "strain", "lock_dissipated", "damper_dissipated", "residue"})
    EXPECT_NEAR(space.last("deployment.energy", part), plane.last("deployment.energy", part), 1e-6) << part;
}

TEST(SpaceLocks, LatchPanelsInATiltedPlaneAsInThePlane) { expect_the_same_motion("kind = \"latch\"", 3); }

TEST(SpaceLocks, LatchPanelsOnSpringsAsInThePlane) {
  expect_the_same_motion("kind = \"latch\", stiffness = 2e3, damping = 5.0", 3);
}

TEST(SpaceLocks, StopPanelsAsInThePlane) {
  expect_the_same_motion("kind = \"stop\", stiffness = 2e3, damping = 5.0", 4);
}

// The example's bars in the plane of x and z, seen along y. The small inertia of the sections goes to the nodes by
// halves in space and is consistent in the plane: of rigid bars the same, and a part of 1e-4 of the mass of an element.
TEST(SpaceLocks, LockTheBarsOfThePaperWhenThePlaneDoes) {
  std::string plane = example("locking-bars");
  plane = plane.substr(0, plane.find("[[analysis]]"));
  std::string space = plane;
  space = replaced(space, "position = [0.0, 0.0]", "position = [0.0, 0.0, 0.0]");
  space = replaced_everywhere(space, "\"length*sin(opening/2)\", \"length*cos(opening/2)\"]",
                              "\"length*sin(opening/2)\", 0.0, \"length*cos(opening/2)\"]");
  space = replaced(space, "[\"2*length*sin(opening/2)\", 0.0]", "[\"2*length*sin(opening/2)\", 0.0, 0.0]");
  space = replaced(space, "inertia = 4.5e-5", "torsion = 9e-5\ninertia = [4.5e-5, 4.5e-5]");
  space = replaced_everywhere(space, "material = \"steel\"\n", "material = \"steel\"\norientation = [0.0, 1.0, 0.0]\n");
  space = replaced(space, "fix = [\"x\", \"y\"]", "fix = [\"x\", \"y\", \"z\", \"rx\", \"rz\"]");
  space = replaced(space, "fix = [\"y\"]", "fix = [\"y\", \"z\", \"rx\", \"rz\"]");
  space = replaced(space, "angle = \"opening\"",
                   "at = [\"length*sin(opening/2)\", 0.0, \"length*cos(opening/2)\"]\n"
                   "axis = [0.0, -1.0, 0.0]\nangle = \"opening\"");
  const std::string run = "[[analysis]]\nname = \"motion\"\ntype = \"transient\"\nstep = 0.002\nduration = 1.4\n";
  const MechanismStudy in_plane(plane + run), in_space(space + run);
  ASSERT_EQ(in_plane.report.status, analysis::RunStatus::done) << in_plane.report.message;
  ASSERT_EQ(in_space.report.status, analysis::RunStatus::done) << in_space.report.message;
  EXPECT_NEAR(in_space.at(0, "motion.events", "time"), in_plane.at(0, "motion.events", "time"), 2e-5);
  EXPECT_EQ(in_space.table("motion.events").rows.size(), in_plane.table("motion.events").rows.size());
}

// A nut of 2 kg and 0.1 kg m2 about a screw along a skew axis falls by its own weight: a constant moment
// m g lead/(2 pi) n_z on the inertia J + m (lead/(2 pi))^2, for which the step is exact.
TEST(SpaceLocks, LatchANutThatTurnsDownItsScrew) {
  const MechanismStudy ran(R"(
[[body]]
name = "nut"
mass = 2.0
inertia = [0.1, 0.1, 0.1]
position = [0.3, -0.1, 0.2]
[[joint]]
name = "thread"
type = "screw"
between = ["ground", "nut"]
at = [0.3, -0.1, 0.2]
axis = [2.0, 1.0, 2.0]
lead = 0.4
lock = { at = -6.0, kind = "latch" }
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[analysis]]
name = "run"
type = "transient"
step = 0.01
duration = 4.0
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double way = 0.4 / (2.0 * pi), inertia = 0.1 + 2.0 * way * way;
  const double moment = 2.0 * 9.81 * way * 2.0 / 3.0;
  ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
  EXPECT_NEAR(ran.at(0, "run.events", "time"), std::sqrt(2.0 * 6.0 * inertia / moment), 1e-8);
  EXPECT_NEAR(ran.at(0, "run.events", "energy_lost"), moment * 6.0, 1e-7);
  EXPECT_NEAR(ran.last("run.energy", "lock_dissipated"), moment * 6.0, 1e-7);
  EXPECT_NEAR(ran.last("run", "angle", "thread"), -6.0, 1e-10);
  EXPECT_NEAR(ran.last("run", "displacement", "thread"), -6.0 * way, 1e-10);
}

/// A block of 2 kg that slides down an incline of 0.3 rad onto a stop after 0.5 m.
std::string dropped(const std::string& lock) {
  return block_in_guide(in_space, 0.3, "lock = { at = -0.5, " + lock + " }") + in_space.gravity() +
         transient("0.002", 2.0);
}

TEST(SpaceLocks, StopABlockRigidlyAndHoldItsWeight) {
  const MechanismStudy ran(dropped("kind = \"stop\""));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double down = 9.81 * std::sin(0.3);
  EXPECT_NEAR(ran.at(0, "run.events", "time"), std::sqrt(2.0 * 0.5 / down), 1e-8);
  EXPECT_NEAR(ran.last("run.energy", "lock_dissipated"), 2.0 * down * 0.5, 1e-7);
  EXPECT_NEAR(ran.last("run", "displacement", "guide"), -0.5, 1e-10);
}

// An undamped stop gives everything back: the block rises to where it was let go. While it touches, for about half a
// period of sqrt(2/8000) s, the step of 2 ms errs by (h/tau)^2/12: the method damps little, and the rise loses as much.
TEST(SpaceLocks, LetTheBlockBounceOffASpring) {
  const MechanismStudy ran(replaced(dropped("kind = \"stop\", stiffness = 8e3"), "step = 0.002", "step = 0.0002"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double down = 9.81 * std::sin(0.3), fall = std::sqrt(2.0 * 0.5 / down), speed = down * fall;
  const double frequency = std::sqrt(8000.0 / 2.0), sag = 2.0 * down / 8000.0;
  // s = sag (1 - cos) + (speed/frequency) sin until it is zero again.
  const double touches = (2.0 * pi - 2.0 * std::atan2(speed / frequency, sag)) / frequency;
  ASSERT_GE(ran.table("run.events").rows.size(), 2u);
  EXPECT_NEAR(ran.at(0, "run.events", "time"), fall, 1e-8);
  EXPECT_NEAR(ran.at(1, "run.events", "time"), fall + touches, 1e-5);
  const auto row = static_cast<std::size_t>(std::lround((2.0 * fall + touches) / 0.0002));
  EXPECT_NEAR(ran.at(row, "run", "displacement", "guide"), 0.0, 1e-3);
}

// Two bodies in free flight, joined by a hinge that turns until it latches: no outer force, so that momenta stay what
// they were, and the latch takes the energy of the relative motion. Errors fall with the square of the step.
TEST(SpaceLocks, TakeNoMomentumFromAFreeFlight) {
  const MechanismStudy ran(R"(
[[body]]
name = "one"
mass = 3.0
inertia = [0.3, 0.4, 0.5, 0.01, 0.02, 0.03]
position = [0.0, 0.0, 0.0]
velocity = [0.1, -0.2, 0.05]
angular_velocity = [0.3, -0.2, 0.5]
[[body]]
name = "two"
mass = 2.0
inertia = [0.2, 0.25, 0.15]
position = [0.8, 0.3, -0.2]
rotation = [0.4, 0.2, -0.3]
velocity = [0.3, 0.4, 0.5]
angular_velocity = [-1.0, 0.7, 1.5]
[[joint]]
name = "hinge"
type = "revolute"
between = ["one", "two"]
at = [0.5, 0.1, 0.0]
axis = [1.0, 2.0, 2.0]
lock = { at = -0.9, kind = "latch" }
[[analysis]]
name = "run"
type = "transient"
step = 0.002
duration = 4.0
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
  numerics::Matrix3 inertia_one, inertia_two;
  inertia_one << 0.3, 0.01, 0.02, 0.01, 0.4, 0.03, 0.02, 0.03, 0.5;
  inertia_two = Vector3(0.2, 0.25, 0.15).asDiagonal();
  const std::string translations[] = {"x", "y", "z"}, rotations[] = {"rx", "ry", "rz"};
  const auto momenta = [&](std::size_t row) {
    std::pair<Vector3, Vector3> sum{Vector3::Zero(), Vector3::Zero()};
    const auto add = [&](const std::string& body, double mass, const numerics::Matrix3& inertia) {
      Vector3 x, v, turn, spin;
      for (Index i = 0; i < 3; ++i) {
        x[i] = ran.at(row, "run", "position", body + "." + translations[i]);
        v[i] = ran.at(row, "run", "velocity", body + "." + translations[i]);
        turn[i] = ran.at(row, "run", "angle", body + "." + rotations[i]);
        spin[i] = ran.at(row, "run", "angular_velocity", body + "." + rotations[i]);
      }
      sum.first += mass * v;
      sum.second += mass * x.cross(v) + numerics::rotation_of(turn) * (inertia * spin);
    };
    add("one", 3.0, inertia_one);
    add("two", 2.0, inertia_two);
    return sum;
  };
  const auto start = momenta(0), end = momenta(ran.table("run").rows.size() - 1);
  EXPECT_LT((end.first - start.first).norm(), 1e-9 * start.first.norm());
  EXPECT_LT((end.second - start.second).norm(), 1e-5 * start.second.norm());
  const double lost = ran.at(0, "run.events", "energy_lost");
  EXPECT_GT(lost, 0.01);
  EXPECT_NEAR(ran.last("run.energy", "kinetic"), ran.at(0, "run.energy", "kinetic") - lost, 1e-4 * lost);
  EXPECT_NEAR(ran.last("run", "angle", "hinge"), -0.9, 1e-9);
  EXPECT_NEAR(ran.last("run", "angular_velocity", "hinge"), 0.0, 1e-4);
}

TEST(SpaceLockFault, NamesTheJointThatStartsAtItsLock) {
  EXPECT_THAT(verdict(replaced(dropped("kind = \"stop\""), "lock = { at = -0.5,", "lock = { at = 0.0,")),
              HasSubstr("joint \"guide\": lock: the joint starts at its lock, 0"));
}

}  // namespace
}  // namespace rubato
