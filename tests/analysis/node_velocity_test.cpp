#include <rubato/core/error.hpp>

#include <support/mechanism_study.hpp>
#include <support/prepared_study.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

// Nodes that move at the start, in structures and in mechanisms.
namespace rubato {
namespace {

using testing::MechanismStudy;

const std::string steel = R"(
[[material]]
name = "steel"
young = 2e11
poisson = 0.3
density = 7800.0
[[section]]
name = "bar"
area = 1e-3
inertia = [1e-7, 1e-7]
torsion = 1.4e-7
shear_factor = 0.85
)";

// A conical pendulum of 1 m at 0.5 rad goes round at sqrt(g/cos) in its own height.
TEST(NodeVelocity, SwingsAConicalPendulumRound) {
  const double omega = std::sqrt(9.81 / std::cos(0.5)), period = 2.0 * std::numbers::pi / omega;
  const MechanismStudy ran(R"text(
[[node]]
name = "bob"
position = ["sin(0.5)", 0.0, "-cos(0.5)"]
velocity = [0.0, "sin(0.5)*sqrt(9.81/cos(0.5))", 0.0]
[[mass]]
node = "bob"
mass = 2.0
[[joint]]
name = "string"
type = "distance"
between = ["ground", "bob"]
at = [0.0, 0.0, 0.0]
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[analysis]]
name = "run"
type = "transient"
step = { tolerance = 1e-5 }
duration = )text" + std::to_string(period));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_TRUE(ran.report.warnings.empty());
  EXPECT_NEAR(ran.last("run", "position", "bob.x"), std::sin(0.5), 1e-4);
  EXPECT_NEAR(ran.last("run", "position", "bob.y"), 0.0, 1e-4);
  const auto& table = ran.table("run");
  for (std::size_t row = 0; row < table.rows.size(); ++row)
    EXPECT_NEAR(ran.at(row, "run", "position", "bob.z"), -std::cos(0.5), 1e-4);
}

// A free beam of four elements that spins about its middle: rigid at the start, with the energy J omega^2/2 of
// J = rho (A l^3/12 + I l).
TEST(NodeVelocity, SpinsABeamWithTheNodesWithinIt) {
  const MechanismStudy ran(steel + R"(
[[node]]
name = "a"
position = [-1.0, 0.0, 0.0]
velocity = [0.0, -3.0, 0.0]
angular_velocity = [0.0, 0.0, 3.0]
[[node]]
name = "b"
position = [1.0, 0.0, 0.0]
velocity = [0.0, 3.0, 0.0]
angular_velocity = [0.0, 0.0, 3.0]
[[beam]]
name = "rotor"
nodes = ["a", "b"]
section = "bar"
material = "steel"
formulation = "geometrically_exact"
elements = 4
[[analysis]]
name = "run"
type = "transient"
step = 0.001
duration = 0.1
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double inertia = 7800.0 * (1e-3 * 8.0 / 12.0 + 1e-7 * 2.0);
  EXPECT_NEAR(ran.at(0, "run.energy", "kinetic"), 0.5 * inertia * 9.0, 1e-9);
  EXPECT_NEAR(ran.at(0, "run", "velocity", "rotor:1.y"), -1.5, 1e-12);
  EXPECT_NEAR(ran.at(0, "run", "angular_velocity", "rotor:3.rz"), 3.0, 1e-12);
  // It goes on; the stretch that its own pull makes, rho l^2 omega^2/(3 E) of a metre, is 1e-7 of it.
  EXPECT_NEAR(ran.last("run", "angle", "b.rz"), 0.3, 1e-5);
  EXPECT_NEAR(ran.last("run", "position", "b.y"), std::sin(0.3), 1e-5);
}

TEST(NodeVelocity, IsThatOfAStructureAtItsStart) {
  const testing::PreparedStudy prepared(steel + R"(
[[node]]
name = "wall"
position = [0.0, 0.0, 0.0]
[[node]]
name = "tip"
position = [1.0, 0.0, 0.0]
velocity = [0.0, "2*3", 0.0]
angular_velocity = [0.0, 0.0, -1.0]
[[beam]]
name = "bar"
nodes = ["wall", "tip"]
section = "bar"
material = "steel"
elements = 3
[[support]]
node = "wall"
fix = ["x", "y", "z", "rx", "ry", "rz"]
)");
  const auto& names = prepared.system.coordinates();
  const Vector& v = prepared.system.start().v;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double share = names[i].starts_with("bar:1.") ? 1.0 / 3.0 : names[i].starts_with("bar:2.") ? 2.0 / 3.0 : 1.0;
    const double expected = names[i].ends_with(".y") ? 6.0 * share : names[i].ends_with(".rz") ? -share : 0.0;
    EXPECT_NEAR(v[static_cast<Index>(i)], expected, 1e-15) << names[i];
  }
}

std::string verdict(const std::string& node) {
  try {
    const MechanismStudy ran(steel + R"(
[[node]]
name = "wall"
position = [0.0, 0.0, 0.0]
[[node]]
name = "tip"
position = [1.0, 0.0, 0.0]
)" + node + R"(
[[beam]]
nodes = ["wall", "tip"]
section = "bar"
material = "steel"
formulation = "geometrically_exact"
[[support]]
node = "wall"
fix = ["x", "y", "z", "rx", "ry", "rz"]
[[analysis]]
name = "run"
type = "transient"
step = 0.001
duration = 0.002
)");
    return ran.report.message;
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
}

TEST(NodeVelocityFault, NamesTheNodeAndTheRemedy) {
  const auto says = [](const std::string& node, const std::string& expected) {
    const std::string said = verdict(node);
    EXPECT_NE(said.find(expected), std::string::npos) << said;
  };
  EXPECT_EQ(verdict("velocity = [0.0, 1.0, 0.0]\nangular_velocity = [0.0, 0.0, 1.0]"), "");
  says("velocity = [0.0, 1.0]", "node \"tip\": velocity takes three numbers in space, got 2");
  says("angular_velocity = 2.0", "node \"tip\": angular_velocity takes three numbers in space, got 1");
  says("velocity = [0.0, 1.0, 0.0]\n[[support]]\nnode = \"tip\"\nfix = [\"y\"]",
       "node \"tip\" starts with a velocity in y, which a support holds; leave it out");
  says(
      "[[node]]\nname = \"bob\"\nposition = [2.0, 0.0, 0.0]\nangular_velocity = [1.0, 0.0, 0.0]\n"
      "[[mass]]\nnode = \"bob\"\nmass = 1.0",
      "node \"bob\" starts with a velocity in rx, where nothing gives it an inertia");
}

}  // namespace
}  // namespace rubato
