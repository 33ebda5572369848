#include <support/mechanism_study.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rubato {
namespace {

// What is held passes the load on as it is. A cubic through the reactions at four ends of steps led across the kink of
// a load where nothing moves, and rows beside it were wrong by percents of the load.
TEST(RowsBetweenSteps, TellReactionsUpToTheKinkOfALoad) {
  const testing::MechanismStudy ran(R"(
[[body]]
name = "block"
position = [0.0, 0.0]
mass = 1.0
inertia = 1.0
[[joint]]
name = "bolt"
type = "rigid"
between = ["ground", "block"]
at = [0.0, 0.0]
[[force]]
on = "block.x"
expression = "abs(t - 0.3333) + 0"
[[analysis]]
name = "held"
type = "transient"
duration = 1.0
step = { tolerance = 1e-4, largest = 0.1 }
output = { interval = 0.01 }
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& rows = ran.table("held").rows;
  ASSERT_EQ(rows.size(), 101u);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const double t = ran.at(row, "held", "time");
    EXPECT_NEAR(std::abs(ran.at(row, "held", "reaction_x", "bolt")), std::abs(t - 0.3333), 1e-12) << t;
  }
}

}  // namespace
}  // namespace rubato
