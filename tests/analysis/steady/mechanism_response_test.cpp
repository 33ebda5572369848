#include <rubato/core/error.hpp>

#include "support/ran_study.hpp"
#include "support/run_mechanism.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

// Frequency responses of mechanisms about their static equilibrium, against structures, closed forms and long
// transients.
namespace rubato::testing {
namespace {

using std::numbers::pi;

/// A response of the model before it.
std::string response(const std::string& frequencies, const std::string& more = "about = \"static\"") {
  return R"(
[[analysis]]
name = "frf"
type = "frequency_response"
angular_frequency = )" +
         frequencies + "\n" + more + "\n";
}

/// A march of the same model that is long enough to forget its start.
std::string march(double omega, int periods, const std::string& tolerance = "1e-7") {
  const double period = 2.0 * pi / omega;
  return fmt::format(R"(
[[analysis]]
name = "march"
type = "transient"
initial = "static"
duration = {:.17g}
step = {{ tolerance = {} }}
output = {{ interval = {:.17g} }}
)",
                     period * periods, tolerance, period / 256.0);
}

/// Half of the peak to peak of a column over the last period of a march of 256 rows a period.
double last_amplitude(const MemorySink& sink, const std::string& variable, const std::string& label) {
  const auto& table = sink.tables.at("march");
  const std::size_t column = table.column(variable, label), rows = table.rows.size();
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (std::size_t row = rows - 257; row < rows; ++row) {
    low = std::min(low, table.rows[row][column]);
    high = std::max(high, table.rows[row][column]);
  }
  return 0.5 * (high - low);
}

std::string message_of(const std::string& study) {
  try {
    (void)run_mechanism_study(study);
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
  return {};
}

const std::string two_carriages = R"(
[parameters]
Omega = 1.0
[[body]]
name = "a"
mass = 2.0
inertia = 0.1
position = [0.0, 0.0]
[[body]]
name = "b"
mass = 1.0
inertia = 0.1
position = [1.0, 0.0]
[[joint]]
name = "rail_a"
type = "prismatic"
between = ["ground", "a"]
at = [0.0, 0.0]
axis = [1.0, 0.0]
stiffness = 40.0
damping = 0.3
[[joint]]
name = "rail_b"
type = "prismatic"
between = ["ground", "b"]
at = [1.0, 0.0]
axis = [1.0, 0.0]
[[spring]]
between = ["a.x", "b.x"]
stiffness = 25.0
[[damper]]
between = ["a.x", "b.x"]
damping = 0.2
[[force]]
on = "b.x"
amplitude = 3.0
angular_frequency = "Omega"
phase = 0.4
)";

const std::string two_masses = R"(
[parameters]
Omega = 1.0
[[coordinate]]
name = "a.x"
mass = 2.0
[[coordinate]]
name = "b.x"
mass = 1.0
[[spring]]
between = ["a.x", "ground"]
stiffness = 40.0
[[damper]]
between = ["a.x", "ground"]
damping = 0.3
[[spring]]
between = ["a.x", "b.x"]
stiffness = 25.0
[[damper]]
between = ["a.x", "b.x"]
damping = 0.2
[[force]]
on = "b.x"
amplitude = 3.0
angular_frequency = "Omega"
phase = 0.4
)";

void expect_same(const MemorySink& one, const MemorySink& other, std::size_t rows, double tolerance) {
  for (std::size_t row = 0; row < rows; ++row)
    for (const char* label : {"a.x", "b.x"})
      for (const char* variable :
           {"amplitude", "velocity_amplitude", "acceleration_amplitude", "phase", "viscous_work", "input_work"}) {
        const std::string of = std::string(variable).find("work") == std::string::npos ? label : "";
        const double wanted = value_of(other, "frf", variable, of, row);
        EXPECT_NEAR(value_of(one, "frf", variable, of, row), wanted, tolerance * (1.0 + std::abs(wanted)))
            << variable << " of " << label << " at row " << row;
      }
}

