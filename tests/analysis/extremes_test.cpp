#include "support/ran_study.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

// The least and the largest value of each column at all steps, whatever rows are asked for.
namespace rubato::testing {
namespace {

/// A mass that meets an undamped stop at 0.2 s and leaves it pi/sqrt(k/m) = 0.0199 s later: v sqrt(k m) = 158.1 N
/// act at 0.2099 s.
MemorySink flight(const std::string& steps, const std::string& output) {
  return run_study(R"toml(
coordinate = [{ name = "x", mass = 2.0, velocity = 0.5 }]
stop = [{ name = "wall", between = ["x", "ground"], gap = 0.1, stiffness = 5e4 }]
[[analysis]]
name = "run"
type = "transient"
method = "generalized_alpha"
duration = 0.4
)toml" + steps + output);
}

struct Extreme {
  double least, time_of_least, largest, time_of_largest;
  std::string unit;
};

Extreme extreme_of(const MemorySink& sink, const std::string& column) {
  const auto& table = sink.tables.at("run.extremes");
  const auto& names = table.layout.blocks[0].categories;
  const auto& units = table.layout.blocks[1].categories;
  for (const auto& row : table.rows)
    if (names.at(static_cast<std::size_t>(row[0])) == column)
      return {row[2], row[3], row[4], row[5], units.at(static_cast<std::size_t>(row[1]))};
  throw std::out_of_range(column);
}

TEST(Extremes, TellForcesThatNoRowShows) {
  const std::string equal = "step = 2e-4\n", automatic = "step = { tolerance = 1e-5 }\n";
  for (const std::string& steps : {equal, automatic})
    for (const std::string output : {"output = { interval = 0.05 }\n", "output = { times = [0.1, 0.3] }\n"}) {
      const MemorySink sink = flight(steps, output);
      const auto& rows = sink.tables.at("run");
      for (const auto& row : rows.rows) EXPECT_NEAR(row.at(rows.column("force", "wall")), 0.0, 1e-6);
      const Extreme force = extreme_of(sink, "wall.force"), speed = extreme_of(sink, "x.velocity");
      EXPECT_EQ(force.unit, "N");
      EXPECT_NEAR(std::max(-force.least, force.largest), 0.5 * std::sqrt(1e5), 0.5) << steps << output;
      EXPECT_NEAR(force.largest > -force.least ? force.time_of_largest : force.time_of_least, 0.20993, 1e-3);
      EXPECT_NEAR(speed.least, -0.5, 1e-3);
      EXPECT_NEAR(speed.largest, 0.5, 1e-9);
      EXPECT_LE(speed.time_of_largest, 0.2);
    }
}

// They are those of all steps, to the last bit, and count each step once.
TEST(Extremes, AreThoseOfTheRowsOfAllSteps) {
  const MemorySink all = flight("step = 2e-4\n", ""), few = flight("step = 2e-4\n", "output = { every = 37 }\n");
  const auto& one = all.tables.at("run.extremes");
  EXPECT_EQ(one.rows, few.tables.at("run.extremes").rows);
  const auto& rows = all.tables.at("run");
  double largest = 0.0;
  for (const auto& row : rows.rows) largest = std::max(largest, std::abs(row.at(rows.column("force", "wall"))));
  const Extreme force = extreme_of(all, "wall.force");
  EXPECT_EQ(std::max(-force.least, force.largest), largest);
}

}  // namespace
}  // namespace rubato::testing
