#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/study_text.hpp"

#include <rubato/io/read_study.hpp>

namespace rubato::testing {
namespace {

/// Lines 1 to 24; what is added follows from line 25 on.
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
    "[[slider]]\n"                         // 11
    "name = \"contact\"\n"                 // 12
    "between = [\"blade\", \"ground\"]\n"  // 13
    "stiffness = 10.0\n"                   // 14
    "friction_coefficient = 0.5\n"         // 15
    "normal_load = \"N0\"\n"               // 16
    "[[force]]\n"                          // 17
    "on = \"blade\"\n"                     // 18
    "amplitude = 20.0\n"                   // 19
    "angular_frequency = \"Omega\"\n"      // 20
    "\n"                                   // 21
    "[[analysis]]\n"                       // 22
    "name = \"damper\"\n"                  // 23
    "type = \"damper_curve\"\n";           // 24

std::string with(const std::string& lines, const std::string& text = base) { return verdict(text + lines); }

const std::string over = "parameter = \"N0\"\n";                                   // 25
const std::string range = "range = { from = 1, to = 100, points = 4 }\n";          // 26
const std::string frequencies = "angular_frequency = { from = 6.0, to = 9.0 }\n";  // 27
const std::string title = "error: analysis \"damper\": ";

TEST(DamperCurveStudy, IsReadInEveryForm) {
  EXPECT_EQ(with(over + range + frequencies), "accepted");
  EXPECT_EQ(with(over + "range = [1, \"N0\", 40]\nfrequency = { from = 1, to = \"pi / 2\", points = 33 }\n"),
            "accepted");
  EXPECT_EQ(with(over + range + frequencies +
                 "observe = \"blade\"\nobjective = \"dissipated\"\nexcitation = \"Omega\"\nsweep = { unused = [1] }\n"),
            "study.toml:31:20: " + title +
                "nothing in the model depends on the swept parameter \"unused\"; use it there, or leave it out of the "
                "sweep");
  EXPECT_EQ(with(over + range + frequencies + "observe = [\"blade\"]\nobjective = \"amplitude\"\n"), "accepted");
}

TEST(DamperCurveStudyError, NamesWhatIsMissing) {
  EXPECT_EQ(with(range + frequencies), "study.toml:22:1: error: analysis \"damper\" lacks the key \"parameter\"");
  EXPECT_EQ(
      with(over + frequencies),
      "study.toml:22:1: error: analysis \"damper\" lacks the key \"range\": the values of N0, such as { from = 1, "
      "to = 100, points = 40 }");
  EXPECT_EQ(with(over + range),
            "study.toml:22:1: error: analysis \"damper\" lacks the key \"angular_frequency\" [rad/s] (or \"frequency\" "
            "[Hz])");
  EXPECT_EQ(with(over + range + frequencies + "points = 3\n"),
            "study.toml:28:1: error: analysis \"damper\" has no key \"points\"; known: name, type, parameter, range, "
            "frequency, angular_frequency, excitation, sweep, objective, solver, tolerance, about, optimum, observe");
}

TEST(DamperCurveStudyError, RefusesParametersThatCannotBe) {
  EXPECT_EQ(with("parameter = \"N1\"\n" + range + frequencies),
            "study.toml:25:13: " + title +
                "parameter names \"N1\", which is no parameter; did you mean \"N0\"? (known: N0, Omega, unused)");
  EXPECT_EQ(with("parameter = \"unused\"\n" + range + frequencies),
            "study.toml:25:13: " + title +
                "nothing in the model depends on the parameter \"unused\"; use it there, or leave it out of the "
                "analysis");
  EXPECT_EQ(with("parameter = \"Omega\"\nexcitation = \"Omega\"\n" + range + frequencies),
            "study.toml:25:13: " + title +
                "the parameter \"Omega\" takes the frequencies and cannot be swept at once; give its values as "
                "angular_frequency");
  EXPECT_EQ(with(over + range + frequencies + "sweep = { N0 = [1, 2] }\n"),
            "study.toml:28:16: " + title +
                "the curve is over \"N0\", which cannot be swept at once; give its values as range");
}

TEST(DamperCurveStudyError, RefusesRangesThatHoldNothing) {
  EXPECT_EQ(with(over + "range = [1, 3, 2]\n" + frequencies),
            "study.toml:26:16: " + title + "range must rise, got 2 after 3");
  EXPECT_EQ(with(over + "range = { from = 9, to = 1, points = 5 }\n" + frequencies),
            "study.toml:26:9: " + title + "range: the range from 9 to 1 is reversed; write from = 1, to = 9");
  EXPECT_EQ(
      with(over + range + "angular_frequency = { from = 9, to = 6 }\n"),
      "study.toml:27:21: " + title + "angular_frequency: the range from 9 to 6 is reversed; write from = 6, to = 9");
  EXPECT_EQ(
      with(over + range + "angular_frequency = { from = 6, to = 6 }\n"),
      "study.toml:27:21: " + title + "angular_frequency: the range from 6 to 6 is empty; give an end above its begin");
  EXPECT_EQ(with(over + range + "frequency = { from = 0, to = 6 }\n"),
            "study.toml:27:13: " + title + "frequency: from must be positive, got 0");
  EXPECT_EQ(with(over + range + "angular_frequency = { from = 6, to = 9, points = 2 }\n"),
            "study.toml:27:50: " + title +
                "angular_frequency: points, scanned for peaks, must be a whole number from 3 to a million, got 2");
  EXPECT_EQ(with(over + range + "angular_frequency = [6, 9]\n"),
            "study.toml:27:21: error: analysis \"damper\": angular_frequency must be a range in which peaks are looked "
            "for, such as { from = 7.0, to = 8.5 }, got a list of 2");
}

TEST(DamperCurveStudyError, RefusesObjectivesThatTheModelLacks) {
  EXPECT_EQ(with(over + range + frequencies + "objective = \"amplitud\"\n"),
            "study.toml:28:13: error: analysis \"damper\": objective cannot be \"amplitud\"; did you mean "
            "\"amplitude\"? (known: amplitude, dissipated)");
  EXPECT_EQ(with(over + range + frequencies + "observe = \"balde\"\n"),
            "study.toml:28:11: error: observe names \"balde\", which is no coordinate; did you mean \"blade\"? (known: "
            "blade)");
  EXPECT_EQ(with(over + range + frequencies + "observe = []\n"),
            "study.toml:22:1: " + title + "observe is empty: the curve needs an amplitude; name a coordinate");
  std::string text = base;
  text.erase(text.find("[[slider]]"), text.find("[[force]]") - text.find("[[slider]]"));
  text.replace(text.find("amplitude = 20.0"), 16, "amplitude = \"N0\"");
  EXPECT_EQ(with(over + range + frequencies + "objective = \"dissipated\"\n", text),
            "study.toml:22:13: " + title + "objective = \"dissipated\" needs sliders, and the model has none");
}

}  // namespace
}  // namespace rubato::testing