TEST(MechanismResponses, OfCarriagesOnRailsAreThoseOfMassesOnSprings) {
  const std::string frequencies = "[2.0, 3.5, 5.0, 6.8, 9.0]", asked = "observe = [\"a.x\", \"b.x\", \"b.x - a.x\"]";
  const auto carriages = run_mechanism_study(two_carriages + response(frequencies, "about = \"static\"\n" + asked));
  ASSERT_EQ(carriages.report.status, analysis::RunStatus::done) << carriages.report.message;
  const MemorySink masses = run_study(two_masses + response(frequencies, asked));
  expect_same(carriages.sink, masses, 5, 1e-9);
  for (std::size_t row = 0; row < 5; ++row) {
    const double wanted = value_of(masses, "frf", "amplitude", "b.x - a.x", row);
    EXPECT_NEAR(value_of(carriages.sink, "frf", "amplitude", "b.x - a.x", row), wanted, 1e-9);
    // Positions are those of the world: b rests at 1.
    EXPECT_NEAR(value_of(carriages.sink, "frf", "mean", "b.x", row), 1.0, 1e-12);
    EXPECT_NEAR(value_of(carriages.sink, "frf", "rms", "b.x", row),
                std::sqrt(1.0 + 0.5 * std::pow(value_of(masses, "frf", "amplitude", "b.x", row), 2)), 1e-9);
  }
}

TEST(MechanismResponses, OfSlidersAndLawsAreBalancedAsThoseOfStructures) {
  const std::string laws = R"(
[[slider]]
name = "rub"
between = ["a.x", "ground"]
stiffness = 30.0
friction_coefficient = 0.5
normal_load = 1.0
[[bouc_wen]]
name = "mount"
between = ["a.x", "b.x"]
stiffness = 8.0
post_yield_ratio = 0.1
[[nonlinear_spring]]
name = "rubber"
between = ["b.x", "ground"]
force = "2*u + 5*u^3 + 0.1*rate"
)";
  const std::string frequencies = "[3.0, 4.0, 5.0]",
                    asked = "solver = \"harmonic_balance\"\ntolerance = 1e-5\nobserve = [\"a.x\", \"b.x\"]";
  const auto carriages =
      run_mechanism_study(two_carriages + laws + response(frequencies, "about = \"static\"\n" + asked));
  ASSERT_EQ(carriages.report.status, analysis::RunStatus::done) << carriages.report.message;
  const MemorySink masses = run_study(two_masses + laws + response(frequencies, asked));
  expect_same(carriages.sink, masses, 3, 1e-4);
  for (std::size_t row = 0; row < 3; ++row)
    for (const char* law : {"rub", "mount"}) {
      const double wanted = value_of(masses, "frf", "dissipated", law, row);
      EXPECT_GT(wanted, 0.0);
      EXPECT_NEAR(value_of(carriages.sink, "frf", "dissipated", law, row), wanted, 1e-3 * wanted) << law;
    }
}

/// A body that hangs on a spring which stiffens, or the mass with its weight as a force.
TEST(MechanismResponses, OfLawsThatAreStretchedAtRestSeeThemFromThere) {
  const std::string law = R"(
force = "60*u + 4000*u^3"
)";
  const std::string hanging = R"(
[parameters]
Omega = 1.0
[gravity]
acceleration = [0.0, -9.81]
[[body]]
name = "load"
mass = 2.0
inertia = 0.1
position = [0.0, 0.5]
[[joint]]
name = "rail"
type = "prismatic"
between = ["ground", "load"]
at = [0.0, 0.5]
axis = [0.0, 1.0]
damping = 3.0
[[nonlinear_spring]]
name = "spring"
joint = "rail"
)" + law + R"(
[[bouc_wen]]
name = "mount"
joint = "rail"
stiffness = 30.0
post_yield_ratio = 0.2
[[force]]
on = "load.y"
amplitude = 6.0
angular_frequency = "Omega"
)";
  const std::string mass = R"(
