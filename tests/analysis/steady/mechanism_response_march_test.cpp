#include "support/mechanism_response.hpp"
#include "support/ran_study.hpp"
#include "support/run_mechanism.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

// Frequency responses of mechanisms about their static equilibrium, against long transients.
namespace rubato::testing {
namespace {

using std::numbers::pi;

TEST(MechanismResponses, OfAPendulumAreThoseOfALongMarch) {
  const std::string at = "Omega = 1.0", here = "Omega = 3.0";
  const auto marched = run_mechanism_study(replaced(swinging_bob, at, here) + march(3.0, 40));
  const auto ran = run_mechanism_study(swinging_bob + response_about_rest("[3.0]"));
  const double wanted = last_amplitude(marched.sink, "angle", "bob.rz");
  EXPECT_NEAR(value_of(ran.sink, "frf", "angle_amplitude", "bob.rz"), wanted, 1e-4 * wanted);
}
const std::string four_bar = R"(
[parameters]
Omega = 1.0
F = 0.05
[gravity]
acceleration = [0.0, -9.81]
[[body]]
name = "crank"
mass = 1.0
inertia = 0.01
position = [0.05, 0.15]
angle = 1.2
[[body]]
name = "coupler"
mass = 2.0
inertia = 0.06
position = [0.35, 0.4]
[[body]]
name = "rocker"
mass = 1.5
inertia = 0.03
position = [0.65, 0.2]
[[joint]]
name = "A"
type = "revolute"
between = ["ground", "crank"]
at = [0.0, 0.0]
stiffness = 30.0
damping = 0.8
[[joint]]
name = "B"
type = "revolute"
between = ["crank", "coupler"]
at = [0.1, 0.3]
[[joint]]
name = "C"
type = "revolute"
between = ["coupler", "rocker"]
at = [0.6, 0.45]
[[joint]]
name = "D"
type = "revolute"
between = ["ground", "rocker"]
at = [0.7, 0.0]
[[joint]]
name = "tie"
type = "strut"
between = ["ground", "coupler"]
at = [0.2, 1.0]
to = [0.35, 0.4]
stiffness = 400.0
damping = 1.0
[[force]]
on = "coupler.x"
amplitude = "F"
angular_frequency = "Omega"
)";

void expect_march(const std::string& study, double omega, const std::string& solver, double tolerance) {
  const auto marched =
      run_mechanism_study(replaced(study, "Omega = 1.0", fmt::format("Omega = {}", omega)) + march(omega, 30, "1e-6"));
  const auto ran =
      run_mechanism_study(study + response_about_rest(fmt::format("[{}]", omega), "about = \"static\"\n" + solver));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  for (const char* name : {"coupler.x", "rocker.x"}) {
    const double wanted = last_amplitude(marched.sink, "position", name);
    EXPECT_NEAR(value_of(ran.sink, "frf", "amplitude", name), wanted, tolerance * wanted) << name << " at " << omega;
  }
  const double wanted = last_amplitude(marched.sink, "angle", "crank.rz");
  EXPECT_NEAR(value_of(ran.sink, "frf", "angle_amplitude", "crank.rz"), wanted, tolerance * wanted) << omega;
}

// What is not linear in the joints grows with the turns, some 1e-3 rad.
TEST(MechanismResponses, OfAFourBarLinkageOnSpringsAreThoseOfALongMarch) {
  for (const double omega : {8.0, 13.0}) expect_march(four_bar, omega, "", 1e-3);
}

TEST(MechanismResponses, OfAFourBarLinkageWithFrictionAndLawsAreThoseOfALongMarch) {
  const std::string laws = R"(
[[slider]]
name = "rub"
between = ["coupler.x", "ground"]
stiffness = 2000.0
friction_coefficient = 0.3
normal_load = 0.1
[[bouc_wen]]
name = "mount"
joint = "D"
stiffness = 10.0
post_yield_ratio = 0.1
beta = 6000.0
gamma = 6000.0
[[nonlinear_spring]]
name = "rubber"
joint = "A"
force = "4*u + 2e6*u^3"
)";
  for (const double omega : {8.0, 13.0})
    expect_march(four_bar + laws, omega, "solver = \"harmonic_balance\"\ntolerance = 1e-4", 3e-3);
}

