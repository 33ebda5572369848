#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/study_text.hpp"

#include <rubato/io/read_study.hpp>

namespace rubato::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Task = model::FrequencyResponseDescription;

/// Lines 1 to 21; what is added follows from line 22 on.
const std::string base =
    "[parameters]\n"                       // 1
    "N0 = 10.0\n"                          // 2
    "Omega = 7.0\n"                        // 3
    "unused = 1.0\n"                       // 4
    "[[coordinate]]\n"                     // 5
    "name = \"blade\"\n"                   // 6
    "mass = 1.0\n"                         // 7
    "[[spring]]\n"                         // 8
    "between = [\"blade\", \"ground\"]\n"  // 9
    "stiffness = 50.0\n"                   // 10
    "[[damper]]\n"                         // 11
    "between = [\"blade\", \"ground\"]\n"  // 12
    "damping = \"0.001 * N0\"\n"           // 13
    "[[force]]\n"                          // 14
    "on = \"blade\"\n"                     // 15
    "amplitude = 20.0\n"                   // 16
    "angular_frequency = \"Omega\"\n"      // 17
    "\n"                                   // 18
    "[[analysis]]\n"                       // 19
    "name = \"frf\"\n"                     // 20
    "type = \"frequency_response\"\n";     // 21

std::string with(const std::string& lines, const std::string& text = base) { return verdict(text + lines); }

const std::string range = "angular_frequency = { from = 6, to = 9, points = 4 }\n";

Task read(const std::string& lines, const std::filesystem::path& folder = ".") {
  return std::get<Task>(io::read_study_text(base + lines, "study.toml", folder).analyses.front().task);
}

TEST(FrequencyResponseStudy, IsReadInEveryForm) {
  EXPECT_EQ(with(range), "accepted");
  EXPECT_EQ(with("angular_frequency = [6, \"Omega\", 9]\n"), "accepted");
  EXPECT_EQ(with("frequency = { from = 1, to = 10, points = 3, spacing = \"log\" }\n"), "accepted");
  EXPECT_EQ(with(range + "sweep = { N0 = { from = 1, to = 100, points = 3, spacing = \"log\" } }\n"), "accepted");
  EXPECT_EQ(with(range + "sweep = { N0 = [1, 2] }\nexcitation = \"Omega\"\nsolver = \"harmonic_balance\"\nstart = "
                         "\"previous\"\ndirection = \"both\"\nobserve = [\"blade\"]\nharmonics = [1, 3]\ntolerance = "
                         "1e-6\nwaveforms = { at = [7, 8], points = 64 }\n"),
            "accepted");
  EXPECT_EQ(with(range + "solver = \"time_marching\"\nmethod = \"average_acceleration\"\nsteps_per_period = 300\n"
                         "max_periods = 1000\nstart = \"rest\"\n"),
            "accepted");
  EXPECT_EQ(with(range + "sweep = { samples = 10, seed = 7, sampling = \"sobol\", parameters = { N0 = { distribution = "
                         "\"normal\", mean = 10, deviation = 1 } } }\n"),
            "accepted");
}

TEST(FrequencyResponseStudy, KeepsTheOrderOfTheSweptParameters) {
  const auto grid = std::get<model::GridSweepDescription>(read(range + "sweep = { b = [1], a = [2] }\n").sweep);
  EXPECT_EQ(grid.parameters[0].first, "b");
  EXPECT_EQ(grid.parameters[1].first, "a");
}

TEST(FrequencyResponseStudy, ReadsCasesFromAFile) {
  const ScratchFolder folder("cases");
  folder.write("cases.csv", "# measured\nN0, unused\n1, 2\n\n3.5e1, +4\n");
  const auto task = read(range + "sweep = { file = \"cases.csv\" }\n", folder.path());
  const auto& cases = std::get<model::CaseSweepDescription>(task.sweep);
  EXPECT_THAT(cases.names, ElementsAre("N0", "unused"));
  EXPECT_THAT(cases.values, ElementsAre(1.0, 2.0, 35.0, 4.0));
}