[parameters]
Omega = 1.0
[[coordinate]]
name = "load.y"
mass = 2.0
[[damper]]
between = ["load.y", "ground"]
damping = 3.0
[[nonlinear_spring]]
name = "spring"
between = ["load.y", "ground"]
)" + law + R"(
[[bouc_wen]]
name = "mount"
between = ["load.y", "ground"]
stiffness = 30.0
post_yield_ratio = 0.2
[[force]]
on = "load.y"
expression = "-2*9.81"
[[force]]
on = "load.y"
amplitude = 6.0
angular_frequency = "Omega"
)";
  const std::string asked = "solver = \"harmonic_balance\"\ntolerance = 1e-6\nobserve = [\"load.y\"]";
  const auto of_body = run_mechanism_study(hanging + response("[6.0, 9.0, 12.0]", "about = \"static\"\n" + asked));
  ASSERT_EQ(of_body.report.status, analysis::RunStatus::done) << of_body.report.message;
  const MemorySink of_mass = run_study(mass + response("[6.0, 9.0, 12.0]", asked));
  for (std::size_t row = 0; row < 3; ++row) {
    const double wanted = value_of(of_mass, "frf", "amplitude", "load.y", row);
    EXPECT_NEAR(value_of(of_body.sink, "frf", "amplitude", "load.y", row), wanted, 1e-5 * wanted);
    EXPECT_NEAR(value_of(of_body.sink, "frf", "mean", "load.y", row) - 0.5,
                value_of(of_mass, "frf", "mean", "load.y", row), 1e-5);
    EXPECT_NEAR(value_of(of_body.sink, "frf", "dissipated", "mount", row),
                value_of(of_mass, "frf", "dissipated", "mount", row), 1e-4);
  }
}

const std::string pendulum = R"(
[parameters]
Omega = 1.0
F = 0.05
[gravity]
acceleration = [0.0, -9.81]
[[body]]
name = "bob"
mass = 1.5
inertia = 0.02
position = [0.0, -0.8]
[[joint]]
name = "pivot"
type = "revolute"
between = ["ground", "bob"]
at = [0.0, 0.0]
damping = 0.35
[[force]]
on = "bob.x"
amplitude = "F"
angular_frequency = "Omega"
)";

