#include "support/sampled_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace rubato::analysis {
namespace {

using ::testing::HasSubstr;
using testing::MemoryJournal;
using testing::refusal_of;
using testing::SampledStudy;

const char* const oscillator = R"(
[parameters]
k = 4.0
c = 0.0
T = 4.0
[[coordinate]]
name = "mass"
mass = 1.0
position = 0.5
[[spring]]
between = ["mass", "ground"]
stiffness = "k"
[[damper]]
between = ["mass", "ground"]
damping = "c"
[[analysis]]
name = "swing"
type = "transient"
duration = "T"
)";

TEST(SweptTransient, AnUndampedMassSwingsToItsStartAndBack) {
  const auto ran = SampledStudy(oscillator + std::string("step = 0.001\nmethod = \"fox_goodwin\"\n"
                                                         "sweep = { k = [1, 4, 9] }\n"))
                       .run();
  ASSERT_EQ(ran.rows("swing").size(), 3u);
  for (std::size_t row = 0; row < 3; ++row) {
    const double omega = static_cast<double>(row + 1);
    // A step of 0.001 s: the peak lies within half of it, where cos falls by (omega h)^2 / 8.
    EXPECT_NEAR(ran.value("swing", row, "position_min", "mass"), -0.5, 1e-6);
    const double low = ran.value("swing", row, "position_min_time", "mass");
    EXPECT_NEAR(std::remainder(low - std::numbers::pi / omega, 2.0 * std::numbers::pi / omega), 0.0, 6e-4);
    EXPECT_NEAR(ran.value("swing", row, "velocity_min", "mass"), -0.5 * omega, 2e-6);
    // Which of several equal peaks is the least is a matter of the steps.
    const double time = ran.value("swing", row, "velocity_min_time", "mass"), first = 0.5 * std::numbers::pi / omega;
    EXPECT_NEAR(std::remainder(time - first, 2.0 * std::numbers::pi / omega), 0.0, 6e-4);
    EXPECT_NEAR(ran.value("swing", row, "position_end", "mass"), 0.5 * std::cos(4.0 * omega), 1e-6);
    EXPECT_NEAR(ran.value("swing", row, "energy_kinetic_end"), 0.125 * std::pow(omega * std::sin(4.0 * omega), 2),
                1e-5);
    EXPECT_EQ(ran.value("swing", row, "steps"), 4000.0);
  }
}

TEST(SweptTransient, HistoriesHaveTheBitsOfRunsOfTheirOwn) {
  const std::string keys = "step = { tolerance = 1e-5 }\noutput = { interval = 0.1 }\n";
  const auto swept =
      SampledStudy(oscillator + keys + "histories = true\nsweep = { k = [1, 4], c = [0.1, 0.3] }\n").run();
  const auto& histories = swept.sink.tables.at("swing.histories");
  ASSERT_EQ(histories.rows.size(), 4u * 41u);
  const SampledStudy alone(oscillator + keys, {{"k", 4.0}, {"c", 0.1}});
  const auto single = alone.run();
  const auto& rows = single.rows("swing");
  for (std::size_t i = 0; i < 41; ++i) {
    const auto& row = histories.rows[2 * 41 + i];
    EXPECT_EQ(row[0], 3.0);
    EXPECT_EQ(row[1], 4.0);
    EXPECT_EQ(row[2], 0.1);
    EXPECT_EQ(std::vector<double>(row.begin() + 3, row.end()), rows[i]);
  }
  // Key numbers see every step, not the rows alone.
  const auto every =
      SampledStudy(oscillator + std::string("step = { tolerance = 1e-5 }\n"), {{"k", 4.0}, {"c", 0.1}}).run();
  const auto& steps = every.sink.tables.at("swing");
  double least = 1.0, time = 0.0;
  for (const auto& row : steps.rows)
    if (row[steps.column("position", "mass")] < least) {
      least = row[steps.column("position", "mass")];
      time = row[0];
    }
  EXPECT_EQ(swept.value("swing", 2, "position_min", "mass"), least);
  EXPECT_EQ(swept.value("swing", 2, "position_min_time", "mass"), time);
  // Without histories the key numbers are the same.
  const auto lean = SampledStudy(oscillator + keys + "sweep = { k = [1, 4], c = [0.1, 0.3] }\n").run();
  EXPECT_EQ(lean.rows("swing"), swept.rows("swing"));
  EXPECT_FALSE(lean.sink.tables.contains("swing.histories"));
}

