#include <rubato/analysis/failure_text.hpp>
#include <rubato/core/error.hpp>
#include <rubato/integrate/mechanism/mechanism_failure.hpp>
#include <rubato/model/joints/plane_joints.hpp>

#include <support/double_pendulum.hpp>
#include <support/run_mechanism.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace rubato {
namespace {

using Ran = testing::RanMechanism;
using testing::example;
using testing::replaced;

Ran run(const std::string& text) { return testing::run_mechanism_study(text); }

TEST(MechanismStudies, RunTheDoublePendulumOfThePaper) {
  const Ran ran = run(example("double-pendulum"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("motion");
  EXPECT_NEAR(double(table.rows.size() - 1), 877.0, 0.03 * 877.0);
  const auto& last = table.rows.back();
  EXPECT_DOUBLE_EQ(last[0], 5.0);
  const auto exact = testing::double_pendulum_at(5.0);
  const char* const names[] = {"1.x", "1.y", "2.x", "2.y"};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(last[table.column("position", names[i])], exact[i], 2e-3);
  // Tensions pull. They are as exact as the motion, times the masses and (10 rad/s)^2.
  EXPECT_NEAR(last[table.column("reaction_tension", "upper")], 52.163, 0.3);
  EXPECT_NEAR(last[table.column("reaction_tension", "lower")], 6.797, 0.3);
  const auto& ledger = ran.sink.tables.at("motion.energy");
  EXPECT_NEAR(ledger.rows.back()[ledger.column("residue")], -0.022, 0.022);
}

TEST(MechanismStudies, RunTheLockingBarsOfThePaper) {
  const Ran ran = run(example("locking-bars"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("motion");
  EXPECT_NEAR(table.rows.front()[table.column("angle", "B")], 1.0471975511965976, 1e-12);
  EXPECT_NEAR(table.rows.back()[table.column("angle", "B")], 2.436617153, 2.7e-3);
  const auto& events = ran.sink.tables.at("motion.events");
  ASSERT_EQ(events.rows.size(), 2u);
  EXPECT_NEAR(events.rows[0][0], 1.371521056, 2e-5);
  const auto& ledger = ran.sink.tables.at("motion.energy");
  EXPECT_LT(std::abs(ledger.rows.back()[ledger.column("residue")]), 8.0);
  EXPECT_EQ(ran.report.findings.size(), 2u);
}

TEST(MechanismStudies, WriteRowsAtRequestedTimesWithoutBendingTheSteps) {
  const std::string text =
      replaced(example("double-pendulum"), "duration = 5.0", "output = { interval = 0.5 }\nduration = 5.0");
  const Ran ran = run(text);
  const auto& table = ran.sink.tables.at("motion");
  ASSERT_EQ(table.rows.size(), 11u);
  const auto at_two = testing::double_pendulum_at(2.0);
  EXPECT_DOUBLE_EQ(table.rows[4][0], 2.0);
  EXPECT_NEAR(table.rows[4][table.column("position", "2.x")], at_two[2], 2e-3);
  // Between the ends of a step the links stay as long as the polynomial is exact: (4 rad/s * 6 ms)^4 = 3e-7.
  const double x = table.rows[5][table.column("position", "1.x")], y = table.rows[5][table.column("position", "1.y")];
  EXPECT_NEAR(std::hypot(x, y), 1.0, 1e-6);
}

// Steps of 10 ms pass over the fast modes of the beams. Between steps a polynomial through values stays within 1.7
// times of them; one through slopes would make reactions that nothing made.
TEST(MechanismStudies, InventNoMotionBetweenLongSteps) {
  const std::string text = example("locking-bars");
  const std::size_t method = text.find("method = "), duration = text.find("duration = ");
  const std::string coarse =
      text.substr(0, method) + "method = \"generalized_alpha\"\nstep = 0.01\n" + text.substr(duration);
  const Ran ends = run(coarse), between = run(coarse + "\noutput = { interval = 0.002 }\n");
  const auto largest = [](const Ran& ran, const std::string& table, const char* variable, const char* label) {
    double value = 0.0;
    const auto& rows = ran.sink.tables.at(table);
    for (const auto& row : rows.rows) value = std::max(value, std::abs(row[rows.column(variable, label)]));
    return value;
  };
  EXPECT_LE(largest(between, "motion", "reaction_x", "B"), 1.7 * largest(ends, "motion", "reaction_x", "B"));
  EXPECT_LE(largest(between, "motion", "angular_acceleration", "B1.rz"),
            1.7 * largest(ends, "motion", "angular_acceleration", "B1.rz"));
}

// Velocities are projected in each step; what Newton's own matrix, with the stiffness of the rod, would make of that
// takes 12 % of the drive's work.
TEST(MechanismStudies, BookWhatADriveGivesToAStiffRod) {
  std::string text = example("slider-crank-flexible");
  const Ran ran = run(text);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& ledger = ran.sink.tables.at("motion.energy");
  EXPECT_GT(ledger.rows.back()[ledger.column("drive_work")], 40.0);
  EXPECT_LT(std::abs(ledger.rows.back()[ledger.column("residue")]), 0.5);
}

// What cannot turn is no part of a joint that would turn it; two links may share it.
TEST(MechanismStudies, RefuseAMassThatDoesNotTurnWhereAJointWouldTurnIt) {
  const auto verdict = [](const std::string& joint) {
    const std::string text = "[[node]]\nname = \"m\"\nposition = [1.0, 0.0]\n[[mass]]\nnode = \"m\"\nmass = 1.0\n" +
                             joint +
                             "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = 0.01\nduration = 0.02\n";
    try {
      return run(text).report.message;
    } catch (const InvalidInput& fault) {
      return std::string(fault.what());
    }
  };
  const std::string between = "[[joint]]\nbetween = [\"ground\", \"m\"]\n";
  for (const std::string joint : {"type = \"revolute\"\nat = [0.0, 0.0]\n", "type = \"rigid\"\nat = [1.0, 0.0]\n",
                                  "type = \"revolute\"\nat = [1.0, 0.0]\nstiffness = 1.0\n",
                                  "type = \"distance\"\nat = [0.0, 0.0]\nto = [2.0, 0.0]\n"})
    EXPECT_NE(verdict(between + joint).find("joins \"m\", a mass that does not turn"), std::string::npos) << joint;
  for (const std::string joint : {"type = \"distance\"\nat = [0.0, 0.0]\n", "type = \"revolute\"\nat = [1.0, 0.0]\n"})
    EXPECT_EQ(verdict(between + joint), "") << joint;
}

TEST(MechanismStudies, BookWhatARigidLatchTakes) {
  const Ran ran = run(replaced(example("locking-bars"), "kind = \"stop\", stiffness = 1e7", "kind = \"latch\""));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& ledger = ran.sink.tables.at("motion.energy");
  const auto& last = ledger.rows.back();
  EXPECT_GT(last[ledger.column("lock_dissipated")], 0.0);
  EXPECT_LE(last[ledger.column("residue")], 1e-6);
  // HHT with alpha = -0.15 damps the vibrations that the lock leaves, less than a hundredth of 4188 J.
  EXPECT_GT(last[ledger.column("residue")], -41.9);
}

// Its acceleration at the start points 9.81 m/s2 away, for fifty seconds; the rod keeps it within a metre.
TEST(MechanismStudies, KeepAPendulumReleasedFromTheHorizontalOnItsSwing) {
  const Ran ran = run(R"(
[[body]]
name = "bob"
mass = 1.0
inertia = 0.1
position = [1.0, 0.0]
[[joint]]
name = "pin"
type = "revolute"
between = ["ground", "bob"]
at = [0.0, 0.0]
[gravity]
acceleration = [0.0, -9.81]
[[analysis]]
name = "run"
type = "transient"
step = { tolerance = 1e-3 }
duration = 50.0
output = { interval = 0.05 }
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("run");
  double lowest = 0.0, highest = -10.0;
  for (const auto& row : table.rows) {
    lowest = std::min(lowest, row[table.column("angle", "pin")]);
    highest = std::max(highest, row[table.column("angle", "pin")]);
  }
  // A thousandth of the size of the motion, and the angle at rest is flat in it.
  EXPECT_NEAR(lowest, -std::acos(-1.0), 0.01);
  EXPECT_LT(highest, 0.01);
  const auto& ledger = ran.sink.tables.at("run.energy");
  for (const auto& row : ledger.rows) ASSERT_NEAR(row[ledger.column("residue")], 0.0, 1e-2 * 9.81);
}

TEST(MechanismStudies, RefuseAMethodThatDoesNotDampTheMultipliersUnlessForced) {
  const std::string undamped = replaced(example("double-pendulum"), "alpha = -0.15", "alpha = 0.0");
  EXPECT_THROW(run(undamped), InvalidInput);
  EXPECT_NO_THROW(run(replaced(undamped, "duration = 5.0", "duration = 0.1\nallow_unstable = true")));
}

TEST(MechanismStudies, MoveWhatIsNotAssembledAndSaySo) {
  const Ran ran = run(replaced(example("double-pendulum"), "at = [0.0, 0.0]", "at = [0.0, 0.0]\nlength = 1.01"));
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done);
  ASSERT_EQ(ran.report.warnings.size(), 1u);
  EXPECT_NE(ran.report.warnings[0].find("the positions given do not satisfy the joints"), std::string::npos);
  EXPECT_NE(ran.report.warnings[0].find("by 0.01"), std::string::npos);
}

TEST(MechanismStudies, RefuseWhatCannotBeAssembledAndSayHowFarApart) {
  const std::string apart =
      replaced(example("double-pendulum"), "[gravity]",
               "[[joint]]\nname = \"stay\"\ntype = \"distance\"\nbetween = [\"ground\", \"2\"]\nat = [9.0, 0.0]\n"
               "length = 1.0\n\n[gravity]");
  try {
    run(apart);
    FAIL() << "assembled";
  } catch (const InvalidInput& fault) {
    EXPECT_NE(std::string(fault.what()).find("the joints cannot be assembled"), std::string::npos) << fault.what();
  }
}

TEST(MechanismStudies, NameTheLawThatReturnsANumberThatIsNotFinite) {
  for (const std::string law : {"log(t - 1)", "log(angle - 4)", "sqrt(angle - pi/3)"}) {
    try {
      run(replaced(example("locking-bars"), "moment = 2000.0", "moment = \"" + law + "\""));
      FAIL() << "started";
    } catch (const InvalidInput& fault) {
      EXPECT_NE(std::string(fault.what()).find("law of \"B\" is not finite"), std::string::npos) << fault.what();
    }
  }
  const Ran later = run(replaced(example("locking-bars"), "moment = 2000.0", "moment = \"2000*sqrt(0.1 - t)\""));
  EXPECT_EQ(later.report.status, analysis::RunStatus::failed);
  EXPECT_NE(later.report.message.find("the law of \"B\""), std::string::npos) << later.report.message;
  EXPECT_FALSE(later.sink.tables.at("motion").rows.empty());
}

TEST(MechanismStudies, RefuseAnalysesOfStructures) {
  const std::string text = example("double-pendulum");
  const std::string response = text.substr(0, text.find("[[analysis]]")) +
                               "[[analysis]]\nname = \"m\"\ntype = \"frequency_response\"\nangular_frequency = [1.0]\n";
  EXPECT_THROW(run(response), InvalidInput);
}

/// The double pendulum held level and to one side, with nothing but gravity.
std::string level_pendulum() {
  std::string text = example("double-pendulum");
  text = replaced(text, "position = [0.0, -1.0]", "position = [0.6, -0.8]");
  text = replaced(text, "position = [0.0, -2.0]", "position = [1.6, -0.8]");
  return text.substr(0, text.find("[[force]]"));
}

// The double pendulum of two masses at rest: links of 1 m hang down, tensions (m1 + m2) g and m2 g.
TEST(MechanismStudies, FindTheStaticEquilibriumOfThePendulum) {
  const std::string hanging = level_pendulum() + "[[analysis]]\nname = \"rest\"\ntype = \"static\"\n";
  const Ran ran = run(hanging);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("rest");
  ASSERT_EQ(table.rows.size(), 1u);
  const auto& row = table.rows.front();
  // Newton's method ends at 1e-10 of the size, about 1 m.
  EXPECT_NEAR(row[table.column("position", "1.x")], 0.0, 1e-8);
  EXPECT_NEAR(row[table.column("position", "2.y")], -2.0, 1e-8);
  const double lower = row[table.column("reaction_tension", "lower")];
  EXPECT_NEAR(lower, 2.0 * 9.81, 1e-6);
  EXPECT_NEAR(row[table.column("reaction_tension", "upper")], lower + 5.0 * 9.81, 1e-6);
}

// Modes about the hanging position solve m1 x^2 - 2 (m1 + m2) x + (m1 + m2) = 0 with x = omega^2/g.
TEST(MechanismStudies, FindTheModesAboutTheirEquilibrium) {
  const std::string hanging = level_pendulum() + "[[analysis]]\nname = \"m\"\ntype = \"modes\"\nabout = \"static\"\n";
  const Ran ran = run(hanging);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("m");
  ASSERT_EQ(table.rows.size(), 2u);
  const double root = std::sqrt(49.0 - 35.0);
  EXPECT_NEAR(table.rows[0][table.column("angular_frequency")], std::sqrt(9.81 * (7.0 - root) / 5.0), 1e-7);
  EXPECT_NEAR(table.rows[1][table.column("angular_frequency")], std::sqrt(9.81 * (7.0 + root) / 5.0), 1e-7);
  // Level, where it starts, it is no equilibrium.
  const Ran level = run(replaced(hanging, "about = \"static\"", ""));
  ASSERT_FALSE(level.report.warnings.empty());
  EXPECT_NE(level.report.warnings[0].find("is no equilibrium"), std::string::npos) << level.report.warnings[0];
}

TEST(MechanismStudies, StartFromTheirStaticEquilibrium) {
  const std::string hanging = level_pendulum() +
                              "[[analysis]]\nname = \"m\"\ntype = \"transient\"\ninitial = \"static\"\nstep = 0.01\n"
                              "duration = 1.0\n";
  const Ran ran = run(hanging);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("m");
  for (const auto& row : table.rows) {
    EXPECT_NEAR(row[table.column("position", "2.x")], 0.0, 1e-7);
    EXPECT_NEAR(row[table.column("velocity", "2.x")], 0.0, 1e-7);
  }
}

// A push of 1 m/s on a bob of m = 2 and J = 1 that hangs 1 m below its pin: the angular momentum about the pin stays, m
// l v = (J + m l^2) w, and of m v^2/2 = 1 J (m l v)^2/(2 (J + m l^2)) = 2/3 J are left.
TEST(MechanismStudies, StartFromTheirStaticEquilibriumWithTheVelocitiesGiven) {
  const std::string text =
      "[[body]]\nname = \"bob\"\nmass = 2.0\ninertia = 1.0\nposition = [0.0, -1.0]\nvelocity = [1.0, 0.0]\n[[joint]]\n"
      "type = \"revolute\"\nbetween = [\"ground\", \"bob\"]\nat = [0.0, 0.0]\n[gravity]\nacceleration = [0.0, -10.0]\n"
      "[[analysis]]\nname = \"m\"\ntype = \"transient\"\ninitial = \"static\"\nstep = 0.01\nduration = 0.02\n";
  const Ran ran = run(text);
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("m");
  EXPECT_NEAR(table.rows[0][table.column("velocity", "bob.x")], 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(table.rows[0][table.column("angular_velocity", "bob.rz")], 2.0 / 3.0, 1e-12);
  ASSERT_EQ(ran.report.warnings.size(), 1u);
  EXPECT_NE(ran.report.warnings[0].find("rad/s, which took 0.3333 J"), std::string::npos) << ran.report.warnings[0];
}

/// A bar of J = 0.3 + 2*0.49 = 1.28 kg m2 about its pin, upright, its centre 0.7 m above.
std::string upright_bar(const std::string& analysis) {
  return "[[body]]\nname = \"bar\"\nmass = 2.0\ninertia = 0.3\nposition = [0.0, 0.7]\n[[joint]]\nname = \"pin\"\ntype "
         "= "
         "\"revolute\"\nbetween = [\"ground\", \"bar\"]\nat = [0.0, 0.0]\n[gravity]\nacceleration = [0.0, -9.81]\n"
         "[[analysis]]\nname = \"m\"\n" +
         analysis;
}

// It falls as exp(sqrt(m g l/J) t) = exp(3.276/s t).
TEST(MechanismStudies, SayThatAnEquilibriumIsNotStable) {
  const Ran rest = run(upright_bar("type = \"static\"\n"));
  EXPECT_EQ(rest.report.status, analysis::RunStatus::done) << rest.report.message;
  ASSERT_EQ(rest.report.findings.size(), 1u);
  EXPECT_NE(rest.report.findings[0].find("the equilibrium is not stable"), std::string::npos);
  const auto& table = rest.sink.tables.at("m");
  EXPECT_NEAR(table.rows[0][table.column("position", "bar.y")], 0.7, 1e-12);
  const Ran modes = run(upright_bar("type = \"modes\"\nabout = \"static\"\n"));
  EXPECT_EQ(modes.report.status, analysis::RunStatus::failed);
  EXPECT_NE(
      modes.report.message.find("the equilibrium is not stable: a motion that the joints leave goes away from it, "
                                "as exp(3.276/s t)"),
      std::string::npos)
      << modes.report.message;
  EXPECT_NE(modes.report.message.find("begin beside it"), std::string::npos) << modes.report.message;
  const Ran beside =
      run(upright_bar("type = \"modes\"\nabout = \"static\"\n") +
          "[[body]]\nname = \"stiff\"\nmass = 1.0\ninertia = 1.0\nposition = [3.0, 0.0]\n[[joint]]\ntype = "
          "\"prismatic\"\nbetween = [\"ground\", \"stiff\"]\nat = [3.0, 0.0]\naxis = [1.0, 0.0]\nstiffness "
          "= 1e12\n");
  EXPECT_EQ(beside.report.status, analysis::RunStatus::failed);
  const Ran motion = run(upright_bar("type = \"transient\"\ninitial = \"static\"\nstep = 0.01\nduration = 0.1\n"));
  ASSERT_EQ(motion.report.warnings.size(), 1u);
  EXPECT_NE(motion.report.warnings[0].find("is not stable"), std::string::npos) << motion.report.warnings[0];
}

// Without loads any configuration is one.
TEST(MechanismStudies, FindAnEquilibriumThatIsNeutral) {
  const std::string text = upright_bar("type = \"static\"\n");
  const std::string gravity = "[gravity]\nacceleration = [0.0, -9.81]\n";
  const Ran rest = run(replaced(text, gravity, ""));
  EXPECT_EQ(rest.report.status, analysis::RunStatus::done) << rest.report.message;
}

// A pendulum of 1 mm finds its equilibrium as one of 1 m does: the search knows no metre.
TEST(MechanismStudies, FindTheEquilibriumOfSmallMechanisms) {
  for (const auto& [place, length] : {std::pair{"0.6e-3, 0.0, 0.8e-3", 1e-3}, std::pair{"0.6, 0.0, 0.8", 1.0}}) {
    const Ran ran = run(std::string("[[body]]\nname = \"bob\"\nshape = { kind = \"sphere\", radius = 1e-4, density = "
                                    "8000.0 }\nposition = [") +
                        place +
                        "]\n[[joint]]\nname = \"J\"\ntype = \"revolute\"\nbetween = [\"ground\", \"bob\"]\nat = [0.0, "
                        "0.0, 0.0]\naxis = [0.0, 1.0, 0.0]\n[gravity]\nacceleration = [0.0, 0.0, -9.81]\n[[analysis]]\n"
                        "name = \"rest\"\ntype = \"static\"\n");
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const auto& table = ran.sink.tables.at("rest");
    EXPECT_NEAR(table.rows[0][table.column("position", "bob.z")], -length, 1e-8 * length);
  }
}

/// A window: two uprights of 1 m and a bar across, in a plane, hinged to the ground a metre apart.
model::Mechanism window() {
  model::Mechanism m(2);
  const Index left = m.add_node("left", {0.0, 0.5, 0.5 * std::numbers::pi});
  const Index right = m.add_node("right", {1.0, 0.5, 0.5 * std::numbers::pi});
  const Index bar = m.add_node("bar", {0.5, 1.0, 0.0});
  for (const Index node : {left, right, bar}) m.add_mass(node, 1.0, 1.0 / 12.0);
  const auto pin = [&](const char* name, Index a, Index b, double x, double y) {
    m.joints.push_back(model::make_plane_revolute(name, m.plane_point(a, x, y), m.plane_point(b, x, y)));
  };
  pin("left foot", 0, left, 0.0, 0.0);
  pin("right foot", 0, right, 1.0, 0.0);
  pin("left head", left, bar, 0.0, 1.0);
  pin("right head", bar, right, 1.0, 1.0);
  return m;
}

TEST(MechanismFailures, NameTheSingularConfigurationNextToWhichTheyAre) {
  const system::Mechanism mechanism(window());
  integrate::MarchReport report;
  report.step.outcome = integrate::StepOutcome::too_small;
  system::MechanismEquations equations(mechanism);
  const auto message_at = [&](double angle) {
    system::State state = mechanism.start();
    const double c = std::cos(angle), s = std::sin(angle);
    state.q.tail<9>() << 0.5 * c, 0.5 * s, angle, 1.0 + 0.5 * c, 0.5 * s, angle, 0.5 + c, s, 0.0;
    return analysis::text_of(integrate::failure_of(report, equations, state, {}), "");
  };
  // In line the four hinges ask twice that the bars keep their distance along it: nine coordinates and eight rows, of
  // which seven say something of their own.
  const std::string in_line = message_at(1e-5);
  EXPECT_NE(in_line.find("next to a singular configuration, where \""), std::string::npos) << in_line;
  const bool has_head = in_line.find("head\" says what other joints say") != std::string::npos;
  const bool has_foot = in_line.find("foot\" says what other joints say") != std::string::npos;
  EXPECT_TRUE(has_head != has_foot) << in_line;
  EXPECT_EQ(message_at(0.1).find("singular"), std::string::npos);
}

TEST(MechanismStudies, SayWhatNothingResistsWhereThereIsNoEquilibrium) {
  const Ran ran =
      run("[[body]]\nname = \"stone\"\nmass = 2.0\ninertia = 1.0\nposition = [0.0, 0.0]\n[gravity]\n"
          "acceleration = [0.0, -10.0]\n[[analysis]]\nname = \"rest\"\ntype = \"static\"\n");
  EXPECT_EQ(ran.report.status, analysis::RunStatus::failed);
  EXPECT_NE(ran.report.message.find("20 N is left on \"stone.y\""), std::string::npos) << ran.report.message;
}

// What damped Newmark takes of the speed of a body that turns is missing for the rest of the march, and after a time t
// its place is behind by t/2 times as much: measured as a vibration of its frequency it was 14 tolerances behind after
// 60 rad.
TEST(MethodsOfFirstOrder, MeetTheirToleranceOnAMassThatTurns) {
  const auto ran = testing::run_mechanism_study(R"(
[[node]]
name = "end"
position = [1.0, 0.0]
velocity = [0.0, 10.0]
[[mass]]
node = "end"
mass = 5.0
[[joint]]
name = "rod"
type = "distance"
between = ["ground", "end"]
at = [0.0, 0.0]
[[analysis]]
name = "run"
type = "transient"
method = "damped_newmark"
step = { tolerance = 0.05 }
duration = 6.0
output = { interval = 0.1 }
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.sink.tables.at("run");
  const std::size_t x = table.column("position", "end.x"), y = table.column("position", "end.y");
  double error = 0.0;
  for (const auto& row : table.rows)
    error = std::max(error, std::hypot(row[x] - std::cos(10.0 * row[0]), row[y] - std::sin(10.0 * row[0])));
  EXPECT_LT(error / 2.0, 10.0 * 0.05);  // of the way, the diameter
}

}  // namespace
}  // namespace rubato
