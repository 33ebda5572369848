#include <support/laid_studies.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

// A block of 2 kg on a table, on a foot 0.05 m below its centre: friction mu N against the slip of the foot, 0.4 N.
namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::MechanismStudy;
using testing::replaced;
using testing::transient;
using testing::verdict;

constexpr double mass = 2.0, gravity = 10.0, coefficient = 0.4, limit = coefficient * mass * gravity;
const std::string steps[] = {"0.01", "{ tolerance = 1e-5 }", "{ tolerance = 1e-5, controller = \"cardona_cassano\" }"};

std::string triple(double x, double y, double z) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", x, y, z); }

struct Block {
  double vx = 0.0, vy = 0.0, spin = 0.0;
  std::string on = "ground";
  std::string load = "normal_load = \"reaction\"";
  double foot_x = 0.0;  // beside the centre
  double slope = 0.0;   // of the table, which falls along x
  double x = 0.0;       // of the centre
  double vz = 0.0;

  std::string text() const {
    const double c = std::cos(slope), s = std::sin(slope);
    return "[[body]]\nname = \"block\"\nmass = 2.0\ninertia = [0.01, 0.02, 0.03]\nposition = " + triple(x, 0.0, 0.0) +
           "\nvelocity = " + triple(vx, vy, vz) + "\nangular_velocity = " + triple(0.0, 0.0, spin) +
           "\n[[joint]]\nname = \"table\"\ntype = \"planar\"\nbetween = [\"" + on +
           "\", \"block\"]\nat = " + triple(x + foot_x - 0.05 * s, 0.0, -0.05 * c) + "\naxis = " + triple(s, 0.0, c) +
           "\nfriction = { coefficient = 0.4, " + load + " }\n[gravity]\nacceleration = [0.0, 0.0, -10.0]\n";
  }
};

std::string force(const std::string& coordinate, const std::string& law) {
  return "[[force]]\non = \"block." + coordinate + "\"\nexpression = \"" + law + "\"\n";
}

// Deceleration mu g along the line of the throw. Steps are exact, and what is left is Newton's tolerance, 1e-10 of the
// size, and the resolution of events, 1e-12 of the run. The foot is below the centre: the block turns on.
TEST(PlanarFriction, StopsAThrownBlockInAStraightLineWhateverItsDirection) {
  for (const double way : {0.0, 0.7, 2.5, -1.9})
    for (const double spin : {0.0, 3.0})
      for (const std::string& step : steps) {
        const double speed = 1.1, x = std::cos(way), y = std::sin(way), stop = speed / (coefficient * gravity);
        const MechanismStudy ran(Block{.vx = speed * x, .vy = speed * y, .spin = spin}.text() + transient(step, 0.5));
        ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
        ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
        EXPECT_NEAR(ran.at(0, "run.events", "time"), stop, 1e-8);
        EXPECT_NEAR(ran.last("run", "position", "block.x"), 0.5 * speed * stop * x, 1e-9);
        EXPECT_NEAR(ran.last("run", "position", "block.y"), 0.5 * speed * stop * y, 1e-9);
        EXPECT_NEAR(ran.last("run", "angular_velocity", "block.rz"), spin, 1e-8);
        EXPECT_NEAR(ran.at(5, "run", "friction_force_x", "table"), -limit * x, 1e-7);
        EXPECT_NEAR(ran.at(5, "run", "friction_force_y", "table"), -limit * y, 1e-7);
        EXPECT_NEAR(ran.last("run", "friction_force_x", "table"), 0.0, 1e-7);
        EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 0.5 * mass * speed * speed, 1e-8);
        EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-8);
      }
}

// What a step leaves of the slip as it ends where the block stops is round-off of any direction, most of all where the
// block turns. The shortest step is 1e-6 of the step.
TEST(PlanarFriction, RestsWhereAStepEndsAsItStops) {
  for (const double way : {0.0, 0.7, 2.5, -1.9}) {
    const MechanismStudy ran(Block{.vx = std::cos(way), .vy = std::sin(way), .spin = 3.0}.text() +
                             transient("0.01", 0.5));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
    EXPECT_NEAR(ran.at(0, "run.events", "time"), 1.0 / (coefficient * gravity), 1e-7);
    EXPECT_LT(ran.table("run").rows.size(), 60u);
  }
}

