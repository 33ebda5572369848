#include "support/sampled_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

namespace rubato::analysis {
namespace {

using ::testing::HasSubstr;
using testing::MemoryJournal;
using testing::refusal_of;
using testing::SampledStudy;

constexpr double turn = 2.0 * std::numbers::pi;

// A blade of 2 kg whose stiffness grows with the square of the speed: omega^2 = 800 + 1.5 Omega^2.
const char* const blade = R"(
[parameters]
Omega = 0.0
k = 1600.0
[[coordinate]]
name = "blade"
mass = 2.0
[[coordinate]]
name = "rider"
mass = 1.0
[[spring]]
between = ["blade", "ground"]
stiffness = "k + 3 * Omega^2"
[[spring]]
between = ["rider", "ground"]
stiffness = 90000.0
[[damper]]
between = ["blade", "ground"]
damping = 4.0
[[analysis]]
name = "campbell"
type = "modes"
)";

std::string study(const std::string& keys) { return blade + keys; }

double omega(double speed) { return std::sqrt(800.0 + 1.5 * speed * speed); }

TEST(SweptModes, FrequenciesFollowSouthwellsFormulaAtEverySample) {
  const auto ran = SampledStudy(study("sweep = { Omega = { from = 0, to = 40, points = 9 } }\n")).run();
  EXPECT_EQ(ran.report.status, RunStatus::done) << ran.report.message;
  ASSERT_EQ(ran.rows("campbell").size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) {
    const double speed = 5.0 * static_cast<double>(i);
    EXPECT_DOUBLE_EQ(ran.value("campbell", i, "sample"), static_cast<double>(i + 1));
    EXPECT_DOUBLE_EQ(ran.value("campbell", i, "Omega"), speed);
    EXPECT_NEAR(ran.value("campbell", i, "frequency", "mode1"), omega(speed) / turn, 1e-12 * omega(speed));
    EXPECT_NEAR(ran.value("campbell", i, "frequency", "mode2"), 300.0 / turn, 1e-10);
    // c / (2 m omega), with c of the blade
    EXPECT_NEAR(ran.value("campbell", i, "damping_ratio", "mode1"), 4.0 / (2.0 * 2.0 * omega(speed)), 1e-12);
    EXPECT_EQ(ran.value("campbell", i, "status"), 0.0);
  }
  EXPECT_EQ(ran.outline.points, 9.0);
  EXPECT_EQ(ran.outline.summary, "9 samples over Omega: modes, the lowest 2 of the model");
  EXPECT_FALSE(ran.sink.tables.contains("campbell.crossings"));
}

TEST(SweptModes, EngineOrdersMeetFrequenciesWhereTheFormulaSays) {
  // n^2 Omega^2 = 800 + 1.5 Omega^2; in revolutions a minute.
  const auto ran = SampledStudy(study("sweep = { Omega = { from = 0, to = 40, points = 5 } }\n"
                                      "engine_orders = [2, 1.5, 1]\n"))
                       .run();
  // Order 1 lies below the blade at all speeds, whose stiffness grows faster; orders are in the order of the study.
  ASSERT_EQ(ran.rows("campbell.crossings").size(), 2u);
  const std::vector<double> orders{2.0, 1.5};
  for (std::size_t row = 0; row < 2; ++row) {
    const double speed = std::sqrt(800.0 / (orders[row] * orders[row] - 1.5));
    EXPECT_NEAR(ran.value("campbell.crossings", row, "Omega"), speed, 1e-10);
    EXPECT_EQ(ran.value("campbell.crossings", row, "engine_order"), orders[row]);
    EXPECT_EQ(ran.value("campbell.crossings", row, "mode"), 0.0);
    EXPECT_NEAR(ran.value("campbell.crossings", row, "frequency"), orders[row] * speed / turn, 1e-10);
  }
  EXPECT_THAT(ran.report.findings,
              ::testing::ElementsAre(HasSubstr("engine order 2 meets mode1 at Omega = 17.8885 rad/s (5.69"),
                                     HasSubstr("engine order 1.5 meets mode1 at Omega = 32.6599 rad/s (7.79")));
}

TEST(SweptModes, CrossingsAtAPointOfTheSweepAreToldOnce) {
  // Omega = sqrt(320) is a point: inside, at the end, at the begin.
  for (const std::string values : {"[10, \"sqrt(320)\", 30]", "[10, \"sqrt(320)\"]", "[\"sqrt(320)\", 30]"}) {
    const auto ran = SampledStudy(study("sweep = { Omega = " + values + " }\nengine_orders = [2]\n")).run();
    ASSERT_LE(ran.rows("campbell.crossings").size(), 1u) << values;
    if (values != "[10, \"sqrt(320)\"]" || !ran.rows("campbell.crossings").empty()) {
      ASSERT_EQ(ran.rows("campbell.crossings").size(), 1u) << values;
      EXPECT_NEAR(ran.value("campbell.crossings", 0, "Omega"), std::sqrt(320.0), 1e-6) << values;
    }
  }
}

TEST(SweptModes, SpeedsInRevolutionsAMinuteCrossAtTheSameFrequency) {
  std::string text =
      study("sweep = { rpm = { from = 0, to = 400, points = 5 } }\nengine_orders = [2]\nspeed_unit = \"rpm\"\n");
  text.replace(text.find("Omega = 0.0"), 11, "rpm = 0.0\nOmega = \"rpm * pi / 30\"");
  const auto ran = SampledStudy(text).run();
  ASSERT_EQ(ran.rows("campbell.crossings").size(), 1u);
  EXPECT_NEAR(ran.value("campbell.crossings", 0, "frequency"), 2.0 * std::sqrt(320.0) / turn, 1e-10);
  EXPECT_NEAR(ran.value("campbell.crossings", 0, "rpm"), std::sqrt(320.0) * 30.0 / std::numbers::pi, 1e-8);
}

TEST(SweptModes, EachValueOfAnotherParameterHasCrossingsOfItsOwn) {
  const auto ran = SampledStudy(study("sweep = { k = [1600, 2000], Omega = { from = 0, to = 40, points = 5 } }\n"
                                      "engine_orders = [2]\nspeed = \"Omega\"\n"))
                       .run();
  ASSERT_EQ(ran.rows("campbell.crossings").size(), 2u);
  EXPECT_NEAR(ran.value("campbell.crossings", 0, "Omega"), std::sqrt(800.0 / 2.5), 1e-10);
  EXPECT_EQ(ran.value("campbell.crossings", 1, "k"), 2000.0);
  EXPECT_NEAR(ran.value("campbell.crossings", 1, "Omega"), std::sqrt(1000.0 / 2.5), 1e-10);
}

TEST(SweptModes, SlidersGiveBothLimitsTheirColumns) {
  const auto ran = SampledStudy(R"(
[parameters]
kT = 1.0
[[coordinate]]
name = "mass"
mass = 1.0
[[spring]]
between = ["mass", "ground"]
stiffness = 1.0
[[slider]]
name = "contact"
between = ["mass", "ground"]
stiffness = "kT"
friction_coefficient = 0.5
normal_load = 1.0
[[analysis]]
name = "limits"
type = "modes"
sweep = { kT = [3, 8] }
shapes = true
)")
                       .run();
  for (const std::size_t row : {0u, 1u}) {
    EXPECT_NEAR(ran.value("limits", row, "frequency", "free.mode1"), 1.0 / turn, 1e-14);
    EXPECT_NEAR(ran.value("limits", row, "frequency", "stuck.mode1"), (row == 0 ? 2.0 : 3.0) / turn, 1e-14);
  }
  // All columns of the modes of each sample, behind its parameters.
  ASSERT_EQ(ran.rows("limits.modes").size(), 4u);
  EXPECT_EQ(ran.value("limits.modes", 3, "sample"), 2.0);
  EXPECT_EQ(ran.value("limits.modes", 3, "kT"), 8.0);
  EXPECT_NEAR(ran.value("limits.modes", 3, "shape", "mass"), 1.0, 1e-14);
}

TEST(SweptModes, ASampleThatCannotBeKeepsItsRowWithItsReason) {
  const auto ran = SampledStudy(study("sweep = { k = [1600, -1, 2000] }\n")).run();
  EXPECT_EQ(ran.report.status, RunStatus::done);
  ASSERT_EQ(ran.rows("campbell").size(), 3u);
  EXPECT_EQ(ran.value("campbell", 0, "status"), 0.0);
  EXPECT_NE(ran.value("campbell", 1, "status"), 0.0);
  EXPECT_TRUE(std::isnan(ran.value("campbell", 1, "frequency", "mode1")));
  EXPECT_NEAR(ran.value("campbell", 2, "frequency", "mode1"), std::sqrt(1000.0) / turn, 1e-12);
  const auto& failures = ran.sink.tables.at("campbell.failures");
  ASSERT_EQ(failures.rows.size(), 1u);
  EXPECT_EQ(ran.value("campbell.failures", 0, "sample"), 2.0);
  EXPECT_FALSE(failures.layout.blocks.back().categories.front().empty());
  ASSERT_FALSE(ran.report.warnings.empty());
  EXPECT_THAT(ran.report.warnings.back(), HasSubstr("1 of 3 samples have no result; the first, at k = -1: "));
}

TEST(SweptModes, TheFirstSampleNeedNotBePossible) {
  const auto ran = SampledStudy(study("sweep = { k = [-1, 1600] }\n")).run();
  ASSERT_EQ(ran.rows("campbell").size(), 2u);
  EXPECT_TRUE(std::isnan(ran.value("campbell", 0, "frequency", "mode1")));
  EXPECT_NEAR(ran.value("campbell", 1, "frequency", "mode1"), std::sqrt(800.0) / turn, 1e-12);
}

/// All numbers of all tables, bit by bit (not-a-numbers too).
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

constexpr const char* many =
    "sweep = { samples = 400, parameters = { k = { distribution = \"normal\", mean = 100, "
    "deviation = 60 }, Omega = { distribution = \"uniform\", from = 0, to = 9 } } }\n";

TEST(SweptModes, NumbersDoNotDependOnTheNumberOfThreads) {
  const SampledStudy sampled(study(many));
  const auto one = sampled.run(1);
  EXPECT_GT(one.rows("campbell.failures").size(), 5u) << "some stiffness is negative";
  for (const int threads : {2, 5}) EXPECT_EQ(bits_of(sampled.run(threads)), bits_of(one));
}

TEST(SweptModes, AnInterruptedSweepGoesOnFromItsJournal) {
  const SampledStudy sampled(study(many));
  const auto whole = sampled.run(2);
  MemoryJournal journal;
  const auto broken = sampled.run(2, &journal, 150.0);
  EXPECT_EQ(broken.report.status, RunStatus::interrupted);
  EXPECT_THAT(broken.report.message, ::testing::MatchesRegex("interrupted after [0-9]+ of 400 samples"));
  EXPECT_EQ(broken.rows("campbell").size(), journal.pieces.size());
  EXPECT_GE(journal.pieces.size(), 100u);
  EXPECT_LT(journal.pieces.size(), 400u);
  const auto resumed = sampled.run(2, &journal);
  EXPECT_EQ(resumed.report.status, RunStatus::done);
  EXPECT_EQ(bits_of(resumed), bits_of(whole));
  EXPECT_EQ(resumed.report.warnings, whole.report.warnings);
}

TEST(SweptModes, StatisticsOfRandomSamplesAreThoseOfTheirColumns) {
  const auto ran = SampledStudy(study(many)).run();
  const auto& main = ran.sink.tables.at("campbell");
  const std::size_t column = main.column("frequency", "mode1");
  double sum = 0.0, count = 0.0, largest = 0.0;
  for (const auto& row : main.rows) {
    if (std::isnan(row[column])) continue;
    sum += row[column];
    count += 1.0;
    largest = std::max(largest, row[column]);
  }
  const auto& statistics = ran.sink.tables.at("campbell.statistics");
  const std::size_t place = statistics.column("frequency", "mode1");
  EXPECT_NEAR(statistics.rows.front()[place], sum / count, 1e-12 * sum / count);
  EXPECT_EQ(statistics.rows.back()[place], count);
  EXPECT_EQ(statistics.rows[8][place], largest);
}

TEST(SweptModes, RefusesWhatCannotBe) {
  EXPECT_THAT(refusal_of(study("sweep = { Omgea = [1, 2] }\n")),
              HasSubstr("sweep names \"Omgea\", which is no parameter; did you mean \"Omega\"?"));
  EXPECT_THAT(refusal_of(study("sweep = { k = [-1, -2] }\n")), HasSubstr("stiffness"));
  EXPECT_THAT(refusal_of(study("engine_orders = [1]\n")), HasSubstr("are lines over a speed; add sweep = {"));
  EXPECT_THAT(refusal_of(study("shapes = true\n")), HasSubstr("\"shapes\" is of the samples of a sweep; add sweep"));
  EXPECT_THAT(refusal_of(study("sweep = { k = [1, 2] }\nspeed = \"k\"\n")),
              HasSubstr("\"speed\" goes with \"engine_orders\""));
  EXPECT_THAT(refusal_of(study("sweep = { k = [1, 2], Omega = [1, 2] }\nengine_orders = [1]\n")),
              HasSubstr("several parameters are swept; say which one is the speed"));
  EXPECT_THAT(refusal_of(study("sweep = { Omega = [1, 2] }\nengine_orders = [1]\nspeed = \"k\"\n")),
              HasSubstr("speed names \"k\", which is not swept"));
  EXPECT_THAT(refusal_of(study("sweep = { Omega = [1, 2] }\nengine_orders = [0]\n")),
              HasSubstr("an engine order is a positive multiple of the speed, got 0"));
  EXPECT_THAT(refusal_of(study("sweep = { Omega = [-1, 2] }\nengine_orders = [1]\n")),
              HasSubstr("the speed \"Omega\" of a diagram with engine_orders cannot be negative, got -1"));
  EXPECT_THAT(refusal_of(study(std::string(many) + "engine_orders = [1]\nspeed = \"Omega\"\n")),
              HasSubstr("random samples have no order"));
  std::string idle = study("sweep = { idle = [1, 2] }\n");
  idle.replace(idle.find("Omega = 0.0"), 11, "Omega = 0.0\nidle = 1.0");
  EXPECT_THAT(refusal_of(idle),
              HasSubstr("nothing in the model or in this analysis depends on the swept parameter \"idle\""));
}

}  // namespace
}  // namespace rubato::analysis
