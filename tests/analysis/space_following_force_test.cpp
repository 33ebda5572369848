#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

// What following forces do in space alone; following_force_test.cpp has what they do in the plane too.
namespace rubato {
namespace {

using numerics::Vector3;
using ::testing::HasSubstr;
using testing::MechanismStudy;
using testing::replaced;
using testing::rocket;
using testing::verdict;

Vector3 of_body(const MechanismStudy& ran, std::size_t row, const std::string& variable, const std::string& prefix) {
  Vector3 vector;
  const std::string axes[] = {"x", "y", "z"};
  for (Index i = 0; i < 3; ++i) vector[i] = ran.at(row, "run", variable, prefix + axes[i]);
  return vector;
}

/// A body that turns about no principal axis.
const std::string tumbling = R"(
[[body]]
name = "body"
mass = 2.0
inertia = [0.3, 0.4, 0.5]
position = [0.0, 0.0, 0.0]
angular_velocity = [1.0, 0.2, -0.5]
[[force]]
on = "body.ry"
expression = "0.6"
following = false
[[analysis]]
name = "run"
type = "transient"
step = 0.001
duration = 2.0
)";

Vector3 angular_momentum(const MechanismStudy& ran, std::size_t row) {
  const Vector3 turn = of_body(ran, row, "angle", "body.r"), spin = of_body(ran, row, "angular_velocity", "body.r");
  return numerics::rotation_of(turn) * Vector3(Vector3(0.3, 0.4, 0.5).cwiseProduct(spin));
}

// Of the second order in h: (w h)^2 of momenta of 0.3 to 1.3 N m s, w about 3 rad/s.
TEST(SpaceFollowingForces, LeaveAMomentFixedInTheWorldWhereItIs) {
  const MechanismStudy ran(tumbling);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const std::size_t last = ran.table("run").rows.size() - 1;
  const Vector3 gained = angular_momentum(ran, last) - angular_momentum(ran, 0);
  EXPECT_LT((gained - Vector3(0.0, 0.6 * 2.0, 0.0)).norm(), 1e-5);
}

// Euler's equations in the axes of the body, J w' + w x J w = m, by a fine Runge-Kutta integration.
TEST(SpaceFollowingForces, TurnAMomentWithItsBodyUnlessToldOtherwise) {
  const Vector3 inertia(0.3, 0.4, 0.5), moment(0.0, 0.6, 0.0);
  const auto rate = [&](const Vector3& w) {
    return Vector3((moment - w.cross(inertia.cwiseProduct(w))).cwiseQuotient(inertia));
  };
  Vector3 w(1.0, 0.2, -0.5);
  const double h = 1e-3;
  for (int i = 0; i < 2000; ++i) {
    const Vector3 k1 = rate(w), k2 = rate(w + 0.5 * h * k1), k3 = rate(w + 0.5 * h * k2), k4 = rate(w + h * k3);
    w += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  for (const char* following : {"", "following = true\n"}) {
    const MechanismStudy ran(replaced(tumbling, "following = false\n", following));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const std::size_t last = ran.table("run").rows.size() - 1;
    EXPECT_LT((of_body(ran, last, "angular_velocity", "body.r") - w).norm(), 1e-5);
  }
}

// A column clamped at its foot, with a thrust P at its tip that follows it: no other equilibrium, but flutter beyond
// P = 20.05 E I/L^2 (Beck 1952). Here E I = rho A = L = 1, slender; a push aside starts it. Below, vibrations stay
// what they are but for what the method damps; above they grow. Ten elements of reduced integration are too soft by
// about (pi/20)^2/3, 1 %: 7 % on either side leave no doubt.
double growth(double thrust) {
  const std::string text = "[parameters]\nP = " + std::to_string(thrust) + R"text(
[[material]]
name = "m"
young = 1e4
poisson = 0.0
density = 1.0
[[section]]
name = "s"
area = 1.0
inertia = [1e-4, 1e-4]
torsion = 2e-4
shear_factor = 1.0
[[node]]
name = "foot"
position = [0.0, 0.0, 0.0]
[[node]]
name = "tip"
position = [0.0, 0.0, 1.0]
[[beam]]
name = "column"
nodes = ["foot", "tip"]
section = "s"
material = "m"
formulation = "geometrically_exact"
orientation = [1.0, 0.0, 0.0]
elements = 10
[[support]]
node = "foot"
fix = ["x", "y", "z", "rx", "ry", "rz"]
[[force]]
on = "tip.z"
expression = "-P*min(t/0.5, 1)"
following = true
[[force]]
on = "tip.x"
expression = "t > 0.5 && t < 0.55 ? 0.01 : 0"
[[analysis]]
name = "run"
type = "transient"
step = 0.005
duration = 4.0
energy = false
)text";
  const MechanismStudy ran(text);
  EXPECT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.table("run");
  const std::size_t column = table.column("position", "tip.x");
  double early = 0.0, late = 0.0;
  for (const auto& row : table.rows) {
    if (row[0] > 0.6 && row[0] < 1.7) early = std::max(early, std::abs(row[column]));
    if (row[0] > 2.9) late = std::max(late, std::abs(row[column]));
  }
  return late / early;
}

TEST(SpaceFollowingForces, MakeBecksColumnFlutterWhereTheoryDoes) {
  EXPECT_LT(growth(0.93 * 20.05), 1.5);
  EXPECT_GT(growth(1.07 * 20.05), 10.0);
}

// A cantilever of E I = L = 1 under a thrust P across its tip, which follows it: along the beam E I kappa^2/2 =
// P sin(phi_tip - phi), as no moment is left at the tip, so that the moment M at its foot obeys M^2 = 2 P sin(phi_tip).
// Thin: P/(G A) and P/(E A) are 1e-5. Forty elements, each of which turns by 0.05 rad: errors of 0.05^2/12 of P.
TEST(SpaceFollowingForces, BendACantileverAsTheElasticaSays) {
  const double thrust = 10.0;
  const MechanismStudy ran("[parameters]\nP = " + std::to_string(thrust) + R"(
[[material]]
name = "m"
young = 1e6
poisson = 0.0
density = 1.0
[[section]]
name = "s"
area = 1.0
inertia = [1e-6, 1e-6]
torsion = 2e-6
shear_factor = 1.0
[[node]]
name = "foot"
position = [0.0, 0.0, 0.0]
[[node]]
name = "tip"
position = [0.0, 0.0, 1.0]
[[beam]]
name = "column"
nodes = ["foot", "tip"]
section = "s"
material = "m"
formulation = "geometrically_exact"
orientation = [1.0, 0.0, 0.0]
elements = 40
[[support]]
node = "foot"
fix = ["x", "y", "z", "rx", "ry", "rz"]
[[force]]
on = "tip.x"
expression = "P"
following = true
[[analysis]]
name = "run"
type = "static"
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double turn = ran.at(0, "run", "angle", "tip.ry");  // from z towards x
  const double x = ran.at(0, "run", "position", "tip.x"), z = ran.at(0, "run", "position", "tip.z");
  const double moment = thrust * (z * std::cos(turn) + x * std::sin(turn));
  EXPECT_GT(turn, 1.0);
  EXPECT_NEAR(moment * moment, 2.0 * thrust * std::sin(turn), 5e-3 * moment * moment);
}

/// Ziegler's pendulum: two rods of 1 m with masses of 2 and 1 kg at their ends and springs of 1 N m/rad, pressed by a
/// force that stays along the second.
std::string zieglers_pendulum(bool in_space, double force) {
  const std::string z = in_space ? ", 0.0" : "", axis = in_space ? "axis = [0.0, 0.0, 1.0]\n" : "";
  const auto body = [&](const std::string& name, double mass, double x) {
    return "[[body]]\nname = \"" + name + "\"\nmass = " + std::to_string(mass) +
           "\ninertia = " + (in_space ? "[1e-6, 1e-6, 1e-6]" : "1e-6") + "\nposition = [" + std::to_string(x) +
           ", 0.0" + z + "]\n";
  };
  const auto hinge = [&](const std::string& first, const std::string& second, double x) {
    return "[[joint]]\ntype = \"revolute\"\nbetween = [\"" + first + "\", \"" + second + "\"]\nat = [" +
           std::to_string(x) + ", 0.0" + z + "]\n" + axis + "stiffness = 1.0\n";
  };
  return body("inner", 2.0, 1.0) + body("outer", 1.0, 2.0) + hinge("ground", "inner", 0.0) +
         hinge("inner", "outer", 1.0) + "[[force]]\non = \"outer.x\"\nfollowing = true\nexpression = \"-" +
         std::to_string(force) + "\"\n[[analysis]]\nname = \"run\"\ntype = \"modes\"\nabout = \"static\"\n";
}

// With w = omega^2:  2 w^2 - (7 - 2 P) w + 1 = 0 (Ziegler 1952), which has no real solution from P = 7/2 - sqrt(2) on.
TEST(FollowingForces, LetZieglersPendulumFlutter) {
  for (const bool in_space : {false, true}) {
    for (const double force : {1.1, 1.9, 2.08}) {
      const MechanismStudy ran(zieglers_pendulum(in_space, force));
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      const double half = 0.25 * (7.0 - 2.0 * force), root = std::sqrt(half * half - 0.5);
      EXPECT_NEAR(ran.at(0, "run", "angular_frequency"), std::sqrt(half - root), 1e-5) << force;
      EXPECT_NEAR(ran.at(1, "run", "angular_frequency"), std::sqrt(half + root), 1e-5) << force;
      for (const auto& warning : ran.report.warnings) ADD_FAILURE() << in_space << force << warning;
    }
    // w = 0.65 +- 0.27839 i, of which sqrt(-w) = 0.16897 -+ 0.82375 i.
    const MechanismStudy fluttering(zieglers_pendulum(in_space, 2.2));
    EXPECT_EQ(fluttering.report.status, analysis::RunStatus::failed);
    EXPECT_THAT(fluttering.report.message, HasSubstr("flutters"));
    EXPECT_THAT(fluttering.report.message, HasSubstr("as exp(0.169/s t)"));
  }
}

TEST(SpaceFollowingForceFault, NamesWhatGoesWithIt) {
  EXPECT_THAT(verdict(rocket(testing::in_space, 3.0, "following = true\nat = [0.7, -0.2]\n")),
              HasSubstr("the force on \"rocket.x\": at takes three numbers in space, got 2"));
  EXPECT_THAT(verdict(replaced(tumbling, "following = false", "following = true\nat = [0.7, -0.2, 0.0]")),
              HasSubstr("the force on \"body.ry\": a moment has no point; remove \"at\""));
  const std::string mass =
      "[[node]]\nname = \"point\"\nposition = [0.0, 0.0, 0.0]\n[[mass]]\nnode = \"point\"\nmass = 1.0\n";
  EXPECT_THAT(verdict(replaced(rocket(testing::in_space, 3.0), "[[force]]\non = \"rocket.x\"",
                               mass + "[[force]]\non = \"point.x\"")),
              HasSubstr("follows a mass that does not turn"));
}

}  // namespace
}  // namespace rubato