// The foot follows the load: N = m g + 10 t.
TEST(PlanarFriction, FollowsTheForceAcrossThePlane) {
  for (const std::string& step : steps) {
    const MechanismStudy ran(Block{.vy = 1.0}.text() + force("z", "-10*t") + transient(step, 0.2));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double taken = coefficient * (gravity * 0.2 + 0.5 * 10.0 / mass * 0.2 * 0.2);
    EXPECT_NEAR(ran.last("run", "velocity", "block.y"), 1.0 - taken, 1e-5);
    EXPECT_NEAR(ran.last("run", "friction_force_y", "table"), -coefficient * (20.0 + 2.0), 1e-6);
  }
}

// tan(slope) = mu is the limit; beyond, the block goes downhill with g (sin - mu cos).
TEST(PlanarFriction, HoldsOnASlopeBelowTheAngleOfFrictionAndLetsGoBeyond) {
  for (const std::string& step : steps) {
    const double below = std::atan(0.99 * coefficient), beyond = std::atan(1.01 * coefficient);
    const MechanismStudy stays(Block{.slope = below}.text() + transient(step, 1.0));
    ASSERT_EQ(stays.report.status, analysis::RunStatus::done) << stays.report.message;
    EXPECT_NEAR(stays.last("run", "position", "block.x"), 0.0, 1e-12);
    const double held = mass * gravity * std::sin(below);
    EXPECT_NEAR(stays.last("run", "friction_force_x", "table"), -held * std::cos(below), 1e-9);
    EXPECT_NEAR(stays.last("run", "friction_force_y", "table"), 0.0, 1e-9);
    EXPECT_NEAR(stays.last("run", "friction_force_z", "table"), held * std::sin(below), 1e-9);
    const MechanismStudy goes(Block{.slope = beyond}.text() + transient(step, 1.0));
    ASSERT_EQ(goes.report.status, analysis::RunStatus::done) << goes.report.message;
    const double rate = gravity * (std::sin(beyond) - coefficient * std::cos(beyond));
    EXPECT_NEAR(goes.last("run", "position", "block.x"), 0.5 * rate * std::cos(beyond), 1e-8);
    EXPECT_NEAR(goes.last("run", "position", "block.z"), -0.5 * rate * std::sin(beyond), 1e-8);
    EXPECT_NEAR(goes.last("run", "position", "block.y"), 0.0, 1e-10);
  }
}

// Thrown across a slope at the angle of friction: |v| grows as the speed downhill falls, and |v| + v.downhill stays.
// The slip turns by a right angle; the methods are of second order.
TEST(PlanarFriction, TurnsABlockThrownAcrossASlopeDownhillAtHalfItsSpeed) {
  const double slope = std::atan(coefficient);
  for (const std::string& step : steps) {
    const MechanismStudy ran(Block{.vy = 1.0, .slope = slope}.text() + transient(step, 2.0));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    for (std::size_t row = 0; row < ran.table("run").rows.size(); row += 10) {
      const double x = ran.at(row, "run", "velocity", "block.x"), y = ran.at(row, "run", "velocity", "block.y");
      const double z = ran.at(row, "run", "velocity", "block.z");
      const double downhill = x * std::cos(slope) - z * std::sin(slope);
      ASSERT_NEAR(std::hypot(downhill, y) + downhill, 1.0, 5e-4) << row;
    }
    EXPECT_NEAR(ran.last("run", "velocity", "block.x"), 0.5 * std::cos(slope), 2e-3);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-4);
  }
}

// A load 30 t that turns with 5 rad/s is held up to 8 N, in whatever direction it then is.
TEST(PlanarFriction, HoldsALoadThatTurnsUpToTheLimitInAnyDirection) {
  for (const std::string& step : steps) {
    const MechanismStudy ran(Block{}.text() + force("x", "30*t*cos(5*t)") + force("y", "30*t*sin(5*t)") +
                             transient(step, 0.5));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
    EXPECT_NEAR(ran.at(0, "run.events", "time"), limit / 30.0, 1e-8);
    const double t = ran.at(10, "run", "time");
    ASSERT_LT(t, limit / 30.0);
    EXPECT_NEAR(ran.at(10, "run", "friction_force_x", "table"), -30.0 * t * std::cos(5.0 * t), 1e-8);
    EXPECT_NEAR(ran.at(10, "run", "friction_force_y", "table"), -30.0 * t * std::sin(5.0 * t), 1e-8);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-5);
  }
}

