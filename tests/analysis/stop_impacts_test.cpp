#include <support/mechanism_study.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

// Impacts of what stands on other rigid stops: stops press, and none holds what leaves it.
namespace rubato {
namespace {

using testing::MechanismStudy;

/// A bar of 1 kg that stands on a stop below its left end and comes down on one below its right end, each 0.5 m from
/// its centre. It turns about the left stop at 1 rad/s and has 0.01 rad to go, in which it falls by 5 mm at 1 m/s2.
std::string bar(double inertia) {
  const auto stop = [](const char* name, double x, double height) {
    return fmt::format(
        "[[joint]]\nname = \"{}\"\ntype = \"strut\"\nbetween = [\"ground\", \"bar\"]\nat = [{}, -100.0]\nto = [{}, "
        "{}]\nlock = {{ at = 100.0, kind = \"stop\", side = \"above\" }}\n",
        name, x, x, height);
  };
  return fmt::format(R"(
[[body]]
name = "bar"
mass = 1.0
inertia = {}
position = [0.0, 0.005]
angle = 0.01
velocity = [0.0, -0.5]
angular_velocity = -1.0
[gravity]
acceleration = [0.0, -1.0]
[[analysis]]
name = "run"
type = "transient"
duration = 0.02
step = {{ tolerance = 1e-6 }}
output = {{ interval = 0.001 }}
)",
                     inertia) +
         stop("left", -0.5, 0.0) + stop("right", 0.5, 0.01);
}

/// Of the bar as it comes down.
double energy(double inertia) { return 0.5 * (inertia + 0.25) + 0.005; }

// The impulse P at the right end gives the left one P (1/m - b^2/I) upward: a bar of 1 kg m2 leaves its left stop. At
// the right end 1/m + b^2/I = 1.25 per kg take 0.64 of the energy, and 0.6 of the spin is left.
TEST(StopImpacts, LeaveTheStopThatWouldPull) {
  const double inertia = 1.0;
  const MechanismStudy ran(bar(inertia));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& events = ran.table("run.events");
  ASSERT_EQ(events.rows.size(), 3u);  // left locks; right locks, left lets go
  const double at = ran.at(1, "run.events", "time"), speed = std::sqrt(2.0 * energy(inertia) / (inertia + 0.25));
  EXPECT_EQ(ran.at(2, "run.events", "time"), at);
  EXPECT_NEAR(ran.at(1, "run.events", "energy_lost") + ran.at(2, "run.events", "energy_lost"), 0.64 * energy(inertia),
              1e-4);
  // From there it turns about its right stop, by its weight at -0.4 rad/s2.
  EXPECT_NEAR(ran.last("run", "angular_velocity", "bar.rz"), -0.6 * speed + 0.4 * (0.02 - at), 1e-4);
  EXPECT_NEAR(ran.last("run", "velocity", "bar.y"), 0.3 * speed - 0.2 * (0.02 - at), 1e-4);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-6);
}

// A short one of 0.1 kg m2 would go down on its left stop: both take all.
TEST(StopImpacts, KeepTheStopThatIsPressed) {
  const double inertia = 0.1;
  const MechanismStudy ran(bar(inertia));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  ASSERT_EQ(ran.table("run.events").rows.size(), 2u);
  EXPECT_NEAR(ran.at(1, "run.events", "energy_lost"), energy(inertia), 1e-4);
  EXPECT_NEAR(ran.last("run", "angular_velocity", "bar.rz"), 0.0, 1e-9);
  EXPECT_NEAR(ran.last("run", "reaction_lock_force", "left"), 0.5, 1e-4);
  EXPECT_NEAR(ran.last("run", "reaction_lock_force", "right"), 0.5, 1e-4);
}

}  // namespace
}  // namespace rubato
