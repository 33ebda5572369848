#include <support/mechanism_study.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

// Which stops hold where a run starts from its static state, and where modes are of the configuration given.
namespace rubato {
namespace {

using testing::MechanismStudy;

// Thrown up by less than its weight presses in, a block keeps to its elastic stop and swings about its rest there.
TEST(StartsOnStops, KeepWhatIsThrownUpWhereTheyStillPress) {
  const MechanismStudy ran(R"(
[[body]]
name = "block"
mass = 1.0
inertia = 1.0
position = [0.0, 0.0]
velocity = [0.0, 0.2]
[[joint]]
name = "guide"
type = "prismatic"
between = ["ground", "block"]
at = [0.0, 0.0]
axis = [0.0, 1.0]
displacement = 0.01
lock = { at = 0.0, kind = "stop", stiffness = 1000.0 }
[gravity]
acceleration = [0.0, -10.0]
[[analysis]]
name = "run"
type = "transient"
initial = "static"
duration = 0.3
step = { tolerance = 1e-7 }
output = { interval = 0.05 }
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_TRUE(ran.report.warnings.empty()) << ran.report.warnings.front();
  const double omega = std::sqrt(1000.0);
  for (std::size_t row = 0; row < ran.table("run").rows.size(); ++row) {
    const double t = ran.at(row, "run", "time");
    EXPECT_NEAR(ran.at(row, "run", "displacement", "guide"), -0.01 + 0.2 / omega * std::sin(omega * t), 1e-6) << t;
  }
}

// Two blocks of 1 kg that are one, pressed on a rigid stop by a spring of 10 N/m: only what they do together leads
// away.
TEST(StartsOnStops, AreLeftByTheVelocitiesThatTheJointsAllow) {
  const auto blocks = [](const std::string& first, const std::string& second) {
    const auto body = [](const std::string& name, const std::string& velocity) {
      return "[[body]]\nname = \"" + name + "\"\nmass = 1.0\ninertia = 1.0\nposition = [0.0, 0.0]\nvelocity = [0.0, " +
             velocity + "]\n";
    };
    return body("first", first) + body("second", second) + R"(
[[joint]]
name = "guide"
type = "prismatic"
between = ["ground", "first"]
at = [0.0, 0.0]
axis = [0.0, 1.0]
stiffness = 10.0
rest = -0.1
lock = { at = 0.0, kind = "stop", side = "above" }
[[joint]]
name = "weld"
type = "rigid"
between = ["first", "second"]
at = [0.0, 0.0]
[[analysis]]
name = "run"
type = "transient"
initial = "static"
duration = 1.0
step = { tolerance = 1e-7 }
)";
  };
  const MechanismStudy up(blocks("-1.0", "3.0")), down(blocks("1.0", "-3.0"));
  ASSERT_EQ(up.report.status, analysis::RunStatus::done) << up.report.message;
  ASSERT_EQ(down.report.status, analysis::RunStatus::done) << down.report.message;
  const double omega = std::sqrt(5.0);
  EXPECT_NEAR(up.last("run", "displacement", "guide"), std::sin(omega) / omega - 0.1 + 0.1 * std::cos(omega), 1e-5);
  EXPECT_NEAR(up.at(0, "run.energy", "kinetic"), 1.0, 1e-12);
  EXPECT_NEAR(down.last("run", "displacement", "guide"), 0.0, 1e-12);
  EXPECT_NEAR(down.at(0, "run.energy", "kinetic"), 0.0, 1e-12);
}

// Modes are of what stands still: the spring presses the block against its stop, or takes it off, by 100 N.
TEST(StartsOnStops, OfModesAreNotDecidedByVelocities) {
  const auto squares = [](const char* rest_length, const char* velocity) {
    const MechanismStudy ran(fmt::format(R"(
[[body]]
name = "block"
mass = 1.0
inertia = 1.0
position = [0.0, 0.0]
velocity = [0.0, {}]
[[joint]]
name = "guide"
type = "prismatic"
between = ["ground", "block"]
at = [0.0, 0.0]
axis = [0.0, 1.0]
stiffness = 100.0
rest = {}
lock = {{ at = 0.0, kind = "stop", side = "above" }}
[[analysis]]
name = "modes"
type = "modes"
)",
                                         velocity, rest_length));
    EXPECT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const auto found = ran.sink.tables.find("modes");
    return found == ran.sink.tables.end() ? 0u : found->second.rows.size();
  };
  for (const char* velocity : {"1.0", "0.0", "-1.0"}) {
    EXPECT_EQ(squares("-1.0", velocity), 0u) << velocity;
    EXPECT_EQ(squares("1.0", velocity), 1u) << velocity;
  }
}

}  // namespace
}  // namespace rubato