// On a circle the load is mu N along the way and m v w across it; v = 0.5 m/s, w = 4 rad/s.
TEST(PlanarFriction, GoesInACircleUnderALoadThatTurns) {
  const double v = 0.5, w = 4.0;
  for (const std::string& step : {std::string("0.002"), steps[1], steps[2]}) {
    const std::string along = fmt::format("{:.17g}", limit), across = fmt::format("{:.17g}", mass * v * w);
    const MechanismStudy ran(Block{.vx = v}.text() + force("x", along + "*cos(4*t) - " + across + "*sin(4*t)") +
                             force("y", along + "*sin(4*t) + " + across + "*cos(4*t)") + transient(step, 2.0));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_NEAR(ran.last("run", "velocity", "block.x"), v * std::cos(w * 2.0), 1e-4);
    EXPECT_NEAR(ran.last("run", "velocity", "block.y"), v * std::sin(w * 2.0), 1e-4);
    EXPECT_NEAR(ran.last("run", "friction_force_x", "table"), -limit * std::cos(w * 2.0), 2e-3);
    EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), limit * v * 2.0, 1e-3);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-3);
  }
}

std::string moving_table(const std::string& joint, const std::string& velocity) {
  return "[[body]]\nname = \"plate\"\nmass = 5.0\ninertia = [1.0, 1.0, 1.0]\nposition = [0.0, 0.0, 0.0]\n" + velocity +
         "[[joint]]\nname = \"motor\"\nbetween = [\"ground\", \"plate\"]\nat = [0.0, 0.0, 0.0]\n" + joint + "\n";
}

// Seen from a belt that runs with 0.3 m/s along x the block comes with (-0.3, 0.4) and stops after 0.125 s.
TEST(PlanarFriction, TakesABlockAlongOnABelt) {
  const std::string belt =
      moving_table("type = \"prismatic\"\naxis = [1.0, 0.0, 0.0]\ndrive = \"0.3*t\"\n", "velocity = [0.3, 0.0, 0.0]\n");
  for (const std::string& step : steps) {
    const MechanismStudy ran(Block{.vy = 0.4, .on = "plate"}.text() + belt + transient(step, 0.5));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double stop = 0.5 / (coefficient * gravity);
    ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
    EXPECT_NEAR(ran.at(0, "run.events", "time"), stop, 1e-8);
    EXPECT_NEAR(ran.last("run", "velocity", "block.x"), 0.3, 1e-9);
    EXPECT_NEAR(ran.last("run", "position", "block.x"), 0.3 * 0.5 - 0.5 * 0.3 * stop, 1e-8);
    EXPECT_NEAR(ran.last("run", "position", "block.y"), 0.5 * 0.4 * stop, 1e-8);
    EXPECT_NEAR(ran.last("run.energy", "drive_work"), limit * 0.6 * 0.3 * stop, 1e-7);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-7);
  }
}

// A table that turns by t^2/2 takes the block along on a circle of 0.3 m, and turns it not: the foot is small. It lets
// go where 0.3 m sqrt(1 + t^4) is mu g. Chords of a circle are short by the square of the step.
TEST(PlanarFriction, TakesABlockAlongOnATurntableUntilItFliesOff) {
  const std::string turntable = moving_table("type = \"revolute\"\naxis = [0.0, 0.0, 1.0]\ndrive = \"0.5*t^2\"\n", "");
  const double off = std::pow(std::pow(coefficient * gravity / 0.3, 2) - 1.0, 0.25);
  for (const std::string& step : steps) {
    const MechanismStudy ran(Block{.on = "plate", .x = 0.3}.text() + turntable + transient(step, off + 0.2));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
    EXPECT_NEAR(ran.at(0, "run.events", "time"), off, 1e-3);
    const auto& rows = ran.table("run").rows;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const double x = ran.at(row, "run", "position", "block.x"), y = ran.at(row, "run", "position", "block.y");
      const double t = ran.at(row, "run", "time"), spin = t;
      if (t < off - 0.01) {
        ASSERT_NEAR(std::remainder(std::atan2(y, x) - 0.5 * t * t, 2.0 * M_PI), 0.0, 1e-6) << t;
        ASSERT_NEAR(std::hypot(x, y), 0.3, 1e-9);
      }
      if (t < off + 0.05) continue;
      const double u = ran.at(row, "run", "velocity", "block.x") + spin * y;
      const double v = ran.at(row, "run", "velocity", "block.y") - spin * x;
      ASSERT_NEAR(ran.at(row, "run", "friction_force_x", "table"), -limit * u / std::hypot(u, v), 1e-3) << t;
      ASSERT_NEAR(ran.at(row, "run", "friction_force_y", "table"), -limit * v / std::hypot(u, v), 1e-3) << t;
    }
    EXPECT_NEAR(ran.last("run", "angular_velocity", "block.rz"), 0.0, 1e-9);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-3);
  }
}