TEST(SweptTransient, AParameterMayStandInTheAnalysisAlone) {
  const auto ran = SampledStudy(oscillator + std::string("step = 0.01\nsweep = { T = [1, 2] }\n")).run();
  EXPECT_EQ(ran.value("swing", 0, "steps"), 100.0);
  EXPECT_EQ(ran.value("swing", 1, "steps"), 200.0);
}

TEST(SweptTransient, ExactTransientsHaveExtremesAtTheirRows) {
  const auto ran = SampledStudy(oscillator + std::string("method = \"exact\"\nsweep = { k = [1, 4] }\n")).run();
  EXPECT_NEAR(ran.value("swing", 1, "position_min", "mass"), -0.5, 1e-3);
  EXPECT_NEAR(ran.value("swing", 1, "position_min_time", "mass"), 0.5 * std::numbers::pi, 0.05);
}

/// A push that grows as exp(rate t): beyond all numbers, before the end, at a rate of 400.
std::string pushed(const std::string& sweep) {
  std::string text = oscillator;
  text.replace(text.find("T = 4.0"), 7, "T = 4.0\nrate = 1.0");
  text.replace(text.find("[[analysis]]"), 0, "[[force]]\non = \"mass\"\nexpression = \"exp(rate * t)\"\n");
  return text + "step = 0.01\n" + sweep;
}

TEST(SweptTransient, AMotionThatGrowsBeyondAllNumbersKeepsItsRowWithItsReason) {
  const auto ran = SampledStudy(pushed("sweep = { rate = [0, 400, 0.1] }\n")).run();
  EXPECT_EQ(ran.report.status, RunStatus::done) << ran.report.message;
  EXPECT_EQ(ran.value("swing", 1, "status"), 1.0);
  EXPECT_TRUE(std::isnan(ran.value("swing", 1, "position_min", "mass")));
  EXPECT_EQ(ran.value("swing", 2, "status"), 0.0);
  ASSERT_EQ(ran.rows("swing.failures").size(), 1u);
  EXPECT_THAT(ran.sink.tables.at("swing.failures").layout.blocks.back().categories.front(), HasSubstr("t = "));
}

TEST(SweptTransient, ASweepOfWhichNothingIsLeftHasFailed) {
  const auto ran = SampledStudy(pushed("sweep = { rate = [400, 500] }\n")).run();
  EXPECT_EQ(ran.report.status, RunStatus::failed);
  EXPECT_THAT(ran.report.message, HasSubstr("no sample has a result; the first, at rate = 400: "));
  EXPECT_EQ(ran.rows("swing").size(), 2u);
}

// A panel on a hinge that a spring turns to its latch at a quarter turn.
const char* const panel = R"(
[parameters]
spring = 2.0
[[body]]
name = "panel"
mass = 4.0
inertia = "4/12"
position = [0.0, 0.5]
[[joint]]
name = "wall"
type = "revolute"
between = ["ground", "panel"]
at = [0.0, 0.0]
stiffness = "spring"
rest = "-0.6*pi"
damping = 0.1
lock = { at = "-pi/2", kind = "latch" }
[[analysis]]
name = "deployment"
type = "transient"
step = { tolerance = 1e-4 }
duration = 6.0
)";

TEST(SweptTransient, LatchesTellWhenTheyLockAndThatTheyDoNot) {
  const auto ran = SampledStudy(panel + std::string("sweep = { spring = [0.02, 1, 2] }\n")).run();
  EXPECT_EQ(ran.value("deployment", 0, "locks_count", "wall"), 0.0);
  EXPECT_TRUE(std::isnan(ran.value("deployment", 0, "locks_first", "wall")));
  for (const std::size_t row : {1u, 2u}) {
    const auto alone = SampledStudy(panel, {{"spring", row == 1 ? 1.0 : 2.0}}).run();
    ASSERT_EQ(alone.rows("deployment.events").size(), 1u);
    EXPECT_EQ(ran.value("deployment", row, "locks_count", "wall"), 1.0);
    EXPECT_EQ(ran.value("deployment", row, "locks_first", "wall"), alone.rows("deployment.events")[0][0]);
    EXPECT_NEAR(ran.value("deployment", row, "angle_end", "wall"), -0.5 * std::numbers::pi, 1e-9);
  }
  EXPECT_LT(ran.value("deployment", 2, "locks_first", "wall"), ran.value("deployment", 1, "locks_first", "wall"));
}

