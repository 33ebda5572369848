#include <rubato/numerics/rotations.hpp>

#include <support/mechanism_study.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

namespace rubato {
namespace {

using numerics::Vector3;
using ::testing::HasSubstr;
using testing::MechanismStudy;

/// Three columns of a row, such as x, y, z.
Vector3 vector_at(const MechanismStudy& ran, std::size_t row, const std::string& table,
                  const std::array<std::string, 3>& names) {
  return {ran.at(row, table, names[0]), ran.at(row, table, names[1]), ran.at(row, table, names[2])};
}

/// A body of 2 kg and 0.3 kg m2, 0.5 m from its pin, let go from the horizontal.
std::string pendulum(const std::string& about) {
  return R"(
[[body]]
name = "bob"
mass = 2.0
inertia = 0.3
position = [0.5, 0.0]
[[joint]]
name = "pin"
type = "revolute"
between = ["ground", "bob"]
at = [0.0, 0.0]
[gravity]
acceleration = [0.0, -9.81]
[[analysis]]
name = "modes"
type = "modes"
)" + about;
}

// Equilibrium is found to 1e-10 of the weight: its angle is as exact, and so is the shape.
constexpr double found = 1e-9;

// theta = 1/sqrt(J) with J = 0.3 + 2 0.5^2 about the pin, and x = 0.5 theta below it.
TEST(MechanismModeShapes, OfAPendulumHaveAModalMassOfOne) {
  const MechanismStudy ran(pendulum("about = \"static\""));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double theta = 1.0 / std::sqrt(0.8);
  EXPECT_NEAR(ran.at(0, "modes", "angle_shape", "bob.rz"), theta, found);
  EXPECT_NEAR(ran.at(0, "modes", "shape", "bob.x"), 0.5 * theta, found);
  EXPECT_NEAR(ran.at(0, "modes", "shape", "bob.y"), 0.0, found);
}

// It hangs, and is drawn as it hangs: below its pin, turned by a right angle from where it was put.
TEST(MechanismModeShapes, StandBesideTheConfigurationAboutWhichTheyAre) {
  const MechanismStudy ran(pendulum("about = \"static\""));
  const auto& nodes = ran.table("modes.nodes");
  ASSERT_EQ(nodes.rows.size(), 3u);
  EXPECT_NEAR(ran.at(0, "modes.nodes", "x"), 0.0, found);
  EXPECT_NEAR(ran.at(0, "modes.nodes", "y"), -0.5, found);
  EXPECT_NEAR(std::cos(ran.at(0, "modes.nodes", "rotation_z")), 0.0, found);
  for (const std::size_t pin : {1u, 2u}) {  // on the bob and on the ground
    EXPECT_NEAR(ran.at(pin, "modes.nodes", "x"), 0.0, found);
    EXPECT_NEAR(ran.at(pin, "modes.nodes", "y"), 0.0, found);
  }
  EXPECT_EQ(ran.at(0, "modes.joints", "first"), 2.0);
  EXPECT_EQ(ran.at(0, "modes.joints", "second"), 1.0);
  EXPECT_EQ(nodes.layout.attributes[1].second, "shape");
  EXPECT_EQ(nodes.layout.attributes[2].second, "3");
  EXPECT_EQ(ran.table("modes.lines").rows.size(), 1u);
}

// Two rods of 1 m whose masses m sit at their ends, of inertia j each: (2 m + j) a1 + m a2 = -2 m g th1, m a1 + (m + j)
// a2 = -m g th2; with omega^2 = w from its quadratic the first row gives th2/th1 = (2 m g - w (2 m + j))/(w m).
TEST(MechanismModeShapes, OfADoublePendulumHaveTheRatioOfItsAngles) {
  const MechanismStudy ran(R"(
[[body]]
name = "upper"
mass = 3.0
inertia = 0.6
position = [0.0, -1.0]
[[body]]
name = "lower"
mass = 3.0
inertia = 0.6
position = [0.0, -2.0]
[[joint]]
name = "pin"
type = "revolute"
between = ["ground", "upper"]
at = [0.0, 0.0]
[[joint]]
name = "elbow"
type = "revolute"
between = ["upper", "lower"]
at = [0.0, -1.0]
[gravity]
acceleration = [0.0, -9.81]
[[analysis]]
name = "modes"
type = "modes"
)");
  ASSERT_EQ(ran.table("modes").rows.size(), 2u) << ran.report.message;
  const double m = 3.0, j = 0.6, g = 9.81;
  const double a = (2.0 * m + j) * (m + j) - m * m, b = m * g * (2.0 * m + j) + 2.0 * m * g * (m + j);
  const double c = 2.0 * m * g * m * g, root = std::sqrt(b * b - 4.0 * a * c);
  for (std::size_t mode = 0; mode < 2; ++mode) {
    const double w = (mode == 0 ? b - root : b + root) / (2.0 * a);
    const double ratio = (2.0 * m * g - w * (2.0 * m + j)) / (w * m);
    EXPECT_NEAR(ran.at(mode, "modes", "angular_frequency"), std::sqrt(w), 1e-9);
    EXPECT_NEAR(ran.at(mode, "modes", "angle_shape", "lower.rz") / ran.at(mode, "modes", "angle_shape", "upper.rz"),
                ratio, 1e-9);
  }
}

/// A slender beam of 1 m, clamped, in 20 elements.
std::string cantilever(bool in_space) {
  const std::string z = in_space ? ", 0.0" : "";
  return fmt::format(R"(
[[material]]
name = "steel"
young = 2.1e11
poisson = 0.3
density = 7800.0
[[section]]
name = "strip"
area = 1e-4
inertia = {}
shear_factor = 0.8333333333333334
[[node]]
name = "wall"
position = [0.0, 0.0{}]
[[node]]
name = "tip"
position = [1.0, 0.0{}]
[[beam]]
name = "rod"
nodes = ["wall", "tip"]
section = "strip"
material = "steel"
formulation = "geometrically_exact"
elements = 20
[[support]]
node = "wall"
fix = {}
[[analysis]]
name = "modes"
type = "modes"
count = 1
)",
                     in_space ? "[8e-10, 5e-10]\ntorsion = 1e-9" : "8e-10", z, z,
                     in_space ? R"(["x", "y", "z", "rx", "ry", "rz"])" : R"(["x", "y", "rz"])");
}

