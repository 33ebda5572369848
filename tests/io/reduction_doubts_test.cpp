#include "io/study_text.hpp"

#include <rubato/analysis/prepared_study.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

// What is asked of a reduced model beyond the frequencies that its reduction was judged by is told.
namespace rubato::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::filesystem::path folder = std::filesystem::path(RUBATO_TEST_DATA) / "finite_elements" / "sector";

const std::string sector = R"(
[parameters]
Omega = 1.0
N0 = 1.0
[model]
mesh = "sector.mat.inp"
stiffness = "sector.sti"
mass = "sector.mas"
rows = "sector.dof"
[[slider]]
name = "rim"
between = ["211.x", "ground"]
stiffness = 1e6
friction_coefficient = 1.0
normal_load = "N0"
[[force]]
on = "305.y"
amplitude = 2.0
angular_frequency = "Omega"
)";

/// All that is told before anything runs.
std::vector<std::string> told(const std::string& text) {
  auto study =
      std::make_shared<const model::StudyDescription>(io::read_study_text(sector + text, "study.toml", folder));
  const auto prepared = analysis::prepare(study, {}, study->analyses);
  std::vector<std::string> all;
  for (const auto& doubt : analysis::findings_of(*prepared).doubts) all.push_back(doubt.message);
  for (const auto& planned : prepared->planned)
    all.insert(all.end(), planned.outline.warnings.begin(), planned.outline.warnings.end());
  return all;
}

const std::string response = "[[analysis]]\nname = \"frf\"\ntype = \"frequency_response\"\nobserve = [\"305.y\"]\n";
const std::string curve =
    "[[analysis]]\nname = \"curve\"\ntype = \"damper_curve\"\nobserve = [\"305.y\"]\nparameter = \"N0\"\nrange = "
    "{ from = 1.0, to = 20.0, points = 3 }\n";

// The sixth frequency of the sector, free: 3,816 Hz and more.
TEST(ReductionDoubts, TellOfFrequenciesThatWereNotJudged) {
  const std::string reduced = "[reduction]\nerror = 1e-3\n";
  EXPECT_THAT(told(reduced + response + "frequency = [400.0, 500.0]\n"), IsEmpty());
  EXPECT_THAT(told(reduced + response + "frequency = [400.0, 20000.0]\n"),
              Contains(HasSubstr("it goes up to 20000 Hz, and the errors of [reduction] are estimated up to")));
  EXPECT_THAT(told(reduced + curve + "frequency = { from = 400.0, to = 20000.0 }\n"),
              Contains(HasSubstr("the first 6 frequencies")));
  EXPECT_THAT(told(response + "solver = \"harmonic_balance\"\nfrequency = [400.0, 20000.0]\n"), IsEmpty());
}

TEST(ReductionDoubts, TellOfModesThatWereNotJudged) {
  const std::string modes = "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\nobserve = [\"305.y\"]\ncount = ";
  EXPECT_THAT(told("[reduction]\nerror = 1e-3\n" + modes + "6\n"), IsEmpty());
  EXPECT_THAT(told("[reduction]\nerror = 1e-3\n" + modes + "9\n"),
              Contains(HasSubstr("analysis \"modes\": it asks for 9 modes, and the errors of [reduction] are estimated "
                                 "of the first 6: take frequencies = 9")));
  EXPECT_THAT(told("[reduction]\nerror = 1e-3\nfrequencies = 9\n" + modes + "9\n"), IsEmpty());
}

TEST(ReductionDoubts, TellOfLargeErrors) {
  const std::string modes = "[[analysis]]\nname = \"modes\"\ntype = \"modes\"\nobserve = [\"305.y\"]\ncount = 6\n";
  EXPECT_THAT(told("[reduction]\nmodes = 4\n" + modes),
              Contains(HasSubstr("with 4 modes some of the first 6 frequencies are more than 1 % too high")));
}

}  // namespace
}  // namespace rubato::testing
