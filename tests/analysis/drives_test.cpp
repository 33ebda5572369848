#include <rubato/core/error.hpp>

#include <support/mechanism_study.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

namespace rubato {
namespace {

using testing::MechanismStudy;

// A crank of 0.2 m, a rod of 0.6 m and a piston of 1.5 kg that a dashpot of 10 N s/m brakes.
const std::string slider_crank = R"(
[[body]]
name = "crank"
mass = 1.0
inertia = 0.01
position = [0.1, 0.0]
[[body]]
name = "rod"
mass = 2.0
inertia = 0.06
position = [0.5, 0.0]
[[body]]
name = "piston"
mass = 1.5
inertia = 0.002
position = [0.8, 0.0]
[[joint]]
name = "shaft"
type = "revolute"
between = ["ground", "crank"]
at = [0.0, 0.0]
drive = "20*t"
[[joint]]
name = "pin"
type = "revolute"
between = ["crank", "rod"]
at = [0.2, 0.0]
[[joint]]
name = "wrist"
type = "revolute"
between = ["rod", "piston"]
at = [0.8, 0.0]
[[joint]]
name = "cylinder"
type = "prismatic"
between = ["ground", "piston"]
at = [0.8, 0.0]
axis = [1.0, 0.0]
damping = 10.0
)";

const std::string analysis = R"(
[[analysis]]
name = "run"
type = "transient"
)";

struct Piston {
  double x, v, a;
};

/// x = r cos(theta) + sqrt(L^2 - r^2 sin^2(theta)) with theta = omega t: the closed form of the slider-crank.
Piston piston_at(double t) {
  const double r = 0.2, length = 0.6, omega = 20.0, c = std::cos(omega * t), s = std::sin(omega * t);
  const double root = std::sqrt(length * length - r * r * s * s);
  const double first = -r * r * s * c / root;  // of the root, by theta
  const double second = -(r * r * (c * c - s * s) + first * first) / root;
  return {r * c + root, omega * (-r * s + first), omega * omega * (-r * c + second)};
}

TEST(Drives, TurnACrankAsTheClosedFormSays) {
  const MechanismStudy ran(slider_crank + analysis + "step = 0.001\nduration = 0.4\nproject_velocities = true\n");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.table("run");
  double position = 0.0, velocity = 0.0, acceleration = 0.0;
  for (const auto& row : table.rows) {
    const Piston exact = piston_at(row[0]);
    position = std::max(position, std::abs(row[table.column("position", "piston.x")] - exact.x));
    velocity = std::max(velocity, std::abs(row[table.column("velocity", "piston.x")] - exact.v));
    acceleration = std::max(acceleration, std::abs(row[table.column("acceleration", "piston.x")] - exact.a));
  }
  EXPECT_EQ(table.rows.size(), 401u);
  // Newton leaves 1e-10 of 1 m. With one degree of freedom, and that driven, velocities and accelerations follow from
  // the constraints alone: what is left of positions times 20/s and (20/s)^2.
  EXPECT_LT(position, 1e-9);
  EXPECT_LT(velocity, 2e-8);
  EXPECT_LT(acceleration, 4e-7);
}

TEST(Drives, GiveTheWorkThatTheDamperTakes) {
  const MechanismStudy ran(slider_crank + analysis +
                           "step = 0.0001\nduration = 0.31415926535897931\nproject_velocities = true\n");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  // One turn: the kinetic energy is what it was. The integral of c x'^2 by the trapezoidal rule, exact for periodic
  // functions.
  double dissipated = 0.0;
  constexpr int points = 64;
  const double period = 0.31415926535897931;
  for (int i = 0; i < points; ++i) dissipated += 10.0 * std::pow(piston_at(period * i / points).v, 2) * period / points;
  // Works over steps are of second order: (20/s 1e-4 s)^2/12 of 25 J.
  EXPECT_NEAR(ran.last("run.energy", "drive_work"), dissipated, 1e-5 * dissipated);
  EXPECT_NEAR(ran.last("run.energy", "damper_dissipated"), dissipated, 1e-5 * dissipated);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-5 * dissipated);
}

// A bar of 2 kg, its centre 0.5 m from the pin: J = 0.1 + 2*0.25 = 0.6 kg m2.
const std::string bar = R"(
[[body]]
name = "bar"
mass = 2.0
inertia = 0.1
position = [0.5, 0.0]
[[joint]]
name = "motor"
type = "revolute"
between = ["ground", "bar"]
at = [0.0, 0.0]
drive = DRIVE
)";