TEST(FrequencyResponseStudyError, NamesTheLineOfACaseThatIsWrong) {
  const ScratchFolder folder("cases");
  const auto told = [&](const std::string& content) {
    folder.write("cases.csv", content);
    const std::string text = verdict(base + range + "sweep = { file = \"cases.csv\" }\n", folder.path());
    const std::string prefix = (folder.path() / "cases.csv").string();
    return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
  };
  EXPECT_EQ(told("N0\n1\nten\n"), ":3: error: N0 must be a finite number, got \"ten\"");
  EXPECT_EQ(told("N0\n1\ninf\n"), ":3: error: N0 must be a finite number, got \"inf\"");
  EXPECT_EQ(told("N0\n1,2\n"), ":2: error: 2 numbers for 1 parameters; each row gives all of them");
  EXPECT_EQ(told("1\n2\n"), ":1: error: the first row must name the parameters of the columns, got \"1\"");
  EXPECT_EQ(told("N0,N0\n1,2\n"), ":1: error: two columns are called \"N0\"");
  EXPECT_EQ(told("N0\n"), ": error: the list of cases has no rows; it needs a header and a row a case");
  EXPECT_EQ(told("N1\n1\n"),
            "study.toml:23:18: error: analysis \"frf\": sweep names \"N1\", which is no parameter; did you mean "
            "\"N0\"? (known: N0, Omega, unused)");
  std::filesystem::remove(folder.path() / "cases.csv");
  EXPECT_EQ(verdict(base + range + "sweep = { file = \"cases.csv\" }\n", folder.path()),
            "study.toml:23:18: error: the list of cases \"cases.csv\" does not exist");
}

TEST(FrequencyResponseStudyError, RefusesRangesThatHoldNothing) {
  const std::string prefix = "study.toml:22:21: error: analysis \"frf\": angular_frequency";
  EXPECT_EQ(with("angular_frequency = { from = 9, to = 6, points = 4 }\n"),
            prefix + ": the range from 9 to 6 is reversed; write from = 6, to = 9");
  EXPECT_EQ(with("angular_frequency = { from = 6, to = 6, points = 4 }\n"),
            prefix + ": the range from 6 to 6 is empty; give an end above its begin, or points = 1");
  EXPECT_EQ(with("angular_frequency = { from = 6, to = 9, points = 1 }\n"),
            prefix + ": one point cannot be both 6 and 9; give two or more, or a list of one");
  EXPECT_EQ(
      with("angular_frequency = { from = 6, to = 9, points = 0 }\n"),
      "study.toml:22:50: error: analysis \"frf\": angular_frequency: points must be a whole number of at least 1, "
      "got 0");
  EXPECT_EQ(
      with("angular_frequency = { from = 6, to = 9, points = 2.5 }\n"),
      "study.toml:22:50: error: analysis \"frf\": angular_frequency: points must be a whole number of at least 1, "
      "got 2.5");
  EXPECT_EQ(with("angular_frequency = { from = 0, to = 9, points = 4 }\n"), prefix + " must be positive, got 0");
  EXPECT_EQ(with("angular_frequency = { from = -1, to = 9, points = 4, spacing = \"log\" }\n"),
            prefix + ": spacing = \"log\" needs a positive begin, got -1");
  EXPECT_EQ(with("angular_frequency = [7, -8]\n"),
            "study.toml:22:25: error: analysis \"frf\": angular_frequency must be positive, got -8");
  EXPECT_EQ(with("frequency = [7, 7]\n"),
            "study.toml:22:17: error: analysis \"frf\": frequency must rise, got 7 after 7");
  EXPECT_EQ(with("angular_frequency = [\"0/0\"]\n"),
            "study.toml:22:22: error: analysis \"frf\": angular_frequency is nan (from \"0/0\"); give a finite number");
  EXPECT_EQ(with("angular_frequency = 7\n"),
            prefix +
                " must be a list of numbers, or a range such as { from = 1, to = 2, points = 11 }, got the number "
                "7");
  EXPECT_EQ(with(""),
            "study.toml:19:1: error: analysis \"frf\" lacks the key \"angular_frequency\" [rad/s] (or \"frequency\" "
            "[Hz])");
}