// Euler and Bernoulli: cosh x - cos x - s (sinh x - sin x), 1.875104 x: at half the length 0.33952 of the tip (Blevins
// 1979, table 8-1). Elements of a twentieth leave some (1.875/20)^2/12 = 7e-4, the shear of a strip of 1:100 less.
TEST(MechanismModeShapes, OfACantileverBendItAsTheoryDoes) {
  for (const bool in_space : {false, true}) {
    const MechanismStudy ran(cantilever(in_space));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    std::string middle;
    const auto& nodes = ran.table("modes.nodes");
    for (std::size_t i = 0; i < nodes.rows.size(); ++i)
      if (std::abs(ran.at(i, "modes.nodes", "x") - 0.5) < 1e-9) middle = nodes.layout.blocks[0].categories[i];
    ASSERT_FALSE(middle.empty());
    EXPECT_EQ(nodes.rows.size(), 21u);
    const auto bent = [&](const std::string& node) {  // in space about the weaker axis, whichever that is
      return std::hypot(ran.at(0, "modes", "shape", node + ".y"),
                        in_space ? ran.at(0, "modes", "shape", node + ".z") : 0.0);
    };
    EXPECT_NEAR(bent(middle) / bent("tip"), 0.33952, 7e-4);
  }
}

// A body in space, turned, on a skew hinge through a point of its own: in every mode the point of the body in the hinge
// stays, u + (R theta) x arm = 0 with the rotation vector and the arm of the table, since theta is about the axes of
// the body.
TEST(MechanismModeShapes, OfATurnedBodyInSpaceLeaveItsHingeWhereItIs) {
  const MechanismStudy ran(R"(
[[body]]
name = "door"
mass = 20.0
inertia = [2.0, 3.0, 1.0]
position = [0.4, 0.1, -0.7]
rotation = [0.4, -0.9, 1.3]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "door"]
at = [0.0, 0.0, 0.0]
axis = [0.2, 0.9, 0.3]
stiffness = 100.0
[[analysis]]
name = "modes"
type = "modes"
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const Vector3 turn = vector_at(ran, 0, "modes.nodes", {"rotation_x", "rotation_y", "rotation_z"});
  EXPECT_LT((turn - Vector3(0.4, -0.9, 1.3)).norm(), 1e-14);
  const Vector3 centre = vector_at(ran, 0, "modes.nodes", {"x", "y", "z"});
  const Vector3 hinge = vector_at(ran, 1, "modes.nodes", {"x", "y", "z"});
  EXPECT_EQ(ran.at(1, "modes.nodes", "carrier"), 0.0);
  EXPECT_LT(hinge.norm(), 1e-14);
  Vector3 u, theta;
  const std::array<std::string, 3> axes{"x", "y", "z"};
  for (Index i = 0; i < 3; ++i) {
    const std::string& axis = axes[static_cast<std::size_t>(i)];
    u[i] = ran.at(0, "modes", "shape", "door." + axis);
    theta[i] = ran.at(0, "modes", "angle_shape", "door.r" + axis);
  }
  const Vector3 world = numerics::rotation_of(turn) * theta;
  EXPECT_LT((u + world.cross(hinge - centre)).norm(), 1e-12 * theta.norm());
  EXPECT_LT(world.cross(Vector3(0.2, 0.9, 0.3)).norm(), 1e-12 * theta.norm());  // about the axis of the hinge
}

