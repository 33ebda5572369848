#include <support/mechanism_study.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace rubato {
namespace {

using testing::MechanismStudy;

// A bar of 2 kg, its centre 0.5 m from the pin, J = 0.1 + 2*0.25 = 0.6 kg m2 about it; a drive holds it level at t = 0,
// with a rate and a second rate that statics must not see. A pendulum of 3 kg hangs 1 m out, its centre 0.4 m below.
const std::string held = R"(
[[body]]
name = "bar"
mass = 2.0
inertia = 0.1
position = [0.5, 0.0]

[[body]]
name = "pendulum"
mass = 3.0
inertia = 0.02
position = [1.0, -0.4]

[[joint]]
name = "motor"
type = "revolute"
between = ["ground", "bar"]
at = [0.0, 0.0]
drive = "0.5*t + 7*t^2"

[[joint]]
name = "hook"
type = "revolute"
between = ["bar", "pendulum"]
at = [1.0, 0.0]

[gravity]
acceleration = [0.0, -9.81]
)";

constexpr double gravity = 9.81;
constexpr double moment_of_weight = gravity * (2.0 * 0.5 + 3.0 * 1.0);

TEST(DrivesAtRest, HoldTheWeightInAStaticState) {
  const MechanismStudy ran(held + "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.last("rest", "angle", "motor"), 0.0, 1e-9);
  EXPECT_NEAR(ran.last("rest", "drive_moment", "motor"), moment_of_weight, 1e-7);
  for (const std::string& warning : ran.report.warnings) ADD_FAILURE() << warning;  // of velocities, which it takes not
}

TEST(DrivesAtRest, LeaveTheModesOfWhatHangsOnThem) {
  const double expected =
      std::sqrt(3.0 * gravity * 0.4 / (0.02 + 3.0 * 0.4 * 0.4)) / (2.0 * std::numbers::pi);  // of the pendulum
  for (const std::string about : {"", "about = \"static\"\n"}) {
    const MechanismStudy ran(held + "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n" + about);
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const auto& table = ran.table("modes");
    ASSERT_EQ(table.rows.size(), 1u) << about;
    EXPECT_NEAR(ran.last("modes", "frequency"), expected, 1e-8) << about;
    // Held by the drive it is in equilibrium; the one thing to tell is the velocity that the drive gives at the start.
    for (const std::string& warning : ran.report.warnings)
      EXPECT_EQ(warning.find("no equilibrium"), std::string::npos) << warning;
  }
}

TEST(DrivesAtRest, SetAMechanismInMotionFromItsEquilibrium) {
  const MechanismStudy ran(held + R"(
[[analysis]]
name = "run"
type = "transient"
initial = "static"
step = 0.001
duration = 0.002
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.at(0, "run", "angular_velocity", "motor"), 0.5, 1e-12);
  EXPECT_NEAR(ran.at(0, "run", "angular_acceleration", "motor"), 14.0, 1e-10);
  // The bar that sets off takes the hook up along the pendulum, which does not turn: its centre rises with 14 m/s2.
  const double moment = 0.6 * 14.0 + 3.0 * 14.0 + moment_of_weight;
  EXPECT_NEAR(ran.at(0, "run", "drive_moment", "motor"), moment, 1e-7);
}

// A mass on a vertical spring and a rail that rubs.
const std::string rubbing = R"(
[[body]]
name = "mass"
mass = 2.0
inertia = 0.1
position = [0.0, 0.0]

[[joint]]
name = "rail"
type = "prismatic"
between = ["ground", "mass"]
at = [0.0, 0.0]
axis = [0.0, 1.0]
stiffness = 500.0
friction = { coefficient = 0.5, preload = 100.0 }

[gravity]
acceleration = [0.0, -9.81]
)";

TEST(FrictionAtRest, IsLeftOutOfStaticStatesAndModes) {
  const MechanismStudy rest(rubbing + "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n");
  ASSERT_EQ(rest.report.status, analysis::RunStatus::done) << rest.report.message;
  EXPECT_NEAR(rest.last("rest", "displacement", "rail"), -2.0 * gravity / 500.0, 1e-9);
  const MechanismStudy modes(rubbing + "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\n");
  ASSERT_EQ(modes.report.status, analysis::RunStatus::done) << modes.report.message;
  EXPECT_NEAR(modes.last("modes", "frequency"), std::sqrt(500.0 / 2.0) / (2.0 * std::numbers::pi), 1e-8);
}

TEST(FrictionAtRest, SticksWithoutAForceAtTheEquilibriumFromWhichItStarts) {
  const MechanismStudy ran(rubbing + R"(
[[analysis]]
name = "run"
type = "transient"
initial = "static"
step = 0.01
duration = 1.0
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  for (std::size_t row = 0; row < ran.table("run").rows.size(); ++row) {
    EXPECT_NEAR(ran.at(row, "run", "displacement", "rail"), -2.0 * gravity / 500.0, 1e-9);
    EXPECT_NEAR(ran.at(row, "run", "friction_force", "rail"), 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace rubato