std::string driven_bar(const std::string& drive) {
  std::string text = bar;
  return text.replace(text.find("DRIVE"), 5, drive);
}

TEST(Drives, NeedTheTorqueOfTheAccelerationThatTheyPrescribe) {
  const MechanismStudy ran(driven_bar("\"0.5*sin(3*t)\"") + analysis + "step = 0.01\nduration = 1.0\n");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const auto& table = ran.table("run");
  for (const auto& row : table.rows)
    EXPECT_NEAR(row[table.column("drive_moment", "motor")], -0.6 * 4.5 * std::sin(3.0 * row[0]), 1e-9);
  // The velocity given was zero, and the drive starts at 1.5 rad/s.
  ASSERT_EQ(ran.report.warnings.size(), 1u);
  EXPECT_NE(ran.report.warnings[0].find("velocities given"), std::string::npos);
  EXPECT_NE(ran.report.warnings[0].find("gave 0.675 J"), std::string::npos) << ran.report.warnings[0];
}

TEST(Drives, BookTheImpulseWhereATableHasAKink) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "drive_kinks.csv";
  std::ofstream(file) << "0, 0\n0.5, 1\n1.0, 1\n2.0, 5\n";
  const MechanismStudy ran(driven_bar("{ table = \"" + file.string() + "\" }") + analysis +
                           "step = { tolerance = 1e-4 }\nduration = 1.5\n");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  EXPECT_NEAR(ran.last("run", "angle", "motor"), 3.0, 1e-9);
  // 2 rad/s, then none, then 4 rad/s: the drive takes 1.2 J and gives 4.8 J. The start is consistent with 2 rad/s.
  EXPECT_NEAR(ran.last("run.energy", "drive_work"), 3.6, 1e-8);
  EXPECT_NEAR(ran.last("run.energy", "kinetic"), 4.8, 1e-8);
  EXPECT_NEAR(ran.last("run.energy", "lock_dissipated"), 0.0, 1e-8);
  EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-8);
}

std::string verdict(const std::string& text) {
  try {
    const MechanismStudy ran(text + analysis + "step = 0.01\nduration = 0.1\n");
    return ran.report.status == analysis::RunStatus::done ? "no complaint" : ran.report.message;
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
}

TEST(DriveFault, NamesDrivesThatContradictEachOther) {
  std::string text = slider_crank;
  const std::string damping = "damping = 10.0\n";
  text.replace(text.find(damping), damping.size(), "drive = \"0.3*t\"\n");
  const std::string said = verdict(text);
  EXPECT_NE(said.find("drives contradict each other or the joints"), std::string::npos) << said;
  EXPECT_NE(said.find("leave one of the drives of \"shaft\", \"cylinder\" out"), std::string::npos) << said;
}

TEST(DriveFault, NamesTheKeyAndTheRemedy) {
  EXPECT_NE(verdict(driven_bar("\"3*speed\"")).find("joint \"motor\": drive: in the expression \"3*speed\": unknown"),
            std::string::npos);
  EXPECT_NE(verdict(driven_bar("\"90 + 5*t\"")).find("if degrees are meant"), std::string::npos);
  EXPECT_NE(verdict(driven_bar("\"sqrt(t)\"")).find("no finite value, rate and second rate at t = 0"),
            std::string::npos);
  EXPECT_NE(verdict(driven_bar("\"t\"\nlock = { at = 1.0, kind = \"stop\" }")).find("has a drive and a lock"),
            std::string::npos);
  std::string rigid = driven_bar("\"t\"");
  rigid.replace(rigid.find("revolute"), 8, "rigid");
  EXPECT_NE(
      verdict(rigid).find("\"drive\" belongs to a revolute, prismatic, screw or strut joint, and this one is rigid"),
      std::string::npos)
      << verdict(rigid);
}

TEST(DriveFault, RefusesATableThatJumpsOrEnds) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "drive_jump.csv";
  std::ofstream(file) << "0, 0\n0.5, 1\n0.5, 2\n2.0, 5\n";
  const std::string said = verdict(driven_bar("{ table = \"" + file.string() + "\" }"));
  EXPECT_NE(said.find("jumps at t = 0.5 s"), std::string::npos) << said;
  std::ofstream(file) << "0, 0\n0.05, 1\n";
  EXPECT_NE(
      verdict(driven_bar("{ table = \"" + file.string() + "\" }")).find("extend it, or say beyond = \"hold\" where"),
      std::string::npos);
  EXPECT_EQ(verdict(driven_bar("{ table = \"" + file.string() + "\", beyond = \"hold\" }")), "no complaint");
}

}  // namespace
}  // namespace rubato
