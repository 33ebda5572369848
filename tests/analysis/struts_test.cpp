#include <rubato/core/error.hpp>

#include <support/mechanism_study.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

// Springs, dampers and forces along the line between two points, and laws of joints that are tables.
namespace rubato {
namespace {

using ::testing::HasSubstr;
using testing::MechanismStudy;
using testing::replaced;

/// A mass of 2 kg that leaves along the line to the point that holds it, 5 m away, at 3 m/s.
std::string radial_mass(bool in_space, const std::string& keys) {
  const std::string z = in_space ? ", 0.0" : "";
  return "[[node]]\nname = \"m\"\nposition = [3.0, 4.0" + z + "]\nvelocity = [1.8, 2.4" + z +
         "]\n[[mass]]\nnode = \"m\"\nmass = 2.0\n[[joint]]\nname = \"strut\"\ntype = \"strut\"\nbetween = [\"ground\", "
         "\"m\"]\nat = [0.0, 0.0" +
         z + "]\n" + keys +
         "\n[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = { tolerance = 1e-6 }\nduration = 1.0\n";
}

// Its length is 5 + 3/omega sin(omega t), omega = sqrt(72/2) = 6 rad/s.
TEST(Strut, SwingsAMassAlongItsLine) {
  for (const bool in_space : {false, true}) {
    const MechanismStudy ran(radial_mass(in_space, "stiffness = 72.0"));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    const double length = 5.0 + 0.5 * std::sin(6.0);
    EXPECT_NEAR(ran.at(0, "run", "displacement", "strut"), 5.0, 1e-14);
    EXPECT_NEAR(ran.last("run", "displacement", "strut"), length, 1e-5);
    EXPECT_NEAR(ran.last("run", "law_force", "strut"), -72.0 * (ran.last("run", "displacement", "strut") - 5.0), 1e-9);
    EXPECT_NEAR(ran.last("run", "position", "m.x"), 0.6 * length, 1e-5);
    EXPECT_NEAR(ran.last("run", "position", "m.y"), 0.8 * length, 1e-5);
    EXPECT_NEAR(ran.last("run.energy", "residue"), 0.0, 1e-4);
  }
}

// With c = 12 N s/m beside it, zeta = 0.5; and as a formula of the length and its rate.
TEST(Strut, IsDampedAsItsFormulaSays) {
  const double omega = 6.0 * std::sqrt(0.75), length = 5.0 + 3.0 / omega * std::exp(-3.0) * std::sin(omega);
  for (const std::string keys :
       {"stiffness = 72.0\ndamping = 12.0", "stiffness = 36.0\nforce = \"-36*(length - 5) - 12*rate\"",
        "force = \"-72*(length - 5) - 12*rate\""})
    for (const bool in_space : {false, true}) {
      const MechanismStudy ran(radial_mass(in_space, keys));
      ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
      EXPECT_NEAR(ran.last("run", "displacement", "strut"), length, 1e-5) << keys;
    }
}

// Dry friction of 9 N stops 2 kg after 3^2*2/(2*9) = 1 m, in 2/3 s.
TEST(Strut, RubsWithItsPreload) {
  for (const bool in_space : {false, true}) {
    const MechanismStudy ran(radial_mass(in_space, "friction = { coefficient = 0.3, preload = 30.0 }"));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_NEAR(ran.at(0, "run.events", "time"), 2.0 / 3.0, 1e-6);
    EXPECT_NEAR(ran.last("run", "displacement", "strut"), 6.0, 1e-6);
    EXPECT_NEAR(ran.last("run.energy", "friction_dissipated"), 9.0, 1e-5);
  }
}

// A rope that becomes taut at 5.6 m: a latch that holds for good takes the whole of 9 J.
TEST(Strut, BecomesTautAtItsLock) {
  for (const bool in_space : {false, true}) {
    const MechanismStudy ran(radial_mass(in_space, "lock = { at = 5.6, kind = \"latch\" }"));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    EXPECT_NEAR(ran.at(0, "run.events", "time"), 0.2, 1e-9);
    EXPECT_NEAR(ran.at(0, "run.events", "energy_lost"), 9.0, 1e-9);
    EXPECT_NEAR(ran.last("run", "displacement", "strut"), 5.6, 1e-9);
  }
}

// A strut that is driven lifts a lever: the law of cosines with arms of 1 m and 1 m, from a right angle.
TEST(Strut, DrivesALever) {
  const MechanismStudy ran(R"(
[[body]]
name = "lever"
mass = 1.0
inertia = 0.1
position = [1.0, 0.0]
[[joint]]
name = "pin"
type = "revolute"
between = ["ground", "lever"]
at = [0.0, 0.0]
[[joint]]
name = "jack"
type = "strut"
between = ["ground", "lever"]
at = [0.0, -1.0]
to = [1.0, 0.0]
drive = "sqrt(2) + 0.2*t"
[gravity]
acceleration = [0.0, -9.81]
[[analysis]]
name = "run"
type = "transient"
step = 0.01
duration = 1.0
)");
  ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
  const double length = std::numbers::sqrt2 + 0.2;
  const double angle = std::acos(1.0 - 0.5 * length * length) - 0.5 * std::numbers::pi;
  EXPECT_NEAR(ran.last("run", "angle", "pin"), angle, 1e-9);
}

/// A file that lasts as long as the test.
class TableFile {
 public:
  TableFile(const std::string& name, const std::string& text) : path_(std::filesystem::temp_directory_path() / name) {
    std::ofstream(path_) << text;
  }
  ~TableFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

// The same spring as a table; from 5.2 m on it is twice as stiff. Energy holds: m v^2/2 = 72 0.2^2/2 + ... at the turn.
TEST(TabulatedLaws, PushAsTheirRowsSay) {
  const TableFile file("rubato_struts_test_table.csv", "length [m],force [N]\n4,72\n5,0\n5.2,-14.4\n6.2,-158.4\n");
  const std::string law = "force = { table = \"" + file.path() + "\" }";
  for (const bool in_space : {false, true}) {
    const MechanismStudy ran(radial_mass(in_space, law));
    ASSERT_EQ(ran.report.status, analysis::RunStatus::done) << ran.report.message;
    // 9 = 36*0.04 + 14.4 x + 72 x^2 at the turn, x beyond 5.2 m.
    const double turn = 5.2 + (-14.4 + std::sqrt(14.4 * 14.4 + 4.0 * 72.0 * (9.0 - 36.0 * 0.04))) / 144.0;
    double longest = 0.0;
    for (std::size_t row = 0; row < ran.table("run").rows.size(); ++row) {
      longest = std::max(longest, ran.at(row, "run", "displacement", "strut"));
      EXPECT_NEAR(ran.at(row, "run.energy", "kinetic") + ran.at(row, "run.energy", "strain"), 9.0, 1e-3);
    }
    EXPECT_NEAR(longest, turn, 2e-4);
  }
}

std::string verdict(const std::string& text) {
  try {
    const MechanismStudy ran(text);
    return ran.report.message;
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
}

TEST(TabulatedLaws, EndTheRunWhereTheyEnd) {
  const TableFile file("rubato_struts_test_short.csv", "length [m],force [N]\n4,72\n5.1,0\n");
  const std::string law = "force = { table = \"" + file.path() + "\"";
  EXPECT_THAT(verdict(radial_mass(false, law + " }")),
              HasSubstr("the law of \"strut\", whose table reaches from 4 to 5.1"));
  EXPECT_EQ(verdict(radial_mass(false, law + ", beyond = \"hold\" }")), "");
  EXPECT_EQ(verdict(radial_mass(false, law + ", beyond = \"zero\" }")), "");
}

// At rest on the last row and pushed outwards, no step that moves it has a force, and those that do not move it are no
// longer than round-off: the run ends.
TEST(TabulatedLaws, EndARunThatCannotLeaveTheLastRow) {
  const TableFile file("rubato_struts_test_edge.csv", "length [m],force [N]\n4,72\n5,1\n");
  std::string text = radial_mass(false, "force = { table = \"" + file.path() + "\" }");
  text = replaced(text, "velocity = [1.8, 2.4]", "velocity = [0.0, 0.0]");
  const MechanismStudy ran(text);
  EXPECT_EQ(ran.report.status, analysis::RunStatus::failed);
  EXPECT_LT(ran.table("run").rows.size(), 100000u);
}

// Rows that end where a lock is say all that is needed.
TEST(TabulatedLaws, EndAtALock) {
  const TableFile file("rubato_struts_test_lock.csv", "length [m],force [N]\n4,72\n5,0\n5.2,-14.4\n");
  const std::string law = "force = { table = \"" + file.path() + "\" }\nlock = { at = 5.2, ";
  for (const std::string lock : {"kind = \"stop\" }", "kind = \"latch\" }", "kind = \"stop\", stiffness = 1e4 }"}) {
    const MechanismStudy ran(radial_mass(false, law + lock));
    EXPECT_EQ(ran.report.status, analysis::RunStatus::done) << lock << ran.report.message;
    EXPECT_NEAR(ran.at(0, "run.events", "time"), std::asin(0.4) / 6.0, 1e-6) << lock;
  }
}

TEST(TabulatedLaws, PointAtTheirFaults) {
  const auto says = [](const std::string& rows, const std::string& expected) {
    const TableFile file("rubato_struts_test_fault.csv", rows);
    EXPECT_THAT(verdict(radial_mass(false, "force = { table = \"" + file.path() + "\" }")), HasSubstr(expected));
  };
  says("time [s],force [N]\n4,72\n5,0\n", "the length is in [s], and it is read in [m]");
  says("4,72\n3,0\n", "lengths must not fall: 3 after 4");
  says("4,72\n5,0\n5,1\n6,2\n", "jumps at 5");
}

TEST(StrutFault, NamesTheKeyAndTheRemedy) {
  const auto says = [](const std::string& keys, const std::string& expected) {
    EXPECT_THAT(verdict(radial_mass(false, keys)), HasSubstr(expected));
  };
  says("displacement = 2.0", "\"displacement\" belongs to a prismatic joint, and this one is strut");
  says("axis = [1.0, 0.0]", "\"axis\" belongs to a");
  says("friction = { coefficient = 0.3, normal_load = \"reaction\" }", "no reaction presses on what slides");
  says("lock = { at = 0.0, kind = \"stop\" }", "lock: at is a length and must be positive, got 0");
  says("stiffness = 1.0\nrest = -1.0", "rest must not be negative, got -1");
  says("stiffness = -1.0", "joint \"strut\": stiffness must not be negative");
  says("force = \"2*displacement\"", "joint \"strut\": force: in the expression");
  EXPECT_THAT(verdict(replaced(radial_mass(false, "stiffness = 1.0"), "at = [0.0, 0.0]", "at = [3.0, 4.0]")),
              HasSubstr("has no length: its ends lie in the same place"));
}

}  // namespace
}  // namespace rubato
