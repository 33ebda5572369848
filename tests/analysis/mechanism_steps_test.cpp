#include <support/mechanism_study.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

// Steps of mechanisms that choose themselves: what a long step leaves in velocities and accelerations is no error of
// the steps after it, however short they are.
namespace rubato {
namespace {

using testing::MechanismStudy;

std::string transient(double duration, const std::string& method, const std::string& step) {
  return fmt::format(
      "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nduration = {}\nmethod = {}\nstep = {{ {} }}\n", duration,
      method, step);
}

const std::string finest = "tolerance = 1e-7";

// A top that spins, nods and precesses. Constraints on positions leave velocities that miss them by the order of the
// method. A step much shorter than the last made accelerations G v/(beta h) of that, an error per unit of time that no
// shortening lowers: runs of the controller cardona_cassano ended with a step below the smallest.
TEST(MechanismSteps, OfTheTableOfFourActionsFollowASpinningTop) {
  const std::string top = R"(
[[body]]
name = "top"
mass = 15.0
inertia = [0.234375, 0.46875, 0.234375]
position = [0.0, 1.0, 0.0]
velocity = [1.0, 0.0, 0.0]
angular_velocity = [0.0, 20.0, -1.0]
[[joint]]
name = "foot"
type = "spherical"
between = ["ground", "top"]
at = [0.0, 0.0, 0.0]
[gravity]
acceleration = [0.0, 0.0, -9.81]
)";
  const MechanismStudy reference(top + transient(0.4, "\"generalized_alpha\"", finest));
  ASSERT_EQ(reference.report.status, analysis::RunStatus::done) << reference.report.message;
  const std::pair<std::string, double> cases[] = {{"{ name = \"hht\", alpha = -0.1 }", 1e-4},
                                                  {"\"generalized_alpha\"", 1e-4},
                                                  {"\"damped_newmark\"", 1e-2},
                                                  {"{ name = \"newmark\", beta = 0.4, gamma = 0.7 }", 1e-2}};
  for (const auto& [method, tolerance] : cases) {
    const std::string step =
        fmt::format("tolerance = {}, controller = \"cardona_cassano\", estimator = \"local_error\"", tolerance);
    const MechanismStudy ran(top + transient(0.4, method, step));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << method << ran.report.message;
    for (const char* place : {"top.x", "top.y", "top.z"})
      EXPECT_NEAR(ran.last("run", "position", place), reference.last("run", "position", place), 10.0 * tolerance)
          << method;
  }
}

// Two bars fall about a dry hinge. The fourth step is twenty-five times as long as the first, and the acceleration with
// which it ends stands off equilibrium, across the joints, in proportion to it. That is no error of the next steps:
// they were shortened without an end, down to where accelerations are round-off, and the run ended.
TEST(MechanismSteps, OfFirstOrderPassALongStepBesideADryHinge) {
  const std::string bars = R"(
[[body]]
name = "upper"
mass = 2.0
inertia = 0.05
position = [0.3, 0.0]
[[body]]
name = "lower"
mass = 1.0
inertia = 0.02
position = [0.8, 0.1]
[[joint]]
name = "A"
type = "revolute"
between = ["ground", "upper"]
at = [0.0, 0.0]
friction = { coefficient = 0.3, preload = 40.0, radius = 0.05 }
[[joint]]
name = "B"
type = "revolute"
between = ["upper", "lower"]
at = [0.6, 0.0]
[gravity]
acceleration = [0.0, -9.81]
)";
  const MechanismStudy reference(bars + transient(1.0, "\"generalized_alpha\"", finest));
  ASSERT_EQ(reference.report.status, analysis::RunStatus::done) << reference.report.message;
  for (const double tolerance : {1e-2, 3e-3}) {
    const MechanismStudy ran(bars +
                             transient(1.0, "\"backward_difference\"", fmt::format("tolerance = {}", tolerance)));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << tolerance << ran.report.message;
    for (const char* hinge : {"A", "B"})
      EXPECT_NEAR(ran.last("run", "angle", hinge), reference.last("run", "angle", hinge), 10.0 * tolerance)
          << tolerance;
  }
}

}  // namespace
}  // namespace rubato