TEST(SweptTransient, EventsOfAJointWithSeveralLocksAreCountedTogether) {
  std::string text = panel;
  const std::string one = "lock = { at = \"-pi/2\", kind = \"latch\" }";
  text.replace(text.find(one), one.size(),
               "lock = [{ at = 0.5, kind = \"stop\" }, { at = \"-pi/2\", kind = \"latch\" }]");
  const auto ran = SampledStudy(text + "sweep = { spring = [1, 2] }\n").run();
  const auto alone = SampledStudy(text, {{"spring", 2.0}}).run();
  ASSERT_EQ(alone.rows("deployment.events").size(), 1u);
  EXPECT_EQ(ran.value("deployment", 1, "locks_count", "wall"), 1.0);
  EXPECT_EQ(ran.value("deployment", 1, "locks_first", "wall"), alone.rows("deployment.events")[0][0]);
  EXPECT_EQ(ran.value("deployment", 1, "lets_go_count", "wall"), 0.0);
}

std::string bits_of(const SampledStudy::Ran& ran) {
  std::string bits;
  for (const auto& [name, table] : ran.sink.tables) {
    bits += name;
    for (const auto& row : table.rows) {
      std::string bytes(row.size() * sizeof(double), '\0');
      std::memcpy(bytes.data(), row.data(), bytes.size());
      bits += bytes;
    }
  }
  return bits;
}

constexpr const char* monte_carlo =
    "output = { interval = 0.5 }\nhistories = true\n"
    "sweep = { samples = 40, parameters = { spring = { distribution = \"normal\", mean = 1, deviation = 0.7 } } }\n";

TEST(SweptTransient, ADeploymentInSamplesHasTheSameBitsOnAnyNumberOfThreads) {
  const SampledStudy sampled(panel + std::string(monte_carlo));
  const auto one = sampled.run(1);
  EXPECT_EQ(bits_of(sampled.run(2)), bits_of(one));
  EXPECT_EQ(bits_of(sampled.run(3)), bits_of(one));
}

TEST(SweptTransient, AnInterruptedDeploymentGoesOnFromItsJournal) {
  const SampledStudy sampled(panel + std::string(monte_carlo));
  const auto whole = sampled.run(2);
  MemoryJournal journal;
  const auto broken = sampled.run(2, &journal, 9.0);
  EXPECT_EQ(broken.report.status, RunStatus::interrupted);
  EXPECT_LT(journal.pieces.size(), 40u);
  EXPECT_GT(journal.pieces.size(), 2u);
  const auto resumed = sampled.run(1, &journal);
  EXPECT_EQ(resumed.report.status, RunStatus::done);
  EXPECT_EQ(bits_of(resumed), bits_of(whole));
}

std::string with_modes(const std::string& of_transient, const std::string& of_modes) {
  return panel + of_transient +
         "[[analysis]]\nname = \"deployed\"\ntype = \"modes\"\nabout = { analysis = \"deployment\", time = 0.5 }\n" +
         of_modes;
}

TEST(SweptTransient, ModesWhereASweptTransientLeadsMustSayOfWhichSample) {
  EXPECT_THAT(
      refusal_of(with_modes("sweep = { spring = [1, 2] }\n", ""), 1),
      HasSubstr("about names \"deployment\", which is repeated over \"spring\": which of its samples is meant is "
                "not said; sweep these modes over \"spring\" too"));
  // At the parameters of each sample the transient is marched again.
  const SampledStudy both(with_modes("sweep = { spring = [1, 2] }\n", "sweep = { spring = [1, 2] }\n"));
  const auto ran = both.run(2, nullptr, -1.0, 1);
  ASSERT_EQ(ran.rows("deployed").size(), 2u);
  // The spring is the stiffness of the hinge: omega^2 = spring / (4/12 + 4/4), less c^2.
  for (const std::size_t row : {0u, 1u})
    EXPECT_NEAR(2.0 * std::numbers::pi * ran.value("deployed", row, "frequency", "mode1"),
                std::sqrt(static_cast<double>(row + 1) / (4.0 / 3.0)), 1e-6);
  EXPECT_EQ(refusal_of(with_modes("", "sweep = { spring = [1, 2] }\n"), 1), "");
}

TEST(SweptTransient, RefusesWhatCannotBe) {
  EXPECT_THAT(refusal_of(oscillator + std::string("step = 0.01\nhistories = true\n")),
              HasSubstr("\"histories\" is of the samples of a sweep; add sweep = { ... }"));
  EXPECT_THAT(refusal_of(oscillator + std::string("step = 0.01\nsweep = { samples = 10 }\n")), HasSubstr("parameters"));
  EXPECT_THAT(refusal_of(oscillator + std::string("step = 0.01\nsweep = { T = [-1, -2] }\n")),
              HasSubstr("duration must be positive, got -1"));
}

}  // namespace
}  // namespace rubato::analysis
