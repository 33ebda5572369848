#include <rubato/core/error.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/build_mechanism.hpp>
#include <rubato/system/mechanism_equations.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace rubato {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string pair = R"(
[[body]]
name = "arm"
mass = 2.0
inertia = [0.3, 0.4, 0.5, 0.01, 0.02, 0.03]
position = [1.0, 0.0, 0.0]
rotation = [0.0, 0.0, "pi/2"]
velocity = [0.1, 0.2, 0.3]
angular_velocity = [1.0, 2.0, 3.0]

[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.5, density = 8.0 }
position = [2.0, 0.0, 0.0]

[[joint]]
name = "J"
type = "revolute"
between = ["ground", "arm"]
at = [0.0, 0.0, 0.0]
axis = [0.0, 0.0, 2.0]
angle = 0.3
stiffness = 5.0

[[joint]]
name = "K"
type = "spherical"
between = ["arm", "ball"]
at = [1.5, 0.0, 0.0]

[[force]]
on = "ball.z"
expression = "t"

[gravity]
acceleration = [0.0, 0.0, -10.0]
)";

system::Mechanism built(const std::string& text) {
  const auto study = io::read_study_text(text, "study.toml");
  EXPECT_TRUE(model::is_mechanism(study.model));
  return system::Mechanism(model::build_mechanism(study.model, model::evaluate_parameters(study.parameters)));
}

