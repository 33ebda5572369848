#include "support/ran_study.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <string>

// Transients say what their method made or lost of the energy.
namespace rubato::testing {
namespace {

/// A mass that flies at an undamped stop, 0.2 s away, and is in contact for pi/sqrt(k/m) = 0.0199 s.
std::string flight(const std::string& step) {
  return R"toml(
coordinate = [{ name = "x", mass = 2.0, velocity = 0.5 }]
stop = [{ name = "wall", between = ["x", "ground"], gap = 0.1, stiffness = 5e4 }]
[[analysis]]
name = "run"
type = "transient"
method = "average_acceleration"
duration = 0.4
step = )toml" +
         step + "\n";
}

std::string warning_in(const std::string& study) {
  const PreparedStudy prepared(study);
  MemorySink sink;
  QuietProgress progress;
  const std::atomic<bool> stop{false};
  analysis::RunContext context{sink, progress, stop};
  const auto report = analysis::run_analysis(prepared.study.analyses.front(), prepared.input(), context);
  for (const std::string& warning : report.warnings)
    if (warning.find("energy") != std::string::npos) return warning;
  return "";
}

TEST(ResidueWarning, NamesTheStopThatLostEnergyAndWhen) {
  const std::string warning = warning_in(flight("0.007"));
  EXPECT_NE(warning.find("of the largest energy"), std::string::npos) << warning;
  EXPECT_NE(warning.find("\"wall\" changed"), std::string::npos) << warning;
  EXPECT_NE(warning.find("take a shorter step than 0.007 s"), std::string::npos) << warning;
}

TEST(ResidueWarning, ComesNotWhereTheEnergyStays) {
  EXPECT_EQ(warning_in(flight("0.00005")), "");
  EXPECT_EQ(warning_in(flight("{ tolerance = 1e-3 }")), "");
  // At a constant speed nothing changes but by round-off.
  EXPECT_EQ(warning_in(R"toml(
coordinate = [{ name = "x", mass = 3.7, velocity = 0.123 }]
[[analysis]]
name = "run"
type = "transient"
step = 0.0013
duration = 10.0
)toml"),
            "");
}

}  // namespace
}  // namespace rubato::testing
