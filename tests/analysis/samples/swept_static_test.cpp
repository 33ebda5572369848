#include "support/sampled_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rubato::analysis {
namespace {

using ::testing::HasSubstr;
using testing::refusal_of;
using testing::SampledStudy;

const char* const hung = R"(
[parameters]
k = 40.0
F = 3.0
[[coordinate]]
name = "near"
mass = 1.0
[[coordinate]]
name = "far"
mass = 1.0
[[spring]]
between = ["near", "ground"]
stiffness = "k"
[[spring]]
between = ["far", "near"]
stiffness = 10.0
[[force]]
on = "far"
expression = "F"
[[analysis]]
name = "rest"
type = "static"
observe = ["far", "far - near"]
)";

TEST(SweptStatic, EverySampleIsTheEquilibriumOfItsOwnSprings) {
  const auto ran = SampledStudy(hung + std::string("sweep = { k = [20, 40], F = [1, 2, 5] }\n")).run();
  ASSERT_EQ(ran.rows("rest").size(), 6u);
  std::size_t row = 0;
  for (const double k : {20.0, 40.0})
    for (const double force : {1.0, 2.0, 5.0}) {
      EXPECT_EQ(ran.value("rest", row, "k"), k);
      EXPECT_EQ(ran.value("rest", row, "F"), force);
      EXPECT_NEAR(ran.value("rest", row, "position", "far"), force / k + force / 10.0, 1e-12);
      EXPECT_NEAR(ran.value("rest", row, "position", "far - near"), force / 10.0, 1e-12);
      ++row;
    }
}

TEST(SweptStatic, ParametersThatFollowASweptOneAreThoseOfTheSample) {
  std::string text = hung;
  text.replace(text.find("F = 3.0"), 7, "F = \"k / 10\"");
  const auto ran = SampledStudy(text + "sweep = { k = [20, 40] }\n").run();
  EXPECT_NEAR(ran.value("rest", 0, "position", "far"), 2.0 / 20.0 + 2.0 / 10.0, 1e-12);
  EXPECT_NEAR(ran.value("rest", 1, "position", "far"), 4.0 / 40.0 + 4.0 / 10.0, 1e-12);
}

TEST(SweptStatic, WhatIsSetOfASweptParameterIsToldToDoNothing) {
  const auto ran = SampledStudy(hung + std::string("sweep = { k = [20, 40] }\n"), {{"k", 7.0}, {"F", 4.0}}).run();
  EXPECT_NEAR(ran.value("rest", 0, "position", "far"), 4.0 / 20.0 + 4.0 / 10.0, 1e-12);
  ASSERT_EQ(ran.report.warnings.size(), 1u);
  EXPECT_THAT(ran.report.warnings.front(),
              HasSubstr("--set k=7 does not change the model of this analysis: the sweep gives"));
}

TEST(SweptStatic, AMechanismIsBuiltAnewForEverySample) {
  // A bar of 2 kg on a hinge with a spring: m g l cos(angle) = k (rest - angle), here with a rest that makes it level.
  const auto ran = SampledStudy(R"(
[parameters]
g = 10.0
k = 100.0
[gravity]
acceleration = [0.0, "-g"]
[[body]]
name = "bar"
mass = 2.0
inertia = 0.1
position = [0.5, 0.0]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "bar"]
at = [0.0, 0.0]
stiffness = "k"
rest = "10 / k"
[[analysis]]
name = "rest"
type = "static"
sweep = { k = [50, 100, 200], g = [10] }
)")
                       .run();
  EXPECT_EQ(ran.report.status, RunStatus::done) << ran.report.message;
  ASSERT_EQ(ran.rows("rest").size(), 3u);
  for (const std::size_t row : {0u, 1u, 2u}) {
    EXPECT_NEAR(ran.value("rest", row, "angle", "hinge"), 0.0, 1e-9);
    EXPECT_NEAR(ran.value("rest", row, "reaction_y", "hinge"), 20.0, 1e-9);
  }
}

TEST(SweptStatic, AnEquilibriumThatIsNotThereIsNoRowOfNumbers) {
  const auto ran = SampledStudy(hung + std::string("sweep = { k = [20, 0] }\n")).run();
  EXPECT_EQ(ran.report.status, RunStatus::done);
  EXPECT_TRUE(std::isnan(ran.value("rest", 1, "position", "far")));
  EXPECT_NE(ran.value("rest", 1, "status"), 0.0);
}

TEST(SweptStatic, HasNoHistories) {
  EXPECT_THAT(refusal_of(hung + std::string("sweep = { k = [1, 2] }\nhistories = true\n")),
              HasSubstr("has no key \"histories\""));
}

}  // namespace
}  // namespace rubato::analysis
