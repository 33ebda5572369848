#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::MechanismStudy;
using testing::replaced;
using testing::verdict;

// A body whose joint has the axis n = (1, 2, 2)/3 through the origin. About n it has
// n . J n = (0.3 + 4*0.4 + 4*0.5 + 2*(2*0.01 + 2*0.02 + 4*0.03))/9 = 4.26/9 kg m2.
const std::string joined = R"(
[[body]]
name = "body"
mass = 2.0
inertia = [0.3, 0.4, 0.5, 0.01, 0.02, 0.03]
position = [1.0, 0.0, 0.0]

[[joint]]
name = "motor"
type = "revolute"
between = ["ground", "body"]
at = [0.0, 0.0, 0.0]
axis = [1.0, 2.0, 2.0]
drive = "10*t^2"

[[analysis]]
name = "run"
type = "transient"
step = 0.01
duration = 1.0
project_velocities = true
)";

constexpr double about_axis = 4.26 / 9.0;

/// The same body with its centre of mass on the axis.
std::string centred(const std::string& type, const std::string& drive) {
  std::string text = replaced(joined, "[1.0, 0.0, 0.0]", "[0.0, 0.0, 0.0]");
  return replaced(replaced(text, "revolute\"", type), "\"10*t^2\"", drive);
}

// About a fixed axis the moment is inertia times angular acceleration, whatever the products of inertia: 20 rad/s2, and
// the work is that times 10 rad, a turn and a half. Newton leaves 1e-10 of positions; accelerations in the
// row of the drive follow from it alone.
TEST(SpaceDrives, NeedTheInertiaAboutTheAxisTimesTheAcceleration) {
  const MechanismStudy ran(joined);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double inertia = about_axis + 2.0 * (1.0 - 1.0 / 9.0);  // the centre of mass is sqrt(8/9) m from the axis
  const auto& table = ran.table("run");
  for (const auto& row : table.rows) {
    EXPECT_NEAR(row[table.column("angle", "motor")], 10.0 * row[0] * row[0], 1e-8);
    EXPECT_NEAR(row[table.column("drive_moment", "motor")], 20.0 * inertia, 1e-7);
    // What the hinge itself gives has no moment about its axis.
    const double along =
        (row[table.column("reaction_moment_x", "motor")] + 2.0 * row[table.column("reaction_moment_y", "motor")] +
         2.0 * row[table.column("reaction_moment_z", "motor")]) /
        3.0;
    EXPECT_NEAR(along, 0.0, 1e-7);
  }
  EXPECT_NEAR(ran.last("run.energy", "drive_work"), 200.0 * inertia, 1e-6);
  EXPECT_NEAR(ran.last("run.energy", "kinetic"), 200.0 * inertia, 1e-6);
}

TEST(SpaceDrives, LiftAlongASkewAxisAgainstGravity) {
  const MechanismStudy ran(centred("prismatic\"", "\"0.1*t^3\"") + "[gravity]\nacceleration = [0.0, 0.0, -9.0]\n");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.table("run");
  for (const auto& row : table.rows) {
    const double t = row[0];
    EXPECT_NEAR(row[table.column("displacement", "motor")], 0.1 * t * t * t, 1e-9);
    EXPECT_NEAR(row[table.column("drive_force", "motor")], 2.0 * (0.6 * t + 9.0 * 2.0 / 3.0), 1e-7);
  }
}

TEST(SpaceDrives, TurnAScrewThatCarriesItsMassAlong) {
  const MechanismStudy ran(centred("screw\"\nlead = 0.5", "\"3*t^2\""));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double way = 0.5 / (2.0 * std::numbers::pi);  // a radian
  EXPECT_NEAR(ran.last("run", "angle", "motor"), 3.0, 1e-9);
  EXPECT_NEAR(ran.last("run", "displacement", "motor"), 3.0 * way, 1e-9);
  EXPECT_NEAR(ran.last("run", "drive_moment", "motor"), 6.0 * (about_axis + 2.0 * way * way), 1e-7);
}

TEST(SpaceDriveFault, NamesTheJointsThatTakeADrive) {
  EXPECT_THAT(
      verdict(centred("cylindrical\"", "\"t\"")),
      HasSubstr("\"drive\" belongs to a revolute, prismatic, screw or strut joint, and this one is cylindrical"));
}

}  // namespace
}  // namespace rubato
