#include <support/laid_steps.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

// Drives that stand for a while, with friction on what they hold: the drive carries whatever acts, and nothing tells
// what friction does meanwhile. It does nothing, and all it can as the drive moves on.
namespace rubato {
namespace {

using testing::in_plane;
using testing::MechanismStudy;
using testing::transient;

constexpr double limit = 5.0;  // of friction [N]
constexpr int kinds_of_steps = 3;

/// A block of 2 kg that a strut of 1 m moves along a dry guide, under a load that swings by 20 N.
std::string driven_block(const std::string& drive) {
  return testing::block_in_guide(in_plane, 0.0, "friction = { coefficient = 0.5, preload = 10.0 }") +
         "[[joint]]\nname = \"motor\"\ntype = \"strut\"\nbetween = [\"ground\", \"block\"]\nat = [-1.0, 0.0]\n"
         "to = [0.0, 0.0]\ndrive = " +
         drive + "\n[[force]]\non = \"block.x\"\nexpression = \"20*sin(30*t)\"\n";
}

void expect_friction_along(const std::string& drive, double way) {
  for (int kind = 0; kind < kinds_of_steps; ++kind) {
    const MechanismStudy ran(driven_block(drive) + transient(testing::step_of_kind(kind, "0.004", "1e-5"), 2.0));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << drive << ' ' << ran.report.message;
    EXPECT_LT(ran.table("run").rows.size(), 5000u) << drive;
    EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), limit * way, 1e-5 * limit * way) << drive << kind;
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-4) << drive;
    const auto& table = ran.table("run");
    std::size_t standing = 0;
    for (const auto& row : table.rows) {
      const double force = row[table.column("friction_force", "guide")];
      standing += force == 0.0 ? 1 : 0;
      if (row[0] > 1e-6) {  // it may stick at the start, until the drive asks for more
        EXPECT_TRUE(force == 0.0 || std::abs(std::abs(force) - limit) < 1e-12) << row[0];
      }
    }
    EXPECT_GT(standing, 5u);
  }
}

TEST(DwellingDrive, OfATableHoldsWhatRubs) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "dwell.csv";
  std::ofstream(file) << "0, 1\n0.5, 1.2\n1, 1.2\n1.5, 1\n2, 1\n";
  expect_friction_along("{ table = \"" + file.string() + "\" }", 0.4);
}

// It starts with neither velocity nor acceleration, at a kink that no rate shows.
TEST(DwellingDrive, OfAFormulaHoldsWhatRubsAndStartsSmoothly) {
  expect_friction_along("\"t < 0.5 ? 1 : t < 1 ? 1 + 0.8*(t - 0.5)^3 : t < 1.5 ? 1.1 + 0.6*(t - 1) : 1.4\"", 0.4);
}

// It comes to rest at a kink of the drive: what is left of the way to it is round-off.
TEST(DwellingDrive, MayComeToRestWhereItsFormulaSwitches) {
  expect_friction_along("\"1 + 0.2*max(0, sin(5*t))^3\"", 0.8);
}

// A slider-crank whose motor stands at an angle, and in a dead centre, where no velocity of the crank moves the slider.
TEST(DwellingDrive, HoldsASliderCrankInItsDeadCentre) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "crank.csv";
  std::ofstream(file) << "0, 0\n0.5, 0.2\n1, 0.2\n1.5, 0\n2, 0\n";
  const std::string before = R"(
[[body]]
name = "crank"
mass = 1.0
inertia = 0.01
position = [0.1, 0.0]
[[body]]
name = "rod"
mass = 1.0
inertia = 0.01
position = [0.35, 0.0]
[[body]]
name = "block"
mass = 2.0
inertia = 0.01
position = [0.5, 0.0]
[[joint]]
name = "motor"
type = "revolute"
between = ["ground", "crank"]
at = [0.0, 0.0]
)";
  const std::string after = R"toml(
[[joint]]
name = "pin"
type = "revolute"
between = ["crank", "rod"]
at = [0.2, 0.0]
friction = { coefficient = 0.2, normal_load = "reaction", radius = 0.02 }
[[joint]]
name = "wrist"
type = "revolute"
between = ["rod", "block"]
at = [0.5, 0.0]
[[joint]]
name = "guide"
type = "prismatic"
between = ["ground", "block"]
at = [0.5, 0.0]
axis = [1.0, 0.0]
friction = { coefficient = 0.3, normal_load = "reaction" }
[gravity]
acceleration = [0.0, -9.81]
[[force]]
on = "block.x"
expression = "30*sin(20*t)"
)toml";
  const std::string text = before + "drive = { table = \"" + file.string() + "\" }" + after;
  for (int kind = 0; kind < kinds_of_steps; ++kind) {
    const MechanismStudy ran(text + transient(testing::step_of_kind(kind, "0.001", "1e-6"), 2.0));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_TRUE(ran.table("run.events").rows.empty());
    const auto& table = ran.table("run");
    for (const auto& row : table.rows) {
      if (std::abs(std::remainder(row[0], 0.5)) < 1e-9) continue;  // the kinks
      const bool dwells = (row[0] > 0.5 && row[0] < 1.0) || row[0] > 1.5;
      const double force = row[table.column("friction_force", "guide")];
      EXPECT_EQ(dwells, force == 0.0) << row[0];
    }
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 2e-3 * ran.last("run.energy", "friction_dissipated"));
  }
}

}  // namespace
}  // namespace rubato
