#include <rubato/core/error.hpp>

#include "support/mechanism_response.hpp"
#include "support/ran_study.hpp"
#include "support/run_mechanism.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

// Stops and locks in frequency responses of mechanisms about their equilibrium.
namespace rubato::testing {
namespace {

// One stop is pressed at rest and is left, the other is open and is met.
TEST(MechanismStops, AreBalancedAsThoseOfStructures) {
  const std::string stops = R"(
[[damper]]
between = ["a.x", "ground"]
damping = 4.0
[[force]]
on = "a.x"
amplitude = 5.0
angular_frequency = 0.0
[[stop]]
name = "rest"
between = ["a.x", "ground"]
gap = 0.1
stiffness = 60.0
[[stop]]
name = "bump"
between = ["b.x", "a.x"]
gap = 0.05
stiffness = 20.0
)";
  const std::string frequencies = "[2.5, 3.5, 5.0]",
                    asked = "solver = \"harmonic_balance\"\ntolerance = 1e-6\nobserve = [\"a.x\", \"b.x\"]";
  const auto carriages =
      run_mechanism_study(two_carriages + stops + response_about_rest(frequencies, "about = \"static\"\n" + asked));
  ASSERT_EQ(carriages.report.status, analysis::RunStatus::done) << carriages.report.message;
  EXPECT_TRUE(carriages.report.warnings.empty()) << carriages.report.warnings.front();
  const MemorySink masses = run_study(two_masses + stops + response_about_rest(frequencies, asked));
  expect_same(carriages.sink, masses, 3, 1e-3);  // of accelerations, whose kinks take the most orders
  for (std::size_t row = 0; row < 3; ++row) {
    const double mean = value_of(masses, "frf", "mean", "a.x", row);
    EXPECT_NEAR(value_of(carriages.sink, "frf", "mean", "a.x", row), mean, 2e-5);
    for (const char* label : {"a.x", "b.x"}) {
      const double wanted = value_of(masses, "frf", "amplitude", label, row);
      EXPECT_NEAR(value_of(carriages.sink, "frf", "amplitude", label, row), wanted, 2e-5 * wanted) << label;
    }
    EXPECT_GT(std::abs(mean - 0.11), 1e-3) << "the motion does not leave the stop";  // at rest (5 + 60*0.1)/100
  }
}

/// The flap rests on its stop with m g a/k: a motion that is larger lifts it off.
std::string flap(const std::string& force, const std::string& lock) {
  return R"(
[parameters]
Omega = 3.0
F = )" + force +
         R"(
[gravity]
acceleration = [0.0, -9.81]
[[body]]
name = "flap"
mass = 1.0
inertia = 0.05
position = [0.5, 0.0]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "flap"]
at = [0.0, 0.0]
damping = 0.5
)" + lock +
         R"(
[[force]]
on = "flap.y"
amplitude = "F"
angular_frequency = "Omega"
)";
}

TEST(MechanismStops, ThatTheMotionLeavesAreFollowed) {
  const std::string lock = "lock = { at = -0.01, kind = \"stop\", stiffness = 200.0 }";
  const std::string balanced = "about = \"static\"\nsolver = \"harmonic_balance\"\ntolerance = 1e-5";
  for (const char* force : {"2.0", "6.0"}) {  // it lifts off beyond 4.9 N, nearly
    const auto response = run_mechanism_study(flap(force, lock) + response_about_rest("[3.0]", balanced));
    ASSERT_EQ(response.report.status, analysis::RunStatus::done) << response.report.message;
    EXPECT_TRUE(response.report.warnings.empty()) << response.report.warnings.front();
    const auto marched = run_mechanism_study(flap(force, lock) + march(3.0, 40));
    const double wanted = last_amplitude(marched.sink, "angle", "hinge");
    EXPECT_NEAR(value_of(response.sink, "frf", "angle_amplitude", "flap.rz"), wanted, 2e-3 * wanted) << force;
  }
}

