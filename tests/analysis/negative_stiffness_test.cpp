#include <support/ran_study.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>

// K = [1 c; c 1] has the eigenvalues 1 + c and 1 - c: beyond c = 1 the second motion runs away.
namespace rubato {
namespace {

std::string coupled(double coupling, const std::string& rest) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / fmt::format("rubato_negative_{}", coupling);
  std::filesystem::create_directories(folder);
  const auto write = [&](const std::string& name, const std::string& entries) {
    std::ofstream(folder / name) << "%%MatrixMarket matrix coordinate real symmetric\n2 2 3\n" << entries;
    return "\"" + (folder / name).string() + "\"\n";
  };
  return "[matrices]\nmass = " + write("m.mtx", "1 1 1\n2 1 0\n2 2 1\n") +
         "stiffness = " + write("k.mtx", fmt::format("1 1 1\n2 1 {}\n2 2 1\n", coupling)) +
         "damping = " + write("c.mtx", "1 1 0.1\n2 1 0\n2 2 0.1\n") + "names = [\"a\", \"b\"]\n" + rest;
}

struct Answer {
  analysis::RunReport report;
  testing::MemorySink sink;
};

std::unique_ptr<Answer> answer(const std::string& text) {
  const testing::PreparedStudy study(text);
  auto result = std::make_unique<Answer>();
  testing::QuietProgress progress;
  const std::atomic<bool> stop{false};
  analysis::RunContext context{result->sink, progress, stop};
  result->report = analysis::run_analysis(study.study.analyses.front(), study.input(), context);
  return result;
}

std::string sliders(double stiffness, const std::string& load = "\"N0\"") {
  std::string text;
  for (const std::string on : {"a", "b"})
    text += fmt::format(
        "[[slider]]\nname = \"rub {0}\"\nbetween = [\"{0}\", \"ground\"]\nstiffness = {1}\nfriction_coefficient "
        "= 0.5\nnormal_load = {2}\n",
        on, stiffness, load);
  return text;
}

using ::testing::HasSubstr;

TEST(NegativeStiffness, IsToldOfStaticStates) {
  const std::string rest =
      "[[force]]\non = \"a\"\nexpression = \"1.0\"\n[[analysis]]\nname = \"rest\"\ntype = \"static\"\n";
  const auto stable = answer(coupled(0.5, rest));
  ASSERT_EQ(stable->report.status, analysis::RunStatus::done);
  EXPECT_THAT(stable->report.findings, ::testing::IsEmpty());
  const auto unstable = answer(coupled(2.0, rest));
  ASSERT_EQ(unstable->report.status, analysis::RunStatus::done);
  EXPECT_THAT(unstable->report.findings, ::testing::ElementsAre(HasSubstr("the equilibrium is not stable")));
  EXPECT_NEAR(testing::value_of(unstable->sink, "rest", "position", "b"), 2.0 / 3.0, 1e-12);
  // Sliders that stick hold it: 1 + 4 - 2 > 0.
  const auto held = answer(coupled(2.0, sliders(4.0, "100.0") + rest));
  ASSERT_EQ(held->report.status, analysis::RunStatus::done);
  EXPECT_THAT(held->report.findings, ::testing::IsEmpty());
}

TEST(NegativeStiffness, IsToldAtStaticStartsOfTransients) {
  const std::string rest =
      "[[force]]\non = \"a\"\nexpression = \"1.0\"\n[[analysis]]\nname = \"run\"\ntype = \"transient\"\n"
      "initial = \"static\"\nmethod = \"generalized_alpha\"\nstep = 0.1\nduration = 1.0\n";
  EXPECT_THAT(answer(coupled(0.5, rest))->report.warnings, ::testing::IsEmpty());
  EXPECT_THAT(answer(coupled(2.0, rest))->report.warnings,
              ::testing::Contains(HasSubstr("the equilibrium at the start is not stable")));
}

TEST(NegativeStiffness, IsToldOfSteadyResponses) {
  const std::string head = "[parameters]\nN0 = 1.0\nOmega = 1.0\n",
                    load = "[[force]]\non = \"a\"\namplitude = 1.0\nangular_frequency = \"Omega\"\n";
  const std::string response = load +
                               "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\n"
                               "angular_frequency = { from = 1.0, to = 2.0, points = 5 }\n";
  const std::string curve = load +
                            "[[analysis]]\nname = \"frf\"\ntype = \"damper_curve\"\nparameter = \"N0\"\nrange = "
                            "[0.5, 1.0]\nangular_frequency = { from = 1.0, to = 3.0 }\n";
  for (const std::string& analysis : {response, curve})
    for (const double coupling : {0.5, 2.0})
      for (const double stiffness : {0.25, 4.0}) {
        const auto warnings = answer(head + coupled(coupling, sliders(stiffness) + analysis))->report.warnings;
        const auto told = ::testing::Contains(HasSubstr("the stiffness at rest, with all sliders stuck, is negative"));
        if (1.0 + stiffness < coupling)
          EXPECT_THAT(warnings, told) << analysis;
        else
          EXPECT_THAT(warnings, ::testing::Not(told)) << analysis;
      }
}

}  // namespace
}  // namespace rubato