// A table that tilts about the centre of the block lets it go at the angle of friction.
TEST(PlanarFriction, LetsGoOfABlockOnATableThatTilts) {
  const std::string tilting = moving_table("type = \"revolute\"\naxis = [0.0, 1.0, 0.0]\ndrive = \"0.05*t^2\"\n", "");
  const double at = std::sqrt(std::atan(coefficient) / 0.05);
  for (const std::string& step : steps) {
    const MechanismStudy ran(Block{.on = "plate"}.text() + tilting + transient(step, at + 0.1));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    ASSERT_EQ(ran.table("run.events").rows.size(), 1u);
    EXPECT_NEAR(ran.at(0, "run.events", "time"), at, 1e-6);
    const double t = ran.at(20, "run", "time"), tilt = 0.05 * t * t, held = mass * gravity * std::sin(tilt);
    ASSERT_LT(t, at);
    EXPECT_NEAR(ran.at(20, "run", "friction_force_x", "table"), -held * std::cos(tilt), 1e-6);
    EXPECT_NEAR(ran.at(20, "run", "friction_force_z", "table"), held * std::sin(tilt), 1e-6);
    EXPECT_GT(ran.last("run", "position", "block.x"), 1e-5);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-5);
  }
}

// A foot 0.1 m beside the centre is a pivot while m w^2 0.1 m is below the limit, up to 6.32 rad/s. The spin is kept to
// the square of the step.
TEST(PlanarFriction, OfAFootBesideTheCentreIsAPivotOfTheSpin) {
  for (const std::string& step : {std::string("0.002"), steps[1], steps[2]}) {
    const MechanismStudy turns(Block{.vy = -0.6, .spin = 6.0, .foot_x = 0.1}.text() + transient(step, 1.0));
    ASSERT_EQ(turns.report.status, analysis::RunStatus::done) << turns.report.message;
    EXPECT_EQ(turns.table("run.events").rows.size(), 0u);
    const double x = turns.last("run", "position", "block.x"), y = turns.last("run", "position", "block.y");
    EXPECT_NEAR(std::hypot(x - 0.1, y), 0.1, 1e-9);
    EXPECT_NEAR(turns.last("run", "angular_velocity", "block.rz"), 6.0, 1e-4);
    EXPECT_NEAR(
        std::hypot(turns.last("run", "friction_force_x", "table"), turns.last("run", "friction_force_y", "table")),
        mass * 36.0 * 0.1, 5e-4);
    const MechanismStudy slips(Block{.vy = -0.65, .spin = 6.5, .foot_x = 0.1}.text() + transient(step, 0.05));
    ASSERT_EQ(slips.report.status, analysis::RunStatus::done) << slips.report.message;
    EXPECT_GT(std::hypot(slips.last("run", "position", "block.x") - 0.1, slips.last("run", "position", "block.y")),
              0.1 + 1e-5);
  }
}

TEST(PlanarFrictionFault, TakesNoRadius) {
  EXPECT_THAT(
      verdict(
          replaced(Block{}.text() + transient("0.01", 1.0), "coefficient = 0.4", "coefficient = 0.4, radius = 0.1")),
      HasSubstr("joint \"table\": friction: radius belongs to a revolute, cylindrical, universal or screw joint"));
}

}  // namespace
}  // namespace rubato