TEST(FrequencyResponseStudyError, RefusesSweepsOfWhatIsNotThere) {
  EXPECT_EQ(
      with(range + "sweep = { NO = [1] }\n"),
      "study.toml:23:16: error: analysis \"frf\": sweep names \"NO\", which is no parameter; did you mean \"N0\"? "
      "(known: N0, Omega, unused)");
  EXPECT_EQ(
      with(range + "sweep = { unused = [1] }\n"),
      "study.toml:23:20: error: analysis \"frf\": nothing in the model depends on the swept parameter \"unused\"; "
      "use it there, or leave it out of the sweep");
  EXPECT_EQ(with(range + "sweep = { Omega = [1] }\n"),
            "study.toml:23:19: error: analysis \"frf\": the parameter \"Omega\" takes the frequencies and cannot be "
            "swept at once; give its values as angular_frequency");
  EXPECT_EQ(with(range + "sweep = { }\n"),
            "study.toml:23:9: error: analysis \"frf\": sweep is empty; give values such as { N0 = [10, 20] }, or leave "
            "it out");
  const std::string many = "{ from = 1, to = 2, points = 100000 }";
  EXPECT_EQ(with(range + "sweep = { N0 = " + many + ", Omega = " + many + ", unused = " + many + " }\n"),
            "study.toml:23:9: error: analysis \"frf\": the sweep has 1e+15 combinations, more than can be run (1e+12)");
  EXPECT_EQ(
      with("angular_frequency = { from = 1, to = 2, points = 1e8 }\n"),
      "study.toml:22:21: error: analysis \"frf\": angular_frequency: 1e+08 points are more than can be kept (1e+07)");
  std::string text = base;
  text.replace(text.find("unused = 1.0"), 12, "error = 1.0");
  text.replace(text.find("0.001 * N0"), 10, "error");
  EXPECT_EQ(with(range + "sweep = { error = [1] }\n", text),
            "study.toml:23:19: error: analysis \"frf\": the swept parameter \"error\" would head a column of results "
            "that has another meaning; rename it");
}

TEST(FrequencyResponseStudyError, AsksWhichParameterTakesTheFrequencies) {
  std::string text = base;
  text.replace(text.find("\"Omega\""), 7, "\"N0 * Omega\"");
  EXPECT_EQ(with(range, text),
            "study.toml:19:1: error: analysis \"frf\": several parameters stand in the frequencies of the forces "
            "(\"N0\", \"Omega\"); say which one takes the frequencies: excitation = \"N0\"");
  EXPECT_EQ(with(range + "excitation = \"Omega\"\n", text), "accepted");
  EXPECT_EQ(with(range + "sweep = { N0 = [1, 2] }\n", text), "accepted");
  text = base;
  text.replace(text.find("\"Omega\""), 7, "7.0");
  EXPECT_EQ(with(range, text),
            "study.toml:19:1: error: analysis \"frf\": no parameter drives the forces: write angular_frequency = "
            "\"Omega\" in the [[force]], and Omega = ... in [parameters]");
  EXPECT_EQ(
      with(range + "excitation = \"omega\"\n"),
      "study.toml:23:14: error: analysis \"frf\": excitation names \"omega\", which is no parameter; did you mean "
      "\"Omega\"? (known: N0, Omega, unused)");
  EXPECT_EQ(with(range + "excitation = \"N0\"\n"),
            "study.toml:23:14: error: analysis \"frf\": no force has a frequency that depends on the parameter \"N0\"; "
            "write angular_frequency = \"N0\" in the [[force]]");
}

