#include <rubato/core/error.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/model/build_mechanism.hpp>
#include <rubato/system/mechanism.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace rubato {
namespace {

const std::string crank = R"(
[[body]]
name = "crank"
mass = 2.0
inertia = 0.2
position = [0.5, 0.0]

[[body]]
name = "rod"
mass = 3.0
inertia = 0.4
position = [1.5, 0.0]

[[joint]]
name = "A"
type = "revolute"
between = ["ground", "crank"]
at = [0.0, 0.0]
angle = 0.3
moment = "5 - 2*rate"
lock = { at = "pi/2", kind = "latch" }

[[joint]]
name = "B"
type = "revolute"
between = ["crank", "rod"]
at = [1.0, 0.0]

[[joint]]
name = "C"
type = "prismatic"
between = ["ground", "rod"]
at = [0.0, 0.0]
to = [2.0, 0.0]
axis = [1.0, 0.0]
stiffness = 7.0

[[force]]
on = "rod.x"
expression = "t"
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

/// The study with one piece of it replaced.
std::string verdict_with(const std::string& piece, const std::string& other) {
  std::string text = crank;
  const std::size_t at = text.find(piece);
  EXPECT_NE(at, std::string::npos);
  return verdict(text.replace(at, piece.size(), other));
}

TEST(ReadMechanism, MakesBodiesJointsLawsAndLocks) {
  const system::Mechanism mechanism = built(crank);
  EXPECT_EQ(mechanism.coordinates(),
            (std::vector<std::string>{"crank.x", "crank.y", "crank.rz", "rod.x", "rod.y", "rod.rz"}));
  EXPECT_EQ(mechanism.rows(),
            (std::vector<std::string>{"A.x", "A.y", "A.lock_moment", "B.x", "B.y", "C.normal", "C.moment"}));
  const auto& model = mechanism.model();
  ASSERT_EQ(model.joint_coordinates.size(), 3u);
  EXPECT_DOUBLE_EQ(model.joint_coordinates[0].s.value(mechanism.start().q.data()), 0.3);
  EXPECT_DOUBLE_EQ(model.joint_coordinates[2].s.value(mechanism.start().q.data()), 0.0);
  ASSERT_EQ(model.locks.size(), 1u);
  EXPECT_TRUE(model.locks[0].is_latch && model.locks[0].is_rigid());
  EXPECT_EQ(model.locks[0].sign, 1.0);
  EXPECT_EQ(model.elements.size(), 2u);  // the drive and the spring
  EXPECT_DOUBLE_EQ(mechanism.mass().coeff(5, 5), 0.4);
}

TEST(ReadMechanism, TakesBeamsAndPointMassesOfTheStructure) {
  const system::Mechanism mechanism = built(R"(
[[node]]
name = "foot"
position = [0.0, 0.0]
[[node]]
name = "tip"
position = [2.0, 0.0]
[[material]]
name = "steel"
young = 2e11
poisson = 0.25
density = 8000.0
[[section]]
name = "bar"
area = 1e-3
inertia = 1e-7
shear_factor = 0.8
[[beam]]
nodes = ["foot", "tip"]
section = "bar"
material = "steel"
formulation = "geometrically_exact"
elements = 2
[[mass]]
node = "tip"
mass = 5.0
[[support]]
node = "foot"
fix = ["x", "y", "rz"]
[gravity]
acceleration = [0.0, -10.0]
)");
  EXPECT_EQ(mechanism.size(), 6);
  // Elements of 1 m and 8 kg: two thirds of one at the inner node twice, once at the tip.
  const Index inner = 3, tip = 0;
  EXPECT_EQ(mechanism.coordinates()[0], "tip.x");
  EXPECT_DOUBLE_EQ(mechanism.mass().coeff(inner, inner), 2.0 * 8.0 / 3.0);
  EXPECT_DOUBLE_EQ(mechanism.mass().coeff(tip, tip), 5.0 + 8.0 / 3.0);
  EXPECT_NEAR(mechanism.weight()[inner + 1], -80.0, 1e-12);  // half of either element, the fixed node's share included
  EXPECT_NEAR(mechanism.weight()[tip + 1], -90.0, 1e-12);
}

TEST(ReadMechanism, NamesWhatIsWrongAndWhere) {
  EXPECT_EQ(
      verdict_with("\"crank\", \"rod\"]", "\"crnk\", \"rod\"]"),
      "study.toml:26:12: error: joint \"B\" joins \"crnk\", which is no node and no body; did you mean \"crank\"? "
      "(known: ground, crank, rod)");
  EXPECT_EQ(
      verdict_with("inertia = 0.2", "inertia = 0.0"),
      "study.toml:5:11: error: body \"crank\": inertia must be positive, got 0: its rotation is free; a mass that "
      "does not turn is a [[node]] with a [[mass]]");
  EXPECT_EQ(
      verdict_with("angle = 0.3", "angle = 30.0"),
      "study.toml:19:9: error: joint \"A\": angle is 30 rad, more than a turn; if degrees are meant, write \"30 * "
      "pi/180\", if turns, \"9.5493 * pi\"");
  EXPECT_EQ(verdict_with("at = \"pi/2\"", "at = 180"),
            "study.toml:21:15: error: joint \"A\": lock: at is 180 rad, more than a turn; if degrees are meant, write "
            "\"180 * pi/180\", if turns, \"57.2958 * pi\"");
  EXPECT_EQ(
      verdict_with("at = \"pi/2\"", "at = 0.3"),
      "study.toml:21:8: error: joint \"A\": lock: the joint starts at its lock, 0.3; say which values are free, side = "
      "\"below\" or \"above\", or let it start at another angle");
  EXPECT_EQ(verdict_with("axis = [1.0, 0.0]", "axis = [0.0, 0.0]"),
            "study.toml:35:8: error: joint \"C\": the axis [0, 0] has no length");
  EXPECT_EQ(verdict_with("5 - 2*rate", "5 - 2*displacement").substr(0, 44),
            "study.toml:20:10: error: joint \"A\": moment: ");
  EXPECT_EQ(verdict_with("on = \"rod.x\"", "on = \"rod.z\"").substr(0, 62),
            "study.toml:39:6: error: a force is on \"rod.z\", which is no coo");
  EXPECT_EQ(verdict_with("axis = [1.0, 0.0]\n", ""), "study.toml:29:1: error: joint \"C\" lacks the key \"axis\"");
  EXPECT_EQ(verdict_with("axis = [1.0, 0.0]", "axis = [1.0, 0.0]\nmoment = 3"),
            "study.toml:36:10: error: joint \"C\": \"moment\" belongs to a revolute or screw joint, and this one is "
            "prismatic");
  EXPECT_EQ(verdict_with("kind = \"latch\"", "kind = \"latch\", damping = 1.0"),
            "study.toml:21:49: error: joint \"A\": lock: damping goes with a stiffness; without one the lock is rigid");
  EXPECT_EQ(verdict_with("name = \"rod\"", "name = \"crank\""),
            "study.toml:9:8: error: two nodes or bodies are called \"crank\"");
  EXPECT_EQ(verdict(crank + "\n[[coordinate]]\nname = \"x\"\nmass = 1.0\n").substr(0, 60),
            "study.toml:43:8: error: a [[coordinate]] does not go with a ");
}

TEST(ReadMechanism, ReadsListsOfLocksAndPointsToALoadThatIsGiven) {
  const std::string lock = "lock = { at = \"pi/2\", kind = \"latch\" }";
  EXPECT_EQ(verdict_with(lock, "lock = [{ at = 1.5, kind = \"stop\" }, { at = -1.5 }]").substr(0, 65),
            "study.toml:21:38: error: joint \"A\": lock(2) lacks the key \"kind\":");
  EXPECT_EQ(
      verdict_with(lock, "lock = []"),
      "study.toml:21:8: error: joint \"A\": lock must be a table { ... }, or a list of tables, got an empty list");
  EXPECT_EQ(verdict_with(lock, "friction = [{ coefficient = 0.1, preload = 1.0, radius = 0.1 }]"),
            "study.toml:21:12: error: joint \"A\": friction must be one table { ... }, got a list of 1");
  for (const std::string load : {"10", "\"10\"", "\"N0\""})
    EXPECT_EQ(
        verdict_with(lock, "friction = { coefficient = 0.1, radius = 0.1, normal_load = " + load + " }"),
        "study.toml:21:61: error: joint \"A\": friction: normal_load is \"reaction\", the joint's own; a load that "
        "is given [N] is \"preload\"");
  EXPECT_EQ(
      verdict_with(lock, "friction = { coefficient = 0.1, radius = 0.1, normal_force = \"reaction\" }"),
      "study.toml:21:47: error: joint \"A\": friction has no key \"normal_force\"; did you mean \"normal_load\"?");
}

TEST(ReadMechanism, NamesEveryKeyAndTheTableThatTakesAType) {
  EXPECT_EQ(verdict_with("[[joint]]", "[[strutt]]"),
            "study.toml:14:3: error: the study has no key \"strutt\"; write [[joint]] with type = \"strut\"");
  EXPECT_EQ(verdict_with("[[joint]]", "[[hinge]]"),
            "study.toml:14:3: error: the study has no key \"hinge\"; write [[joint]] with type = \"revolute\"");
  EXPECT_NE(verdict_with("[[joint]]", "[[linkage]]").find("gravity, body, joint, gear, bushing, analysis"),
            std::string::npos);
  EXPECT_NE(verdict_with("type = \"prismatic\"", "type = \"slot\"").find("planar, screw, strut"), std::string::npos);
}

// A strut without a law would leave the motion as it is.
TEST(ReadMechanism, RefusesAStrutOnWhichNothingActs) {
  const auto with_strut = [](const std::string& keys) {
    return verdict(crank +
                   "[[joint]]\nname = \"S\"\ntype = \"strut\"\nbetween = [\"ground\", \"rod\"]\nat = [0.0, "
                   "1.0]\nto = [2.0, 0.0]\n" +
                   keys);
  };
  EXPECT_EQ(with_strut(""),
            "study.toml:42:8: error: joint \"S\" is a strut that does nothing; give it \"force\", \"stiffness\", "
            "\"damping\", \"drive\", \"lock\", \"rate\" or \"friction\"; force = 0 only measures its length");
  for (const std::string keys :
       {"force = 0", "stiffness = 1", "damping = 1", "drive = \"2.3 + 0.1*t\"", "lock = { at = 3, kind = \"stop\" }",
        "rate = 1", "friction = { coefficient = 1, preload = 1 }"})
    EXPECT_EQ(with_strut(keys), "no complaint") << keys;
  EXPECT_EQ(
      with_strut("drive = \"-1 - t\""),
      "study.toml:47:9: error: joint \"S\": the drive of a strut is its length and must be positive, got -1 at the "
      "start");
}

TEST(ReadMechanism, WantsPlacesForJointsThatHaveNone) {
  EXPECT_EQ(verdict_with("at = [1.0, 0.0]\n", ""),
            "study.toml:24:8: error: joint \"B\" needs \"at\", its place in the configuration given [m]");
}

}  // namespace
}  // namespace rubato
