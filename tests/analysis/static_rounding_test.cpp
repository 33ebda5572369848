#include <support/ran_study.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <string>

// Static states whose displacements are lost where the stiffness is rounded, however small the forces that are left.
namespace rubato {
namespace {

std::string two_masses(const std::string& joint) {
  return R"toml(
[[coordinate]]
name = "a"
mass = 1.0
[[coordinate]]
name = "b"
mass = 1.0
)toml" + joint +
         R"toml(
[[spring]]
between = ["b", "ground"]
stiffness = 1.3
[[force]]
on = "a"
expression = "1.3"
[[analysis]]
name = "rest"
type = "static"
)toml";
}

// A soft spring beside one that is 4e13 times as stiff: what is left of it in the sum on the diagonal has two digits.
TEST(StaticRounding, IsToldWhereItTakesTheDisplacements) {
  for (const double stiffness : {1e6, 1e10, 5e13}) {
    const testing::PreparedStudy study(
        two_masses(fmt::format("[[spring]]\nbetween = [\"a\", \"b\"]\nstiffness = {}\n", stiffness)));
    testing::MemorySink sink;
    testing::QuietProgress progress;
    const std::atomic<bool> stop{false};
    analysis::RunContext context{sink, progress, stop};
    const auto report = analysis::run_analysis(study.study.analyses.front(), study.input(), context);
    ASSERT_EQ(report.status, analysis::RunStatus::done);
    const double error = std::abs(testing::value_of(sink, "rest", "position", "a") - 1.0);
    if (stiffness < 1e12) {
      EXPECT_THAT(report.warnings, ::testing::IsEmpty()) << stiffness;
      EXPECT_LT(error, 1e-5);
    } else {
      EXPECT_THAT(report.warnings, ::testing::ElementsAre(::testing::HasSubstr("displacements may err")));
      EXPECT_GT(error, 1e-4);
    }
  }
}

// The flow told nothing of where it started, unlike methods with a step.
TEST(StaticRounding, IsToldByTheFlowThatStartsThere) {
  std::string text = two_masses("[[spring]]\nbetween = [\"a\", \"b\"]\nstiffness = 5e13\n");
  const auto replace = [&](const std::string& old, const std::string& by) {
    text.replace(text.find(old), old.size(), by);
  };
  replace("expression = \"1.3\"", "amplitude = 1.3\nangular_frequency = 1.0");
  replace(
      "type = \"static\"",
      "type = \"transient\"\nmethod = \"exact\"\ninitial = \"static\"\nduration = 1e-6\noutput = { times = [0.0] }");
  const testing::PreparedStudy study(text);
  testing::MemorySink sink;
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  analysis::RunContext context{sink, progress, stop};
  const auto report = analysis::run_analysis(study.study.analyses.front(), study.input(), context);
  EXPECT_THAT(report.warnings, ::testing::ElementsAre(::testing::HasSubstr("at the start displacements may err")));
}

}  // namespace
}  // namespace rubato
