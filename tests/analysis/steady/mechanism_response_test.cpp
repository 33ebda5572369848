#include <rubato/core/error.hpp>

#include "support/mechanism_response.hpp"
#include "support/ran_study.hpp"
#include "support/run_mechanism.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>

// Frequency responses of mechanisms about their static equilibrium, against structures and closed forms, and what they
// tell.
namespace rubato::testing {
namespace {

std::string message_of(const std::string& study) {
  try {
    (void)run_mechanism_study(study);
  } catch (const InvalidInput& fault) {
    return fault.message();
  }
  return {};
}

TEST(MechanismResponses, OfCarriagesOnRailsAreThoseOfMassesOnSprings) {
  const std::string frequencies = "[2.0, 3.5, 5.0, 6.8, 9.0]", asked = "observe = [\"a.x\", \"b.x\", \"b.x - a.x\"]";
  const auto carriages =
      run_mechanism_study(two_carriages + response_about_rest(frequencies, "about = \"static\"\n" + asked));
  ASSERT_EQ(carriages.report.status, analysis::RunStatus::done) << carriages.report.message;
  const MemorySink masses = run_study(two_masses + response_about_rest(frequencies, asked));
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
      run_mechanism_study(two_carriages + laws + response_about_rest(frequencies, "about = \"static\"\n" + asked));
  ASSERT_EQ(carriages.report.status, analysis::RunStatus::done) << carriages.report.message;
  const MemorySink masses = run_study(two_masses + laws + response_about_rest(frequencies, asked));
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
  const auto of_body =
      run_mechanism_study(hanging + response_about_rest("[6.0, 9.0, 12.0]", "about = \"static\"\n" + asked));
  ASSERT_EQ(of_body.report.status, analysis::RunStatus::done) << of_body.report.message;
  const MemorySink of_mass = run_study(mass + response_about_rest("[6.0, 9.0, 12.0]", asked));
  for (std::size_t row = 0; row < 3; ++row) {
    const double wanted = value_of(of_mass, "frf", "amplitude", "load.y", row);
    EXPECT_NEAR(value_of(of_body.sink, "frf", "amplitude", "load.y", row), wanted, 1e-5 * wanted);
    EXPECT_NEAR(value_of(of_body.sink, "frf", "mean", "load.y", row) - 0.5,
                value_of(of_mass, "frf", "mean", "load.y", row), 1e-5);
    EXPECT_NEAR(value_of(of_body.sink, "frf", "dissipated", "mount", row),
                value_of(of_mass, "frf", "dissipated", "mount", row), 1e-4);
  }
}
// (m l^2 + J) x'' + c x' + m g l x = F l cos(Omega t): the weight is stiffness by the reaction of the pivot alone.
TEST(MechanismResponses, OfAPendulumAreThoseOfItsWeight) {
  const auto ran = run_mechanism_study(swinging_bob + response_about_rest("{ from = 1.0, to = 8.0, points = 15 }"));
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
TEST(MechanismResponses, TellOfTurnsThatAreNotSmall) {
  const auto ran =
      run_mechanism_study(replaced(swinging_bob, "F = 0.05", "F = 1.0") + response_about_rest("[2.0, 3.4]"));
  ASSERT_EQ(ran.report.warnings.size(), 1u);
  EXPECT_NE(ran.report.warnings[0].find("\"bob.rz\" turns by"), std::string::npos) << ran.report.warnings[0];
}
TEST(MechanismResponses, AreRefusedWithoutAPlaceToSwingAbout) {
  EXPECT_EQ(message_of(swinging_bob + response_about_rest("[2.0]", "")),
            "analysis \"frf\": a mechanism (bodies, joints, geometrically exact beams) answers harmonic loads by small "
            "motions about its static equilibrium: add about = \"static\", or run a transient");
  const auto upright = replaced(replaced(swinging_bob, "[0.0, -0.8]", "[0.0, 0.8]"), "damping = 0.35", "");
  EXPECT_NE(message_of(upright + response_about_rest("[2.0]")).find("is not stable"), std::string::npos);
}

TEST(MechanismResponses, AreRefusedForWhatSmallMotionsDoNotCarry) {
  const auto with = [](const std::string& key) {
    return replaced(swinging_bob, "damping = 0.35", key) + response_about_rest("[2.0]");
  };
  EXPECT_NE(message_of(with("friction = { coefficient = 0.1, preload = 2.0, radius = 0.01 }"))
                .find("take a [[slider]] with a stiffness"),
            std::string::npos);
  EXPECT_NE(message_of(with("moment = \"-2*angle^3\"")).find("[[nonlinear_spring]]"), std::string::npos);
  EXPECT_NE(message_of(with("drive = \"0.1*sin(t)\"")).find("the drive of \"pivot\" moves it"), std::string::npos);
  const std::string follower = replaced(swinging_bob, "on = \"bob.x\"", "on = \"bob.x\"\nfollowing = true");
  EXPECT_NE(message_of(follower + response_about_rest("[2.0]")).find("turns with its body"), std::string::npos);
  // Also where the value in the study, which the response replaces, would let it stand still.
  EXPECT_NE(message_of(replaced(follower, "Omega = 1.0", "Omega = 0.0") + response_about_rest("[2.0]"))
                .find("turns with its body"),
            std::string::npos);
  const std::string still = replaced(swinging_bob, "[[force]]", R"(
[[force]]
on = "bob.y"
amplitude = 3.0
angular_frequency = "0*Omega"
[[force]])");
  EXPECT_NE(message_of(still + response_about_rest("[2.0]")).find("would move the equilibrium"), std::string::npos);
  const std::string pushed = replaced(swinging_bob, "[[force]]", R"(
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
  EXPECT_NE(message_of(pushed + response_about_rest("[2.0]")).find("have no potential"), std::string::npos);
}

}  // namespace
}  // namespace rubato::testing