// An inverted pendulum leaves as exp(sqrt(m g l/J) t): the mode that grows is told, with its shape, beside the failure.
TEST(MechanismModeShapes, OfWhatIsNotStableTellHowItLeaves) {
  const MechanismStudy ran(testing::replaced(pendulum(""), "[0.5, 0.0]", "[0.0, 0.5]"));
  EXPECT_EQ(ran.report.status, analysis::RunStatus::failed);
  EXPECT_THAT(ran.report.message, HasSubstr("is not stable"));
  ASSERT_EQ(ran.table("modes").rows.size(), 1u);
  EXPECT_NEAR(ran.at(0, "modes", "eigenvalue_real"), std::sqrt(2.0 * 9.81 * 0.5 / 0.8), 1e-9);
  EXPECT_NEAR(ran.at(0, "modes", "damping_ratio"), -1.0, 1e-12);
  EXPECT_NEAR(ran.at(0, "modes", "angle_shape", "bob.rz"), 1.0 / std::sqrt(0.8), 1e-9);
}

/// A body on a guide along x, pulled by a formula.
std::string guided(const std::string& formula) {
  return fmt::format(R"study(
[[body]]
name = "bob"
mass = 2.0
inertia = 0.3
position = [0.0, 0.0]
[[joint]]
name = "guide"
type = "prismatic"
between = ["ground", "bob"]
at = [0.0, 0.0]
axis = [1.0, 0.0]
force = "{}"
[[analysis]]
name = "modes"
type = "modes"
)study",
                     formula);
}

// A formula is differentiated exactly, however small the lengths and rates over which it bends: k = 8e-6/1e-6, c =
// 4e-6/1e-5.
TEST(MechanismModeShapes, TakeExactSlopesOfFormulasThatBendWithinMicrometres) {
  const MechanismStudy ran(guided("-8e-6*sin(displacement/1e-6) - 4e-6*tanh(rate/1e-5)"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.at(0, "modes", "angular_frequency"), 2.0, 1e-12);
  EXPECT_NEAR(ran.at(0, "modes", "damping_ratio"), 0.4 / (2.0 * 2.0 * 2.0), 1e-12);
}

// s sqrt(abs(s)) is flat at zero, though the terms of its slope are 0 times infinity there.
TEST(MechanismModeShapes, TakeADifferenceWhereAFormulaHasNoFiniteSlope) {
  const MechanismStudy ran(guided("-8*displacement - displacement*sqrt(abs(displacement))"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.at(0, "modes", "angular_frequency"), 2.0, 1e-3);  // the difference is sqrt(6e-6) off
}

}  // namespace
}  // namespace rubato