// The same stop as a part of its own.
TEST(MechanismStops, OfJointsAreTheirLocks) {
  const std::string frequencies = "[2.0, 3.0, 9.0]",
                    balanced = "about = \"static\"\nsolver = \"harmonic_balance\"\ntolerance = 1e-6";
  const auto lock = run_mechanism_study(flap("6.0", "lock = { at = -0.01, kind = \"stop\", stiffness = 200.0 }") +
                                        response_about_rest(frequencies, balanced));
  // A [[stop]] holds what exceeds its gap: the angle of the ground over the flap.
  const std::string turned =
      replaced(flap("6.0", "[[stop]]\nname = \"seat\"\njoint = \"hinge\"\ngap = 0.01\nstiffness = 200.0"),
               "[\"ground\", \"flap\"]", "[\"flap\", \"ground\"]");
  const auto stop = run_mechanism_study(turned + response_about_rest(frequencies, balanced));
  for (std::size_t row = 0; row < 3; ++row) {
    const double wanted = value_of(lock.sink, "frf", "amplitude", "flap.y", row);
    EXPECT_NEAR(value_of(stop.sink, "frf", "amplitude", "flap.y", row), wanted, 1e-9 * wanted);
  }
}

TEST(MechanismStops, TellOfLocksThatTheMotionComesTo) {
  const std::string locked =
      replaced(swinging_bob, "damping = 0.35",
               "damping = 0.35\nlock = { at = 0.01, kind = \"stop\", stiffness = 1e4, damping = 1.0 }");
  const auto near = run_mechanism_study(locked + response_about_rest("[3.2]"));
  ASSERT_EQ(near.report.warnings.size(), 1u);
  EXPECT_NE(near.report.warnings[0].find("comes to the lock of \"pivot\", 0.01 rad"), std::string::npos)
      << near.report.warnings[0];
  EXPECT_TRUE(
      run_mechanism_study(replaced(locked, "0.01,", "0.1,") + response_about_rest("[3.2]")).report.warnings.empty());
}

// What damps only while it holds is not followed.
TEST(MechanismStops, ThatDampTellWhereTheMotionLeavesThem) {
  const std::string lock = "lock = { at = -0.01, kind = \"stop\", stiffness = 2000.0, damping = 1.0 }";
  EXPECT_TRUE(run_mechanism_study(flap("8.0", lock) + response_about_rest("[3.0]")).report.warnings.empty());
  const auto far = run_mechanism_study(flap("12.0", lock) + response_about_rest("[3.0]"));
  ASSERT_EQ(far.report.warnings.size(), 1u);
  EXPECT_NE(far.report.warnings[0].find("leaves the lock of \"hinge\", 0.002452 rad"), std::string::npos)
      << far.report.warnings[0];
}

TEST(MechanismStops, ArePeriodicBySolversThatTakeThem) {
  const std::string study = flap("6.0", "lock = { at = -0.01, kind = \"stop\", stiffness = 200.0 }") +
                            response_about_rest("[3.0]", "about = \"static\"\nsolver = \"periodic\"");
  try {
    (void)run_mechanism_study(study);
    FAIL() << "taken";
  } catch (const InvalidInput& fault) {
    EXPECT_NE(fault.message().find("the solver periodic does not take the lock of the joint \"hinge\"; take solver = "
                                   "\"harmonic_balance\""),
              std::string::npos)
        << fault.message();
  }
}

// A force that stands still at some samples of a sweep would move the equilibrium, whatever was solved before.
TEST(MechanismLoads, ThatStandStillAreRefusedInEachSample) {
  for (const char* orders : {"[0, 1]", "[1, 0]"}) {
    const auto ran = run_mechanism_study(
        replaced(replaced(swinging_bob, "Omega = 1.0", "Omega = 1.0\nn = 1"), "\"Omega\"", "\"n*Omega\"") +
        response_about_rest("[2.0, 3.0]",
                            std::string("about = \"static\"\nexcitation = \"Omega\"\nsweep = { n = ") + orders + " }"));
    ASSERT_EQ(ran.report.warnings.size(), 1u);
    EXPECT_NE(ran.report.warnings[0].find("has a frequency of zero here (\"n*Omega\")"), std::string::npos)
        << ran.report.warnings[0];
    EXPECT_EQ(ran.sink.tables.at("frf").rows.size(), 4u);
    const std::size_t moving = orders[1] == '1' ? 0 : 2;
    for (const std::size_t row : {moving, moving + 1})
      EXPECT_GT(value_of(ran.sink, "frf", "amplitude", "bob.x", row), 0.0);
    EXPECT_TRUE(std::isnan(value_of(ran.sink, "frf", "amplitude", "bob.x", 2 - moving)));
  }
}

}  // namespace
}  // namespace rubato::testing
