#include "support/mechanism_study.hpp"

#include <gtest/gtest.h>

#include <numbers>

// Runs that are at rest most of their time.
namespace rubato::testing {
namespace {

// Its steps begin shorter than 1e-8 of the run, for ten thousand steps or so, and grow as it comes to rest.
TEST(LongRest, OfADampedPendulumIsReached) {
  const MechanismStudy run(R"toml(
gravity = { acceleration = [0.0, -9.81] }
body = [{ name = "rod", mass = 1.0, inertia = 0.0833, position = [0.5, 0.0] }]
joint = [{ name = "hinge", type = "revolute", between = ["ground", "rod"], at = [0.0, 0.0], damping = 0.5 }]
[[analysis]]
name = "run"
type = "transient"
step = { tolerance = 1e-4 }
duration = 1e4
output = { interval = 1e4 }
)toml");
  EXPECT_NEAR(run.table("run").rows.back()[0], 1e4, 1e-6);
  EXPECT_NEAR(run.last("run", "angle", "hinge"), -0.5 * std::numbers::pi, 1e-4);
}

}  // namespace
}  // namespace rubato::testing
