#include <rubato/core/error.hpp>

#include <support/mechanism_study.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::MechanismStudy;

/// Two bars that hang; a moment turns the lower one by 1 rad against the upper one, where it latches.
std::string bars(const std::string& about) {
  return R"(
[[body]]
name = "upper"
mass = 2.0
inertia = 0.2
position = [0.0, -0.5]
[[body]]
name = "lower"
mass = 1.0
inertia = 0.1
position = [0.0, -1.4]
[[joint]]
name = "pin"
type = "revolute"
between = ["ground", "upper"]
at = [0.0, 0.0]
damping = 0.5
[[joint]]
name = "hinge"
type = "revolute"
between = ["upper", "lower"]
at = [0.0, -1.0]
moment = 8.0
lock = { at = 1.0, kind = "latch" }
[gravity]
acceleration = [0.0, -9.81]
[[analysis]]
name = "opening"
type = "transient"
step = { tolerance = 1e-4 }
duration = 2.0
[[analysis]]
name = "modes"
type = "modes"
about = )" +
         about;
}

// Latched, the bars are one body: a compound pendulum about the pin.
TEST(ReachedModes, AreThoseOfBarsThatHaveLatched) {
  const MechanismStudy ran(bars("{ analysis = \"opening\", static = true }"), 1);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double x = 0.4 * std::sin(1.0), y = -1.0 - 0.4 * std::cos(1.0);
  const double inertia = 0.2 + 2.0 * 0.25 + 0.1 + x * x + y * y, weight = 9.81 * std::hypot(x, -1.0 + y);
  ASSERT_EQ(ran.table("modes").rows.size(), 1u);
  EXPECT_NEAR(ran.at(0, "modes", "angular_frequency"), std::sqrt(weight / inertia), 1e-7);
  EXPECT_NEAR(ran.at(0, "modes", "damping_ratio"), 0.5 / (2.0 * std::sqrt(weight * inertia)), 1e-7);
  EXPECT_THAT(ran.report.findings.at(0), HasSubstr("about the equilibrium next to where \"opening\" is at t = 2 s"));
}

// Before the latch both bars move: two modes about a configuration that is told to be no equilibrium.
TEST(ReachedModes, HoldStillWhatMoves) {
  const MechanismStudy ran(bars("{ analysis = \"opening\", time = 0.05 }"), 1);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_EQ(ran.table("modes").rows.size(), 2u);
  ASSERT_EQ(ran.report.warnings.size(), 2u);
  EXPECT_THAT(ran.report.warnings[0],
              HasSubstr("and is held still: what its speed adds, centrifugal and Coriolis forces"));
  EXPECT_THAT(ran.report.warnings[1], HasSubstr("is no equilibrium"));
}

TEST(ReachedModesFault, NamesWhatIsWrong) {
  const auto says = [](const std::string& about, const std::string& expected) {
    try {
      const MechanismStudy ran(bars(about), 1);
      FAIL() << "ran: " << ran.report.message;
    } catch (const InvalidInput& fault) {
      EXPECT_THAT(fault.what(), HasSubstr(expected));
    }
  };
  says("{ analysis = \"openin\" }",
       "about names \"openin\", which is no transient of this study; did you mean \"opening\"");
  says("{ analysis = \"modes\" }", "which is no transient of this study");
  says("{ analysis = \"opening\", time = 3.0 }", "time must lie within the 2 s of \"opening\", got 3");
  says("{ analysis = \"opening\", time = -1.0 }", "time must lie within");
  says("{ time = 1.0 }", "lacks the key \"analysis\"");
}

}  // namespace
}  // namespace rubato
