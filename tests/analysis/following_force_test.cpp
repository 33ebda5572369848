#include <rubato/core/error.hpp>

#include <support/mechanism_study.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rubato {
namespace {

using testing::MechanismStudy;

// A rocket of 2 kg that spins at 3 rad/s, with a thrust of 5 N along its own x axis, which the force follows:
// x'' = 2.5 cos(3 t), y'' = 2.5 sin(3 t).
const std::string rocket = R"(
[[body]]
name = "rocket"
mass = 2.0
inertia = 0.4
position = [0.0, 0.0]
angular_velocity = 3.0
[[force]]
on = "rocket.x"
expression = "5"
following = true
[[analysis]]
name = "run"
type = "transient"
step = 0.0005
duration = 2.0
)";

TEST(FollowingForces, TurnWithTheirBody) {
  const MechanismStudy ran(rocket);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double w = 3.0, t = 2.0, a = 2.5;
  // Second order: (w h)^2/12 of a t^2/2, 1e-6 m.
  EXPECT_NEAR(ran.last("run", "position", "rocket.x"), a / (w * w) * (1.0 - std::cos(w * t)), 2e-6);
  EXPECT_NEAR(ran.last("run", "position", "rocket.y"), a / (w * w) * (w * t - std::sin(w * t)), 2e-6);
  const double kinetic = ran.last("run.energy", "kinetic") - 0.5 * 0.4 * 9.0;
  EXPECT_NEAR(ran.last("run.energy", "load_work"), kinetic, 1e-6);
}

TEST(FollowingForces, TurnABodyByTheirLeverAtAPoint) {
  std::string text = rocket;
  text.replace(text.find("angular_velocity = 3.0\n"), 23, "");
  text.replace(text.find("following = true"), 16, "following = true\nat = [0.7, -0.2]");
  const MechanismStudy ran(text);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  // The moment 0.2 m * 5 N whatever the angle: constant, for which the step is exact.
  EXPECT_NEAR(ran.last("run", "angle", "rocket.rz"), 0.5 * (1.0 / 0.4) * 4.0, 1e-9);
}

TEST(FollowingForceFault, NamesWhatGoesWithIt) {
  std::string text = rocket;
  text.replace(text.find("following = true"), 16, "at = [0.7, -0.2]");
  try {
    const MechanismStudy ran(text);
    FAIL();
  } catch (const InvalidInput& fault) {
    EXPECT_NE(std::string(fault.what()).find("\"at\" goes with following = true"), std::string::npos) << fault.what();
  }
}

}  // namespace
}  // namespace rubato
