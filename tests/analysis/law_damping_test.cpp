#include <rubato/analysis/run_study.hpp>

#include "support/memory_sink.hpp"
#include "support/prepared_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <vector>

// Damping by modes of the structure without its laws.
namespace rubato::analysis {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The warnings of a transient of 1 kg, and of nothing else.
std::vector<std::string> warnings(const std::string& rest) {
  const testing::PreparedStudy prepared(
      "[[coordinate]]\nname = \"mass\"\nmass = 1.0\nvelocity = 1.0\n" + rest +
      "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = 0.01\nduration = 0.1\n");
  testing::MemorySink sink;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  RunContext context{sink, progress, stop};
  const auto& analysis = prepared.study.analyses.front();
  const RunReport report = run_analysis(analysis, prepared.input(), context);
  EXPECT_EQ(report.warnings, check_analysis(analysis, prepared.input()).warnings);
  return report.warnings;
}

const std::string modal = "[damping]\nmodal_ratio = 0.02\n";
const std::string foot = "[[bouc_wen]]\nname = \"foot\"\nbetween = [\"mass\", \"ground\"]\nstiffness = 5.0\n";

TEST(LawDamping, WarnsWhereAModalRatioDampsNothing) {
  EXPECT_THAT(warnings(modal + foot),
              ElementsAre(HasSubstr("nothing resists a motion of \"mass\": that motion is not damped")));
}

TEST(LawDamping, SaysNothingWhereItDamps) {
  const std::string spring = "[[spring]]\nbetween = [\"mass\", \"ground\"]\nstiffness = 5.0\n";
  EXPECT_THAT(warnings(modal + foot + spring), IsEmpty());
  EXPECT_THAT(warnings(modal), IsEmpty());  // what floats has nothing to damp
  EXPECT_THAT(warnings("[damping]\nrayleigh = { mass = 0.1 }\n" + foot), IsEmpty());
  EXPECT_THAT(warnings(foot), IsEmpty());
}

}  // namespace
}  // namespace rubato::analysis
