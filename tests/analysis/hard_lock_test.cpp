#include "support/mechanism_study.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

// Stops of joints that are springs of any stiffness: what a contact of less than a microsecond makes of the velocity.
namespace rubato::testing {
namespace {

// A rod falls from the horizontal onto a stop at -1 rad and rebounds, again and again: its energy stays.
TEST(HardLock, KeepsTheEnergyToTheToleranceHoweverStiffItIs) {
  const double mass = 1.0, gravity = 9.81, half = 0.5, drop = half * std::sin(1.0);
  for (const char* stiffness : {"1e6", "1e10", "1e14"})
    for (const double tolerance : {1e-3, 1e-4}) {
      const MechanismStudy run(R"toml(
gravity = { acceleration = [0.0, -9.81] }
body = [{ name = "rod", mass = 1.0, inertia = 0.0833, position = [0.5, 0.0] }]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "rod"]
at = [0.0, 0.0]
lock = { at = -1.0, kind = "stop", stiffness = )toml" +
                               std::string(stiffness) + R"toml( }
[[analysis]]
name = "run"
type = "transient"
duration = 3.0
step = { tolerance = )toml" + std::to_string(tolerance) +
                               " }\n");
      const auto& table = run.table("run.energy");
      double largest = 0.0;
      for (const auto& row : table.rows) largest = std::max(largest, std::abs(row[table.column("residue")]));
      EXPECT_LT(largest, 3.0 * tolerance * mass * gravity * drop) << stiffness << " " << tolerance;
      EXPECT_GE(run.table("run.events").rows.size(), 6u);
    }
}

}  // namespace
}  // namespace rubato::testing
