#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/study_text.hpp"

namespace rubato::testing {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// The verdict on `step = { ... }` in line 40, with a method or other lines after the duration.
std::string verdict_on(const std::string& step, const std::string& lines = "") {
  return verdict(edited("step = 0.005", "step = { " + step + " }") + lines);
}

TEST(AutomaticStep, TakesEveryControllerWithEveryEstimatorThatSuitsTheMethod) {
  EXPECT_EQ(verdict_on("tolerance = 1e-3"), "accepted");
  for (const std::string controller : {"\"pi\"", "\"cardona_cassano\"", "\"fixed\", first = 0.01"})
    for (const std::string estimator : {"\"local_error\"", "\"inertia_jump\", reference = \"2*sqrt(2)\""})
      for (const std::string method :
           {"hht", "wbz", "generalized_alpha", "average_acceleration", "damped_newmark", "wilson_theta"}) {
        const bool is_of_first_order = method == "damped_newmark";  // which inertia_jump cannot judge
        EXPECT_THAT(verdict_on("tolerance = 1e-3, controller = " + controller + ", estimator = " + estimator,
                               "method = \"" + method + "\"\n"),
                    is_of_first_order && estimator != "\"local_error\"" ? EndsWith("take the estimator local_error")
                                                                        : EndsWith("accepted"));
      }
  for (const std::string method : {"wilson_theta", "bogacki_shampine", "dormand_prince"})
    EXPECT_EQ(verdict_on("tolerance = \"N0/1e4\", events = \"locate\"", "method = \"" + method + "\"\n"), "accepted");
}

TEST(AutomaticStepError, NeedsAToleranceInItsRange) {
  EXPECT_EQ(verdict_on("first = 1e-3"),
            "study.toml:40:8: error: analysis \"response\": step lacks the key \"tolerance\"");
  EXPECT_EQ(
      verdict_on("tolerence = 1e-3"),
      "study.toml:40:10: error: analysis \"response\": step has no key \"tolerence\"; did you mean \"tolerance\"?");
  EXPECT_EQ(verdict_on("tolerance = 0"),
            "study.toml:40:22: error: analysis \"response\": step: the tolerance must be positive, got 0");
  EXPECT_THAT(verdict_on("tolerance = nan"), StartsWith("study.toml:40:22: error: "));
  EXPECT_EQ(verdict_on("tolerance = 1e-15"),
            "study.toml:40:22: error: analysis \"response\": step: the tolerance 1e-15 is below the round-off of a "
            "march; the least is 1e-13");
  EXPECT_EQ(
      verdict_on("tolerance = 1.5"),
      "study.toml:40:22: error: analysis \"response\": step: the tolerance 1.5 is no error at all: it is relative "
      "to the size of the response and must be below 1");
  // The paper's is a share of modes and may be larger.
  EXPECT_EQ(verdict_on("tolerance = 10, estimator = \"inertia_jump\", reference = 1"), "accepted");
}

TEST(AutomaticStepError, NamesWhatThereIs) {
  EXPECT_EQ(verdict_on("tolerance = 1e-3, controller = \"pid\""),
            "study.toml:40:41: error: analysis \"response\": step: controller cannot be \"pid\"; did you mean \"pi\"? "
            "(known: pi, cardona_cassano, fixed)");
  EXPECT_THAT(verdict_on("tolerance = 1e-3, estimator = \"error\""),
              EndsWith("known: local_error, inertia_jump, embedded"));
  EXPECT_THAT(verdict_on("tolerance = 1e-3, events = \"find\""), EndsWith("known: locate, pass"));
}

TEST(AutomaticStepError, KeepsTheStepsInOrder) {
  EXPECT_EQ(verdict_on("tolerance = 1e-3, largest = -1"),
            "study.toml:40:38: error: analysis \"response\": step: largest must be positive, got -1");
  EXPECT_EQ(
      verdict_on("tolerance = 1e-3, smallest = 0.1, largest = 0.01"),
      "study.toml:40:39: error: analysis \"response\": step: the smallest step 0.1 s is beyond the largest, 0.01 s");
  EXPECT_EQ(verdict_on("tolerance = 1e-3, first = 0.1, largest = 0.01"),
            "study.toml:40:36: error: analysis \"response\": step: the first step 0.1 s lies outside the range from "
            "6e-11 s to 0.01 s");
  EXPECT_THAT(verdict_on("tolerance = 1e-3, controller = \"fixed\""),
              EndsWith("the controller fixed keeps the first step; give it, first = ... [s]"));
}

TEST(AutomaticStepError, SaysWhichEstimatorSuitsTheMethod) {
  EXPECT_EQ(verdict_on("tolerance = 1e-3", "method = \"rk4\"\n"),
            "study.toml:40:22: error: analysis \"response\": step: the estimator embedded compares two solutions of a "
            "step, and rk4 has one; take the method bogacki_shampine or dormand_prince");
  EXPECT_THAT(verdict_on("tolerance = 1e-3, estimator = \"local_error\"", "method = \"dormand_prince\"\n"),
              EndsWith("and dormand_prince carries none; take the estimator embedded"));
  EXPECT_THAT(verdict_on("tolerance = 1e-3, estimator = \"embedded\""), EndsWith("take the estimator local_error"));
  EXPECT_THAT(verdict_on("tolerance = 1e-3", "method = \"exact\"\n"), HasSubstr("the method exact takes no step"));
  EXPECT_THAT(verdict_on("tolerance = 1e-3", "method = \"exponential\"\n"),
              EndsWith("and exponential has one; take a fixed step, or the method generalized_alpha"));
}

// The study starts from rest: its initial displacements are no measure.
TEST(AutomaticStepError, AsksForAReferenceWhereTheStartHasNone) {
  EXPECT_THAT(verdict_on("tolerance = 1e-3, controller = \"cardona_cassano\""),
              HasSubstr("give the reference value as a number"));
  EXPECT_THAT(verdict_on("tolerance = 1e-3, reference = \"initial\""),
              EndsWith("belong to the estimator inertia_jump"));
  EXPECT_THAT(verdict_on("tolerance = 1e-3, controller = \"cardona_cassano\", reference = -2"),
              StartsWith("study.toml:40:72: error: "));
}

TEST(AutomaticStepError, KeepsExplicitMethodsStable) {
  EXPECT_EQ(verdict_on("tolerance = 1e-3", "method = \"dormand_prince\"\n"), "accepted");
  EXPECT_THAT(verdict_on("tolerance = 1e-3, largest = 0.5", "method = \"dormand_prince\"\n"),
              HasSubstr("largest = 0.5 s is beyond the stability limit of dormand_prince, "));
}

}  // namespace
}  // namespace rubato::testing