// (m l^2 + J) x'' + c x' + m g l x = F l cos(Omega t): the weight is stiffness by the reaction of the pivot alone.
TEST(MechanismResponses, OfAPendulumAreThoseOfItsWeight) {
  const auto ran = run_mechanism_study(pendulum + response("{ from = 1.0, to = 8.0, points = 15 }"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double l = 0.8, inertia = 1.5 * l * l + 0.02;
  for (std::size_t row = 0; row < 15; ++row) {
    const double w = value_of(ran.sink, "frf", "angular_frequency", "", row);
    const std::complex<double> angle = 0.05 * l / std::complex<double>(1.5 * 9.81 * l - w * w * inertia, 0.35 * w);
    EXPECT_NEAR(value_of(ran.sink, "frf", "angle_amplitude", "bob.rz", row), std::abs(angle), 1e-9 * std::abs(angle));
    EXPECT_NEAR(value_of(ran.sink, "frf", "amplitude", "bob.x", row), l * std::abs(angle), 1e-9 * std::abs(angle));
    EXPECT_NEAR(value_of(ran.sink, "frf", "amplitude", "bob.y", row), 0.0, 1e-12);
    EXPECT_NEAR(value_of(ran.sink, "frf", "mean", "bob.y", row), -l, 1e-12);
    EXPECT_NEAR(value_of(ran.sink, "frf", "phase", "bob.rz", row), std::arg(angle), 1e-8);
  }
  EXPECT_TRUE(ran.report.warnings.empty()) << ran.report.warnings.front();
}

TEST(MechanismResponses, OfAPendulumAreThoseOfALongMarch) {
  const std::string at = "Omega = 1.0", here = "Omega = 3.0";
  const auto marched = run_mechanism_study(replaced(pendulum, at, here) + march(3.0, 40));
  const auto ran = run_mechanism_study(pendulum + response("[3.0]"));
  const double wanted = last_amplitude(marched.sink, "angle", "bob.rz");
  EXPECT_NEAR(value_of(ran.sink, "frf", "angle_amplitude", "bob.rz"), wanted, 1e-4 * wanted);
}

TEST(MechanismResponses, TellOfTurnsThatAreNotSmall) {
  const auto ran = run_mechanism_study(replaced(pendulum, "F = 0.05", "F = 1.0") + response("[2.0, 3.4]"));
  ASSERT_EQ(ran.report.warnings.size(), 1u);
  EXPECT_NE(ran.report.warnings[0].find("\"bob.rz\" turns by"), std::string::npos) << ran.report.warnings[0];
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
  const auto ran = run_mechanism_study(study + response(fmt::format("[{}]", omega), "about = \"static\"\n" + solver));
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
  const auto ran = run_mechanism_study(study + response("[20.0]"));
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

TEST(MechanismResponses, AreRefusedWithoutAPlaceToSwingAbout) {
  EXPECT_EQ(message_of(pendulum + response("[2.0]", "")),
            "analysis \"frf\": a mechanism (bodies, joints, geometrically exact beams) answers harmonic loads by small "
            "motions about its static equilibrium: add about = \"static\", or run a transient");
  const auto upright = replaced(replaced(pendulum, "[0.0, -0.8]", "[0.0, 0.8]"), "damping = 0.35", "");
  EXPECT_NE(message_of(upright + response("[2.0]")).find("is not stable"), std::string::npos);
}

TEST(MechanismResponses, AreRefusedForWhatSmallMotionsDoNotCarry) {
  const auto with = [](const std::string& key) {
    return replaced(pendulum, "damping = 0.35", key) + response("[2.0]");
  };
  EXPECT_NE(message_of(with("friction = { coefficient = 0.1, preload = 2.0, radius = 0.01 }"))
                .find("take a [[slider]] with a stiffness"),
            std::string::npos);
  EXPECT_NE(message_of(with("moment = \"-2*angle^3\"")).find("[[nonlinear_spring]]"), std::string::npos);
  EXPECT_NE(message_of(with("drive = \"0.1*sin(t)\"")).find("the drive of \"pivot\" moves it"), std::string::npos);
  const std::string follower = replaced(pendulum, "on = \"bob.x\"", "on = \"bob.x\"\nfollowing = true");
  EXPECT_NE(message_of(follower + response("[2.0]")).find("turns with its body"), std::string::npos);
  const std::string pushed = replaced(pendulum, "[[force]]", R"(
[[body]]
name = "tip"
mass = 0.5
inertia = 0.01
position = [0.0, -1.2]
[[joint]]
name = "elbow"
type = "revolute"
between = ["bob", "tip"]
at = [0.0, -1.0]
[[force]]
on = "tip.y"
expression = "3.0"
following = true
[[force]])");
  EXPECT_NE(message_of(pushed + response("[2.0]")).find("have no potential"), std::string::npos);
}

TEST(MechanismResponses, TellOfLocksThatTheMotionComesTo) {
  const std::string locked =
      replaced(pendulum, "damping = 0.35", "damping = 0.35\nlock = { at = 0.01, kind = \"stop\", stiffness = 1e4 }");
  const auto near = run_mechanism_study(locked + response("[3.2]"));
  ASSERT_EQ(near.report.warnings.size(), 1u);
  EXPECT_NE(near.report.warnings[0].find("comes to the lock of \"pivot\", 0.01 rad"), std::string::npos)
      << near.report.warnings[0];
  EXPECT_TRUE(run_mechanism_study(replaced(locked, "0.01,", "0.1,") + response("[3.2]")).report.warnings.empty());
}

}  // namespace
}  // namespace rubato::testing