std::string verdict(const std::string& text) {
  try {
    (void)built(text);
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
  return "no complaint";
}

std::string replaced(std::string text, const std::string& piece, const std::string& other) {
  const std::size_t at = text.find(piece);
  EXPECT_NE(at, std::string::npos) << piece;
  return text.replace(at, piece.size(), other);
}

std::string verdict_with(const std::string& piece, const std::string& other) {
  return verdict(replaced(pair, piece, other));
}

std::string verdict_of_joint(const std::string& keys) {
  return verdict(replaced(pair, "[[force]]",
                          "[[joint]]\nname = \"X\"\nbetween = [\"ground\", \"ball\"]\n" + keys + "\n\n[[force]]"));
}

TEST(ReadSpaceMechanism, MakesBodiesAndJointsInSpace) {
  const system::Mechanism mechanism = built(pair);
  const auto& model = mechanism.model();
  EXPECT_EQ(model.dimension, 3);
  EXPECT_EQ(mechanism.size(), 12);
  EXPECT_EQ(mechanism.coordinates()[3], "arm.rx");
  EXPECT_EQ(mechanism.rows(),
            (std::vector<std::string>{"J.x", "J.y", "J.z", "J.moment_x", "J.moment_y", "K.x", "K.y", "K.z"}));
  const SparseMatrix& mass = mechanism.mass();
  EXPECT_DOUBLE_EQ(mass.coeff(0, 0), 2.0);
  EXPECT_DOUBLE_EQ(mass.coeff(4, 4), 0.4);
  EXPECT_DOUBLE_EQ(mass.coeff(3, 4), 0.01);
  EXPECT_DOUBLE_EQ(mass.coeff(5, 3), 0.02);
  EXPECT_DOUBLE_EQ(mass.coeff(4, 5), 0.03);
  // A ball: 4/3 pi r^3 rho, 2/5 m r^2.
  const double ball = 8.0 * 4.0 / 3.0 * std::numbers::pi * 0.125;
  EXPECT_NEAR(mass.coeff(6, 6), ball, 1e-14);
  EXPECT_NEAR(mass.coeff(10, 10), 0.4 * ball * 0.25, 1e-14);
  EXPECT_DOUBLE_EQ(mechanism.start().v[2], 0.3);
  EXPECT_DOUBLE_EQ(mechanism.start().v[5], 3.0);
  EXPECT_NEAR(mechanism.start().q[10], std::cos(std::numbers::pi / 4.0), 1e-15);
  EXPECT_NEAR(mechanism.start().q[13], std::sin(std::numbers::pi / 4.0), 1e-15);
  EXPECT_NEAR(mechanism.weight()[8], -10.0 * ball, 1e-12);
  ASSERT_EQ(model.space_coordinates.size(), 1u);
  EXPECT_NEAR(model.space_coordinates[0].s.value(mechanism.start().q.data()), 0.3, 1e-15);
  Vector force(12), gap(8);
  system::MechanismEquations equations(mechanism);
  equations.go_to(mechanism.start(), model::Side::right);
  equations.residual(force, gap);
  EXPECT_LT(gap.cwiseAbs().maxCoeff(), 1e-15);
}

TEST(ReadSpaceMechanism, FindsTheInertiaOfShapes) {
  const auto inertia = [](const std::string& shape) {
    const auto mechanism =
        built("[[body]]\nname = \"b\"\nmass = 12.0\nposition = [0.0, 0.0, 0.0]\nshape = " + shape + "\n");
    return Vector(mechanism.mass().diagonal().tail<3>());
  };
  const Vector box = inertia("{ kind = \"box\", size = [1.0, 2.0, 3.0] }");
  EXPECT_NEAR(box[0], 4.0 + 9.0, 1e-13);
  EXPECT_NEAR(box[1], 1.0 + 9.0, 1e-13);
  EXPECT_NEAR(box[2], 1.0 + 4.0, 1e-13);
  const Vector cylinder = inertia("{ kind = \"cylinder\", radius = 1.0, length = 2.0 }");
  EXPECT_NEAR(cylinder[0], 3.0 + 4.0, 1e-13);
  EXPECT_NEAR(cylinder[2], 6.0, 1e-13);
}

TEST(ReadSpaceMechanism, HasEveryTypeOfJoint) {
  const auto rows = [](const std::string& keys) {
    const auto mechanism =
        built(replaced(replaced(pair, "[[force]]",
                                "[[joint]]\nname = \"X\"\nbetween = [\"ground\", \"ball\"]\nat = [2.0, "
                                "0.0, 0.0]\n" +
                                    keys + "\n\n[[force]]"),
                       "type = \"spherical\"\nbetween = [\"arm\", \"ball\"]\nat = [1.5, 0.0, 0.0]",
                       "type = \"distance\"\nbetween = [\"arm\", \"ball\"]"));
    return mechanism.constraint_count() - 6;
  };
  EXPECT_EQ(rows("type = \"rigid\""), 6);
  EXPECT_EQ(rows("type = \"revolute\"\naxis = [1.0, 0.0, 0.0]"), 5);
  EXPECT_EQ(rows("type = \"prismatic\"\naxis = [1.0, 0.0, 0.0]"), 5);
  EXPECT_EQ(rows("type = \"screw\"\naxis = [1.0, 0.0, 0.0]\nlead = 0.01"), 5);
  EXPECT_EQ(rows("type = \"cylindrical\"\naxis = [1.0, 0.0, 0.0]"), 4);
  EXPECT_EQ(rows("type = \"universal\"\naxis = [1.0, 0.0, 0.0]\nsecond_axis = [0.0, 1.0, 0.0]"), 4);
  EXPECT_EQ(rows("type = \"spherical\""), 3);
  EXPECT_EQ(rows("type = \"planar\"\naxis = [1.0, 0.0, 0.0]"), 3);
  EXPECT_EQ(rows("type = \"distance\"\nto = [2.0, 0.0, 0.4]"), 1);
}

// A beam along y whose soft side looks along x: masses and section axes are those of the study.
TEST(ReadSpaceMechanism, TakesBeamsInSpace) {
  const system::Mechanism mechanism = built(R"(
[[node]]
name = "foot"
position = [0.0, 0.0, 0.0]
[[node]]
name = "tip"
position = [0.0, 2.0, 0.0]
[[material]]
name = "steel"
young = 2e11
poisson = 0.25
density = 8000.0
[[section]]
name = "bar"
area = 1e-3
inertia = [4e-7, 1e-7]
torsion = 2e-7
shear_factor = 0.8
[[beam]]
nodes = ["foot", "tip"]
section = "bar"
material = "steel"
formulation = "geometrically_exact"
orientation = [1.0, 0.0, 0.0]
elements = 2
[[support]]
node = "foot"
fix = ["x", "y", "z", "rx", "ry", "rz"]
)");
  EXPECT_EQ(mechanism.size(), 12);
  const SparseMatrix& mass = mechanism.mass();
  EXPECT_DOUBLE_EQ(mass.coeff(0, 0), 8.0 / 3.0);
  EXPECT_DOUBLE_EQ(mass.coeff(0, 6), 8.0 / 6.0);
  // Half of an element of 1 m: rho Iy about the section's y (along x), rho Iz about its z, their sum about the beam.
  EXPECT_NEAR(mass.coeff(3, 3), 0.5 * 8000.0 * 4e-7, 1e-15);
  EXPECT_NEAR(mass.coeff(4, 4), 0.5 * 8000.0 * 5e-7, 1e-15);
  EXPECT_NEAR(mass.coeff(5, 5), 0.5 * 8000.0 * 1e-7, 1e-15);
}

TEST(ReadSpaceMechanism, NamesWhatIsWrongWithBodies) {
  EXPECT_THAT(
      verdict_with("position = [2.0, 0.0, 0.0]", "position = [2.0, 0.0]"),
      HasSubstr("body \"ball\": position takes three numbers in space, got 2; by the position of body \"arm\" the "
                "model lies there"));
  EXPECT_THAT(verdict_with("inertia = [0.3, 0.4, 0.5, 0.01, 0.02, 0.03]", "inertia = 0.3"),
              StartsWith("study.toml:5:11: error: body \"arm\": inertia takes three numbers in space"));
  EXPECT_THAT(verdict_with("0.3, 0.4, 0.5, 0.01, 0.02, 0.03", "0.1, 0.1, 0.3"),
              StartsWith("study.toml:5:11: error: body \"arm\": no body has the principal inertias 0.1, 0.1, 0.3"));
  EXPECT_THAT(verdict_with("0.3, 0.4, 0.5, 0.01, 0.02, 0.03", "0.0, 0.1, 0.1"),
              StartsWith("study.toml:5:11: error: body \"arm\": inertia must be positive about every axis"));
  EXPECT_THAT(verdict_with("0.3, 0.4, 0.5, 0.01, 0.02, 0.03", "nan, 0.1, 0.1"), HasSubstr("finite"));
  EXPECT_THAT(verdict_with("[0.0, 0.0, \"pi/2\"]", "[0.7, 0.0, 0.0, 0.7]"),
              StartsWith("study.toml:7:12: error: body \"arm\": rotation is a rotation vector of three numbers"));
  EXPECT_THAT(verdict_with("[0.0, 0.0, \"pi/2\"]", "[0.0, 0.0, 90.0]"), HasSubstr("multiply by pi/180"));
  EXPECT_THAT(verdict_with("rotation = [0.0, 0.0, \"pi/2\"]", "angle = 1.0"), HasSubstr("in space give \"rotation\""));
  EXPECT_THAT(verdict_with("density = 8.0", "densty = 8.0"), HasSubstr("density"));
  EXPECT_THAT(verdict_with(", density = 8.0", ""), HasSubstr("its shape needs \"density\""));
  EXPECT_THAT(verdict_with("radius = 0.5", "radius = -0.5"), HasSubstr("shape: radius must be positive"));
  EXPECT_THAT(verdict_with("acceleration = [0.0, 0.0, -10.0]", "acceleration = [0.0, -10.0]"),
              HasSubstr("[gravity]: acceleration takes three numbers in space"));
}

TEST(ReadSpaceMechanism, NamesWhatIsWrongWithJoints) {
  EXPECT_THAT(verdict_with("axis = [0.0, 0.0, 2.0]", "axis = [0.0, 0.0, 0.0]"),
              StartsWith("study.toml:21:8: error: joint \"J\": the axis [0, 0, 0] has no length"));
  EXPECT_THAT(verdict_with("axis = [0.0, 0.0, 2.0]\n", ""), HasSubstr("joint \"J\" lacks the key \"axis\""));
  EXPECT_THAT(verdict_with("at = [1.5, 0.0, 0.0]", "at = [1.5, 0.0]"),
              HasSubstr("joint \"K\": at takes three numbers in space"));
  EXPECT_THAT(verdict_with("at = [1.5, 0.0, 0.0]", ""), HasSubstr("joint \"K\" needs \"at\""));
  EXPECT_THAT(verdict_of_joint("type = \"universal\"\nat = [2, 0, 0]\naxis = [1, 0, 0]"),
              HasSubstr("lacks the key \"second_axis\""));
  EXPECT_THAT(verdict_of_joint("type = \"universal\"\nat = [2, 0, 0]\naxis = [1, 0, 0]\nsecond_axis = [1, 1, 0]"),
              HasSubstr("these are at 0.7854 rad"));
  EXPECT_THAT(verdict_of_joint("type = \"screw\"\nat = [2, 0, 0]\naxis = [1, 0, 0]"),
              HasSubstr("lacks the key \"lead\""));
  EXPECT_THAT(verdict_of_joint("type = \"screw\"\nat = [2, 0, 0]\naxis = [1, 0, 0]\nlead = 0.0"),
              HasSubstr("a screw of lead 0 does not advance"));
  EXPECT_THAT(verdict_of_joint("type = \"cylindrical\"\nat = [2, 0, 0]"), HasSubstr("lacks the key \"axis\""));
  EXPECT_THAT(verdict_of_joint("type = \"planar\"\nat = [2, 0, 0]"), HasSubstr("lacks the key \"axis\""));
  EXPECT_THAT(verdict_of_joint("type = \"spherical\"\nat = [2, 0, 0]\naxis = [1, 0, 0]"),
              HasSubstr("\"axis\" belongs to a"));
  EXPECT_THAT(verdict_of_joint("type = \"distance\"\nat = [2, 0, 0]"), HasSubstr("has no length"));
  EXPECT_THAT(verdict_of_joint("type = \"ball\"\nat = [2, 0, 0]"), HasSubstr("spherical"));
  EXPECT_THAT(
      verdict_of_joint("type = \"cylindrical\"\nat = [2, 0, 0]\naxis = [1, 0, 0]\nlock = { at = 1, kind = \"stop\" }"),
      HasSubstr("\"lock\" belongs to a revolute, prismatic, screw or strut joint, and this one is cylindrical"));
}

TEST(ReadSpaceMechanism, KeepsPlaneAndSpaceApart) {
  const std::string plane = "[[body]]\nname = \"b\"\nmass = 1.0\ninertia = 1.0\nposition = [0.0, 0.0]\n";
  EXPECT_THAT(verdict(plane + "[[joint]]\ntype = \"spherical\"\nbetween = [\"ground\", \"b\"]\nat = [0.0, 0.0]\n"),
              HasSubstr("its type is for mechanisms in space"));
  EXPECT_THAT(verdict(plane + "[[joint]]\ntype = \"revolute\"\nbetween = [\"ground\", \"b\"]\nat = [0.0, 0.0, 0.0]\n"),
              HasSubstr("at takes two numbers in the plane, got 3"));
  EXPECT_THAT(verdict(plane + "rotation = [0.0, 0.0, 1.0]\n"), HasSubstr("in the plane give \"angle\""));
}

TEST(ReadSpaceMechanism, RefusesJointsThatAMassWithoutAxesCannotHold) {
  const std::string text =
      pair + "[[node]]\nname = \"bob\"\nposition = [3.0, 0.0, 0.0]\n[[mass]]\nnode = \"bob\"\nmass = 1.0\n";
  EXPECT_EQ(verdict(text + "[[joint]]\ntype = \"distance\"\nbetween = [\"ball\", \"bob\"]\n"), "no complaint");
  EXPECT_THAT(verdict(text + "[[joint]]\ntype = \"rigid\"\nbetween = [\"ball\", \"bob\"]\n"),
              HasSubstr("a mass that does not turn"));
  EXPECT_THAT(verdict(text + "[[support]]\nnode = \"bob\"\nfix = [\"x\"]\n[[spring]]\nbetween = [\"ball.rx\", "
                             "\"ground\"]\nstiffness = 1.0\n"),
              HasSubstr("a rotation in space, which is no number"));
}

}  // namespace
}  // namespace rubato
