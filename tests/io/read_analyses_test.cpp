#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/study_text.hpp"

namespace rubato::testing {
namespace {

using ::testing::StartsWith;

/// The verdict when lines are added below the duration (line 42 and on).
std::string verdict_adding(const std::string& lines) { return verdict(study_text + lines); }

TEST(Analysis, TakesEveryWayToNameAMethodAndToChooseOutput) {
  EXPECT_EQ(verdict_adding("method = \"hht\"\noutput = { every = 10 }\n"), "accepted");
  EXPECT_EQ(
      verdict_adding("method = { name = \"newmark\", beta = 0.25, gamma = \"1/2\" }\noutput = { interval = 0.1 }\n"),
      "accepted");
  EXPECT_EQ(verdict_adding("output = { times = [0, 1.0, \"2 * pi\"] }\nobserve = [\"blade\", \"blade - disk\"]\n"),
            "accepted");
  EXPECT_EQ(verdict(edited("step = 0.005", "method = \"exact\"")), "accepted");
}

TEST(AnalysisError, NamesTheTypesThatThereAre) {
  EXPECT_EQ(verdict_with("\"transient\"", "\"transiant\""),
            "study.toml:39:8: error: analysis \"response\": type cannot be \"transiant\"; did you mean \"transient\"? "
            "(known: "
            "transient, method_study, modes, frequency_response, damper_curve, static)");
}

TEST(Analysis, ReadsModes) {
  const auto with = [](const std::string& keys) {
    return verdict(edited("type = \"transient\"\nstep = 0.005\nduration = 60.0\n", "type = \"modes\"\n" + keys));
  };
  EXPECT_EQ(with(""), "accepted");
  EXPECT_EQ(with("count = \"N0 / 5\"\nobserve = [\"blade\", \"blade - disk\"]\n"), "accepted");
  EXPECT_EQ(with("count = 3\n"),
            "study.toml:40:9: error: analysis \"response\": count is 3, but a model of 2 coordinates has 2 modes");
  EXPECT_EQ(with("count = 0\n"),
            "study.toml:40:9: error: analysis \"response\": count must be a whole number of at least 1, got 0");
  EXPECT_EQ(with("step = 0.1\n"),
            "study.toml:40:1: error: analysis \"response\" has no key \"step\"; known: name, type, count, observe, "
            "about, contacts, nodal_diameters, sweep, shapes, engine_orders, speed, speed_unit");
  EXPECT_EQ(with("observe = [\"balde\"]\n"),
            "study.toml:40:12: error: observe names \"balde\", which is no coordinate; did you mean \"blade\"? (known: "
            "disk, blade)");
}

TEST(AnalysisError, AsksForAStepExceptOfTheExactFlow) {
  EXPECT_EQ(
      verdict_with("step = 0.005\n", ""),
      "study.toml:37:1: error: analysis \"response\": the key \"step\" is missing: give its length [s], or step = "
      "{ tolerance = 1e-3 } for steps that choose themselves");
  EXPECT_EQ(verdict_adding("method = \"exact\"\n"),
            "study.toml:40:8: error: analysis \"response\": the method exact takes no step; remove the key, or choose "
            "another "
            "method");
}

TEST(AnalysisError, RefusesStepsAndDurationsOutOfRange) {
  EXPECT_EQ(verdict_with("step = 0.005", "step = -1"),
            "study.toml:40:8: error: analysis \"response\": step must be positive, got -1");
  EXPECT_EQ(verdict_with("duration = 60.0", "duration = 0"),
            "study.toml:41:12: error: analysis \"response\": duration must be positive, got 0");
  EXPECT_EQ(verdict_with("step = 0.005", "step = 61"),
            "study.toml:40:8: error: analysis \"response\": the step 61 s is longer than the duration 60 s");
  EXPECT_EQ(
      verdict_with("step = 0.005", "step = 1e-300"),
      "study.toml:40:8: error: analysis \"response\": 6e+301 steps of 1e-300 s are more than a run can take (1e12)");
}

TEST(AnalysisError, RefusesAStepBeyondTheStabilityLimit) {
  // The limit's digits are the business of tests/integrate.
  EXPECT_THAT(
      verdict(edited("step = 0.005", "method = \"central_difference\"\nstep = 0.5")),
      StartsWith("study.toml:41:8: error: the step 0.5 s is beyond the stability limit of central_difference, "));
}

TEST(AnalysisError, NamesTheMethodAndWhatItTakes) {
  EXPECT_EQ(
      verdict_adding("method = \"damped_newmrk\"\n"),
      "study.toml:42:10: error: unknown method \"damped_newmrk\"; did you mean \"damped_newmark\"? `rubato methods` "
      "lists them");
  EXPECT_EQ(verdict_adding("method = { name = \"hht\", alfa = -0.1 }\n"),
            "study.toml:42:10: error: method \"hht\" has no parameter \"alfa\"; known: alpha");
  EXPECT_EQ(verdict_adding("method = { name = \"hht\", alpha = 0.1 }\n"),
            "study.toml:42:10: error: method \"hht\": alpha must lie in [-1/3, 0], got 0.1");
  EXPECT_EQ(verdict_adding("method = { name = \"newmark\", beta = 0.25 }\n"),
            "study.toml:42:10: error: method \"newmark\" needs the parameter \"gamma\" in [1/2, 10]; write method = { "
            "name = \"newmark\", beta = 0.25, gamma = 0.5 }");
  EXPECT_EQ(
      verdict_adding("method = \"newmark\"\n"),
      "study.toml:42:10: error: method \"newmark\" needs the parameter \"beta\" in [0, 10]; write method = { name = "
      "\"newmark\", beta = 0.25, gamma = 0.5 }");
  EXPECT_EQ(verdict_adding("method = { beta = 0.25 }\n"),
            "study.toml:42:10: error: analysis \"response\": method lacks the key \"name\"");
  EXPECT_EQ(
      verdict_adding("method = 3\n"),
      "study.toml:42:10: error: analysis \"response\": method must be a method's name, or a table such as { name = "
      "\"hht\", alpha = -0.05 }, got the number 3");
}

TEST(AnalysisError, RefusesToObserveWhatIsNotThere) {
  EXPECT_EQ(
      verdict_adding("observe = [\"blade\", \"blde\"]\n"),
      "study.toml:42:21: error: observe names \"blde\", which is no coordinate; did you mean \"blade\"? (known: disk, "
      "blade)");
  EXPECT_EQ(
      verdict_adding("observe = [\"blade - dsk\"]\n"),
      "study.toml:42:12: error: observe names \"dsk\", which is no coordinate; did you mean \"disk\"? (known: disk, "
      "blade)");
  EXPECT_EQ(
      verdict_adding("observe = [\"blade-disk\"]\n"),
      "study.toml:42:12: error: observe names \"blade-disk\", which is no coordinate; known: disk, blade; a difference "
      "is written with spaces, \"a - b\"");
  EXPECT_EQ(verdict_adding("observe = [\"blade\", \"blade\"]\n"),
            "study.toml:42:21: error: analysis \"response\": observe names \"blade\" twice");
  EXPECT_EQ(verdict_adding("observe = \"blade\"\n"), "accepted");
  EXPECT_EQ(verdict_adding("observe = { blade = 1 }\n"),
            "study.toml:42:11: error: analysis \"response\": observe must be the name of a coordinate, got a table");
}

TEST(AnalysisError, RefusesOutputThatCannotBe) {
  EXPECT_EQ(
      verdict_adding("output = { evry = 2 }\n"),
      "study.toml:42:12: error: analysis \"response\": output has no key \"evry\"; did you mean \"every\"? (known: "
      "every, interval, times)");
  EXPECT_EQ(
      verdict_adding("output = { every = 2, interval = 1 }\n"),
      "study.toml:42:10: error: analysis \"response\": output needs exactly one of \"every\" (steps), \"interval\" [s] "
      "and \"times\" [s]");
  EXPECT_EQ(verdict_adding("output = { every = 0 }\n"), "study.toml:42:20: error: every must be at least 1, got 0");
  EXPECT_EQ(verdict_adding("output = { interval = 0 }\n"), "study.toml:42:23: error: interval must be positive, got 0");
  EXPECT_EQ(verdict_adding("output = { interval = 1e-300 }\n"),
            "study.toml:42:23: error: an interval of 1e-300 s makes 6e+301 rows, more than can be written (1e12)");
  EXPECT_EQ(verdict_adding("output = { times = [1, 61] }\n"),
            "study.toml:42:24: error: times: 61 s lies outside the run from 0 s to 60 s");
  EXPECT_EQ(verdict_adding("output = { times = [1, 60.00000000000001] }\n"), "accepted");  // the end, by round-off
  EXPECT_EQ(verdict_adding("output = { times = [1, 60.0000000001] }\n"),
            "study.toml:42:24: error: times: 60.0000000001 s lies outside the run from 0 s to 60 s");
  EXPECT_EQ(verdict_adding("output = { times = [2, 1] }\n"), "study.toml:42:24: error: times must rise, got 1 after 2");
}

TEST(MethodStudyError, WantsALinearModelUnderHarmonicLoads) {
  const std::string study = edited("\"transient\"", "\"method_study\"");
  EXPECT_EQ(
      verdict(study),
      "study.toml:37:1: error: analysis \"response\": a method study needs a linear model with a closed-form response, "
      "this one has 1 slider(s)");
  const std::size_t begin = study.find("[[slider]]"), end = study.find("[[force]]");
  std::string linear = study;
  linear.erase(begin, end - begin);  // seven lines
  EXPECT_EQ(verdict(linear), "accepted");
  EXPECT_EQ(
      verdict(edited("amplitude = 20.0\nangular_frequency = 7.0", "expression = \"t\"", linear)),
      "study.toml:29:1: error: analysis \"response\": a method study needs harmonic loads, whose response has a closed "
      "form");
  EXPECT_EQ(verdict(linear + "observe = \"tip\"\n"),
            "study.toml:35:11: error: observe names \"tip\", which is no coordinate; known: disk, blade");
  EXPECT_EQ(verdict(linear + "methods = [\"rk4\", \"rk5\"]\n"),
            "study.toml:35:19: error: unknown method \"rk5\"; did you mean \"rk3\"? `rubato methods` lists them");
}

TEST(AnalysisError, RefusesAKeyThatItDoesNotKnow) {
  EXPECT_EQ(verdict_adding("start = \"static\"\n"),
            "study.toml:42:1: error: analysis \"response\" has no key \"start\"; known: name, type, method, step, "
            "duration, "
            "output, observe, section_forces, energy, allow_unstable, project_velocities, initial, displacements, "
            "sweep, histories");
}

}  // namespace
}  // namespace rubato::testing