TEST(FrequencyResponseStudyError, RefusesLoadsThatDoNotRepeat) {
  std::string text = base;
  text.replace(text.find("amplitude = 20.0"), 16, "expression = \"t\"");
  text.erase(text.find("angular_frequency = \"Omega\"\n"), 28);
  EXPECT_EQ(
      with(range, text),
      "study.toml:15:6: error: analysis \"frf\": the force on \"blade\" is a formula of t: a steady response needs "
      "harmonic loads (amplitude, angular_frequency, phase); write it as a sum of them, or run a transient");
  text = base;
  text.insert(text.find("[[analysis]]"),
              "[[force]]\non = \"blade\"\namplitude = 1\nangular_frequency = \"sqrt(2)*Omega\"\n");
  EXPECT_THAT(with(range, text), HasSubstr("the forces have no common period"));
}

TEST(FrequencyResponseStudyError, RefusesSamplesWithoutADistribution) {
  const auto told = [](const std::string& distribution, const std::string& options = "samples = 10") {
    return with(range + "sweep = { " + options + ", parameters = { N0 = " + distribution + " } }\n");
  };
  EXPECT_EQ(told("{ distribution = \"normal\", mean = 1, deviation = 0 }"),
            "study.toml:23:94: error: analysis \"frf\": sweep: N0: deviation must be positive, got 0");
  EXPECT_EQ(told("{ distribution = \"uniform\", from = 2, to = 1 }"),
            "study.toml:23:80: error: analysis \"frf\": sweep: N0: the uniform distribution from 2 to 1 is empty; from "
            "must lie below to");
  EXPECT_EQ(told("{ distribution = \"lognormal\", median = -1, deviation = 1 }"),
            "study.toml:23:84: error: analysis \"frf\": sweep: N0: the median of a lognormal distribution must be "
            "positive, got -1");
  EXPECT_EQ(
      told("{ distribution = \"gauss\" }"),
      "study.toml:23:62: error: analysis \"frf\": sweep: parameters: N0: distribution cannot be \"gauss\"; known: "
      "normal, uniform, lognormal");
  EXPECT_EQ(told("{ distribution = \"uniform\", from = 1, to = 2 }", "samples = 0"),
            "study.toml:23:21: error: analysis \"frf\": sweep: samples must be a whole number of at least 1, got 0");
  EXPECT_EQ(with(range + "sweep = { samples = 5 }\n"),
            "study.toml:23:9: error: analysis \"frf\": sweep: samples need \"parameters\", a distribution for each");
}

TEST(FrequencyResponseStudyError, RefusesOptionsThatDoNotGoTogether) {
  EXPECT_EQ(
      with(range + "solver = \"harmonic_balance\"\nstart = \"rest\"\n"),
      "study.toml:24:9: error: analysis \"frf\": start = \"rest\" is what a march from the start ends with, which "
      "harmonic balance does not know; take another solver, or start = \"unloaded\"");
  EXPECT_EQ(with(range + "direction = \"down\"\n"),
            "study.toml:23:13: error: analysis \"frf\": a direction matters only where a point remembers the one "
            "before; say start = \"previous\", or leave direction out");
  EXPECT_EQ(
      with(range + "steps_per_period = 100\n"),
      "study.toml:23:20: error: analysis \"frf\": \"steps_per_period\" goes with solver = \"time_marching\" only");
  EXPECT_EQ(with(range + "tolerance = 0\n"),
            "study.toml:23:13: error: analysis \"frf\": tolerance must lie between 0 and 1, got 0");
  EXPECT_EQ(with(range + "harmonics = [0]\n"),
            "study.toml:23:14: error: analysis \"frf\": harmonics must be a whole number of at least 1, got 0");
  EXPECT_EQ(with(range + "waveforms = { at = [10] }\n"),
            "study.toml:23:20: error: analysis \"frf\": waveforms: at = 10 lies outside the response from 6 to 9");
  EXPECT_EQ(with(range + "frequency = [1]\n"),
            "study.toml:23:13: error: analysis \"frf\": \"angular_frequency\" and \"frequency\" say the same; keep one "
            "of them");
  EXPECT_EQ(with(range + "solver = \"shooting\"\n"),
            "study.toml:23:10: error: analysis \"frf\": solver cannot be \"shooting\"; known: periodic, "
            "harmonic_balance, time_marching");
}

}  // namespace
}  // namespace rubato::testing