// A rotation vector is not the turn about the axes of the body: here both are far apart.
TEST(MechanismResponses, InSpaceAreThoseOfALongMarch) {
  const std::string study = R"(
[parameters]
Omega = 1.0
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
name = "box"
mass = 4.0
inertia = [0.05, 0.08, 0.06]
position = [0.3, 0.0, 1.0]
rotation = [0.4, -0.9, 0.7]
[[bushing]]
name = "left"
between = ["ground", "box"]
at = [0.0, 0.1, 1.0]
stiffness = [4000.0, 2500.0, 3000.0, 20.0, 30.0, 40.0]
damping = [12.0, 9.0, 10.0, 0.2, 0.2, 0.2]
[[bushing]]
name = "right"
between = ["ground", "box"]
at = [0.6, -0.1, 1.1]
stiffness = [3000.0, 2000.0, 2500.0, 10.0, 20.0, 30.0]
damping = [12.0, 9.0, 10.0, 0.2, 0.2, 0.2]
[[force]]
on = "box.y"
amplitude = 0.1
angular_frequency = "Omega"
[[force]]
on = "box.rx"
amplitude = 0.015
angular_frequency = "Omega"
phase = 1.0
)";
  const auto marched = run_mechanism_study(replaced(study, "Omega = 1.0", "Omega = 20.0") + march(20.0, 40, "1e-6"));
  const auto ran = run_mechanism_study(study + response_about_rest("[20.0]"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  for (const char* name : {"box.x", "box.y"}) {
    const double wanted = last_amplitude(marched.sink, "position", name);
    EXPECT_NEAR(value_of(ran.sink, "frf", "amplitude", name), wanted, 1e-3 * wanted) << name;
  }
  for (const char* name : {"box.rx", "box.ry", "box.rz"}) {
    const double wanted = last_amplitude(marched.sink, "angle", name);
    EXPECT_NEAR(value_of(ran.sink, "frf", "angle_amplitude", name), wanted, 1e-3 * wanted) << name;
  }
}

TEST(MechanismResponses, OfABodyOnABeamAreThoseOfALongMarch) {
  const std::string study = R"(
[parameters]
Omega = 1.0
g = 9.81
[gravity]
acceleration = [0.0, 0.0, "-g"]
[[node]]
name = "a"
position = [0.0, 0.0, 0.0]
[[node]]
name = "b"
position = [1.0, 0.0, 0.0]
[[support]]
node = "a"
fix = ["x","y","z","rx","ry","rz"]
[[material]]
name = "steel"
young = 2e11
poisson = 0.3
density = 7800.0
retardation_time = 4e-3
[[section]]
name = "bar"
area = 4e-4
inertia = [1.3333e-8, 1.3333e-8]
torsion = 2.25e-8
shear_factor = 0.8333
[[beam]]
nodes = ["a","b"]
section = "bar"
material = "steel"
elements = 2
orientation = [0.0, 0.0, 1.0]
formulation = "geometrically_exact"
[[body]]
name = "box"
mass = 3.0
inertia = [0.02, 0.03, 0.04]
position = [1.0, 0.0, -0.1]
[[joint]]
name = "weld"
type = "rigid"
between = ["b", "box"]
at = [1.0, 0.0, 0.0]
[[force]]
on = "box.y"
amplitude = 1.0
angular_frequency = "Omega"
)";
  const auto marched = run_mechanism_study(replaced(study, "Omega = 1.0", "Omega = 60.0") + march(60.0, 45, "1e-6"));
  const auto ran = run_mechanism_study(study + response_about_rest("[60.0]"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double way = last_amplitude(marched.sink, "position", "box.y"),
               turn = last_amplitude(marched.sink, "angle", "box.rx");
  EXPECT_NEAR(value_of(ran.sink, "frf", "amplitude", "box.y"), way, 1e-3 * way);
  EXPECT_NEAR(value_of(ran.sink, "frf", "angle_amplitude", "box.rx"), turn, 1e-3 * turn);
}

}  // namespace
}  // namespace rubato::testing
