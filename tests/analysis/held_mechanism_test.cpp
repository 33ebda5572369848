#include <support/mechanism_study.hpp>

#include <gtest/gtest.h>

namespace rubato {
namespace {

// A bar that a pin and two rods hold, so that nothing is left to move: what rounding leaves of the positions is an
// acceleration over the square of the step, and looked like an error that no shortening lowers.
TEST(HeldMechanism, StandsUnderAutomaticSteps) {
  const testing::MechanismStudy ran(R"toml(
[gravity]
acceleration = [1.0, -3.6]
[[body]]
name = "bar"
position = [-0.391, 0.435]
mass = 1.23
inertia = 0.363
[[joint]]
name = "pin"
type = "revolute"
between = ["bar", "ground"]
at = [-0.383, 0.068]
friction = { coefficient = 0.38, preload = 2.0, radius = 0.29 }
[[joint]]
name = "first rod"
type = "distance"
between = ["ground", "bar"]
at = [0.137, 0.09]
to = [-0.347, -0.061]
[[joint]]
name = "second rod"
type = "distance"
between = ["ground", "bar"]
at = [-0.042, -0.441]
to = [0.104, 0.407]
[[force]]
on = "bar.rz"
expression = "1.96*sin(4.5*t)"
[[analysis]]
name = "run"
type = "transient"
duration = 1.6
step = { tolerance = 4.8e-6, largest = 0.016 }
output = { interval = 0.1 }
)toml",
                                    0);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.last("run", "angle", "bar.rz"), ran.at(0, "run", "angle", "bar.rz"), 1e-9);
}

}  // namespace
}  // namespace rubato
