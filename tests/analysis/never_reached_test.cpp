#include "support/mechanism_study.hpp"
#include "support/memory_sink.hpp"
#include "support/prepared_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <vector>

// Stops and latches that a motion does not reach are told, with how near it came and when.
namespace rubato::testing {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> findings_of(const std::string& study) {
  const PreparedStudy prepared(study);
  MemorySink sink;
  QuietProgress progress;
  const std::atomic<bool> stop{false};
  analysis::RunContext context{sink, progress, stop};
  return analysis::run_analysis(prepared.study.analyses.front(), prepared.input(), context).findings;
}

// x = 0.05 sin(2 t) and a stop at 0.06, which it is 0.01 m from at t = pi/4; the other one is met.
TEST(NeverReached, TellsOfAStopOfAStructure) {
  const auto findings = findings_of(R"toml(
coordinate = [{ name = "x", mass = 1.0, velocity = 0.1 }]
spring = [{ between = ["x", "ground"], stiffness = 4.0 }]
stop = [{ name = "far", between = ["x", "ground"], gap = 0.06, stiffness = 10.0 },
        { name = "near", between = ["ground", "x"], gap = 0.02, stiffness = 1.0 }]
[[analysis]]
name = "run"
type = "transient"
method = "average_acceleration"
step = 0.0007853981633974483
duration = 3.0
)toml");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_THAT(findings[0], HasSubstr("the stop \"far\" is never reached: it is nearest at t = 0.7854 s, 0.01 m away"));
}

// A rod swings from the horizontal without friction to the other side, pi below; a latch at -3.5 rad is 0.358 rad off.
TEST(NeverReached, TellsOfALatchOfAMechanism) {
  const std::string rod = R"toml(
gravity = { acceleration = [0.0, -9.81] }
body = [{ name = "rod", mass = 1.0, inertia = 0.0833, position = [0.5, 0.0] }]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "rod"]
at = [0.0, 0.0]
lock = { at = AT, kind = "latch" }
[[analysis]]
name = "run"
type = "transient"
step = { tolerance = 1e-5 }
duration = 3.0
)toml";
  const auto with = [&](const std::string& at) { return std::string(rod).replace(rod.find("AT"), 2, at); };
  const auto findings = run_mechanism_study(with("-3.5")).report.findings;
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_THAT(findings[0], HasSubstr("the latch of \"hinge\" is never reached: it is nearest at t = "));
  EXPECT_THAT(findings[0], HasSubstr(", 0.358"));
  EXPECT_THAT(findings[0], HasSubstr(" rad away"));
  for (const std::string& finding : run_mechanism_study(with("-1.0")).report.findings)
    EXPECT_EQ(finding.find("never"), std::string::npos);
}

}  // namespace
}  // namespace rubato::testing
