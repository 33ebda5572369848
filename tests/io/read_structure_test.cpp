#include "study_text.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rubato::testing {
namespace {

/// A portal in the plane with one of everything. The tests count lines in it.
const std::string portal_text =
    "[[node]]\n"                           // 1
    "name = \"foot\"\n"                    // 2
    "position = [0.0, 0.0]\n"              // 3
    "[[node]]\n"                           // 4
    "name = 2\n"                           // 5
    "position = [0.0, 3.0]\n"              // 6
    "[[node]]\n"                           // 7
    "name = \"tip\"\n"                     // 8
    "position = [2.0, \"3.0\"]\n"          // 9
    "[[material]]\n"                       // 10
    "name = \"steel\"\n"                   // 11
    "young = 2.1e11\n"                     // 12
    "poisson = 0.3\n"                      // 13
    "density = 7850.0\n"                   // 14
    "[[section]]\n"                        // 15
    "name = \"tube\"\n"                    // 16
    "area = 1e-3\n"                        // 17
    "inertia = 1e-6\n"                     // 18
    "shear_factor = 0.5\n"                 // 19
    "[[beam]]\n"                           // 20
    "name = \"column\"\n"                  // 21
    "nodes = [\"foot\", 2]\n"              // 22
    "section = \"tube\"\n"                 // 23
    "material = \"steel\"\n"               // 24
    "elements = 4\n"                       // 25
    "[[beam]]\n"                           // 26
    "nodes = [2, \"tip\"]\n"               // 27
    "section = \"tube\"\n"                 // 28
    "material = \"steel\"\n"               // 29
    "formulation = \"euler_bernoulli\"\n"  // 30
    "mass = \"lumped\"\n"                  // 31
    "[[truss]]\n"                          // 32
    "nodes = [\"foot\", \"tip\"]\n"        // 33
    "section = \"tube\"\n"                 // 34
    "material = \"steel\"\n"               // 35
    "[[mass]]\n"                           // 36
    "node = \"tip\"\n"                     // 37
    "mass = 10.0\n"                        // 38
    "inertia = 0.5\n"                      // 39
    "[[support]]\n"                        // 40
    "node = \"foot\"\n"                    // 41
    "fix = [\"x\", \"y\", \"rz\"]\n"       // 42
    "[gravity]\n"                          // 43
    "acceleration = [0.0, -9.81]\n"        // 44
    "[[displacement]]\n"                   // 45
    "on = \"tip.x\"\n"                     // 46
    "value = 0.01\n"                       // 47
    "[[force]]\n"                          // 48
    "on = \"tip.y\"\n"                     // 49
    "held = -100.0\n"                      // 50
    "[[slider]]\n"                         // 51
    "name = \"hinge\"\n"                   // 52
    "between = [\"2.rz\", \"foot.rz\"]\n"  // 53
    "stiffness = 100.0\n"                  // 54
    "friction_coefficient = 1.0\n"         // 55
    "normal_load = 2.0\n"                  // 56
    "[[analysis]]\n"                       // 57
    "name = \"rest\"\n"                    // 58
    "type = \"static\"\n";                 // 59

std::string portal_with(const std::string& from, const std::string& to) {
  return verdict(edited(from, to, portal_text));
}

TEST(StructureFile, IsReadWithEveryTable) {
  EXPECT_EQ(verdict(portal_text), "accepted");
  const auto study = io::read_study_text(portal_text, "study.toml", ".");
  const model::Model model = model::build(study.model, {});
  EXPECT_EQ(model.size(), 3 * 5);
  EXPECT_EQ(model.coordinates[0], "2.x");
  EXPECT_EQ(model.structure.names.back(), "column:3");
  EXPECT_EQ(model.mass[5], 0.5);  // tip.rz
  EXPECT_EQ(model.gravity[1], -9.81);
  EXPECT_EQ(model.held_displacements.at(0).coordinate, 3);
  EXPECT_EQ(model.held_forces.at(0).value, -100.0);
  EXPECT_EQ(model.sliders.at(0).second, ground);
  EXPECT_TRUE(model.structure.properties.at(1).lumped_mass);
  EXPECT_EQ(model.structure.properties.at(1).shear_area_y, 0.0);
}

TEST(StructureFileError, PointsAtTheNameThatIsUnknown) {
  EXPECT_EQ(portal_with("nodes = [2, \"tip\"]", "nodes = [2, \"tipp\"]"),
            "study.toml:27:13: error: the beam from \"2\" to \"tipp\" joins \"tipp\", which is no node; did you mean "
            "\"tip\"? (known: foot, 2, tip, column:1, column:2, column:3)");
  EXPECT_EQ(portal_with("section = \"tube\"\nmaterial = \"steel\"\nelements",
                        "section = \"tubes\"\nmaterial = \"steel\"\nelements"),
            "study.toml:23:11: error: beam \"column\" has the section \"tubes\", which is no section; did you mean "
            "\"tube\"? (known: tube)");
  EXPECT_EQ(portal_with("on = \"tip.y\"", "on = \"tip.rx\""),
            "study.toml:49:6: error: a force is on \"tip.rx\", but a node has x, y, rz in the plane");
  EXPECT_EQ(portal_with("on = \"tip.x\"", "on = \"foot.x\""),
            "study.toml:46:6: error: a displacement is of \"foot.x\", which a support holds");
}

TEST(StructureFileError, PointsAtWhatIsThereTwice) {
  EXPECT_EQ(portal_with("name = \"tip\"", "name = \"foot\""), "study.toml:8:8: error: two nodes are called \"foot\"");
  EXPECT_EQ(portal_with("[[mass]]",
                        "[[beam]]\nname = \"column\"\nnodes = [\"foot\", \"tip\"]\nsection = \"tube\"\n"
                        "material = \"steel\"\n[[mass]]"),
            "study.toml:36:1: error: two elements are called \"column\"");
}

TEST(StructureFileError, PointsAtABeamWithoutLengthOrInertia) {
  EXPECT_EQ(portal_with("position = [0.0, 3.0]", "position = [0.0, 0.0]"),
            "study.toml:20:1: error: beam \"column\" has no length: nodes \"foot\" and \"2\" lie in the same place");
  EXPECT_EQ(
      portal_with("inertia = 1e-6\n", ""),
      "study.toml:22:11: error: beam \"column\" has the section \"tube\", which has no inertia; give the section one "
      "[m4], or take a [[truss]]");
  EXPECT_EQ(portal_with("position = [0.0, 3.0]\n[[node]]",
                        "position = [0.0, 3.0]\n[[node]]\nname = \"alone\"\n"
                        "position = [9.0, 9.0]\n[[node]]"),
            "study.toml:8:8: error: node \"alone\" is joined by nothing: no beam, truss or mass names it");
}

TEST(StructureFileError, PointsAtNumbersOutOfRange) {
  EXPECT_EQ(portal_with("elements = 4", "elements = 0"),
            "study.toml:25:12: error: beam \"column\": elements must be from 1 to 10 million, got 0");
  EXPECT_EQ(portal_with("young = 2.1e11", "young = -1"),
            "study.toml:12:9: error: material \"steel\": young must be positive, got -1");
  EXPECT_EQ(portal_with("young = 2.1e11", "young = \"0/0\""),
            "study.toml:12:9: error: material \"steel\": young is nan (from \"0/0\"); give a finite number");
  EXPECT_EQ(portal_with("poisson = 0.3", "poisson = 0.6"),
            "study.toml:13:11: error: material \"steel\": poisson must lie in (-1, 0.5], got 0.6");
  EXPECT_EQ(
      portal_with("shear_factor = 0.5", "shear_factor = 1.2"),
      "study.toml:19:16: error: section \"tube\": shear_factor is the shear area over the area and cannot exceed 1, "
      "got 1.2");
  EXPECT_EQ(portal_with("mass = 10.0", "mass = 0"),
            "study.toml:38:8: error: the mass on node \"tip\": mass must be positive, got 0");
  EXPECT_EQ(portal_with("[0.0, -9.81]", "[0.0, 0.0, -9.81]"),
            "study.toml:43:1: error: [gravity]: acceleration takes 2 numbers, as the positions of nodes do, got 3");
}

TEST(StructureFileError, NamesMissingAndMisspeltKeys) {
  EXPECT_EQ(portal_with("fix = ", "fixed = "),
            "study.toml:40:1: error: the support at node \"foot\" lacks the key \"fix\"");
  EXPECT_EQ(portal_with("position = [0.0, 3.0]", "positon = [0.0, 3.0]"),
            "study.toml:6:1: error: node \"2\" has no key \"positon\"; did you mean \"position\"?");
  EXPECT_EQ(portal_with("acceleration = ", "accelerations = "),
            "study.toml:44:1: error: [gravity] has no key \"accelerations\"; did you mean \"acceleration\"?");
  EXPECT_EQ(portal_with("mass = \"lumped\"", "mass = \"lumpd\""),
            "study.toml:31:8: error: [[beam]]: mass cannot be \"lumpd\"; did you mean \"lumped\"? (known: consistent, "
            "lumped)");
}

TEST(DistributedForceFile, IsReadAndPointsAtItsFaults) {
  const std::string load =
      "[[distributed_force]]\n"     // 43
      "on = \"column\"\n"           // 44
      "direction = [1.0, 0.0]\n"    // 45
      "expression = \"1e3 * t\"\n"  // 46
      "[gravity]\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    return verdict(edited(from, to, edited("[gravity]\n", load, portal_text)));
  };
  EXPECT_EQ(with("1e3 * t", "2e3 * t"), "accepted");
  EXPECT_EQ(
      with("on = \"column\"", "on = \"colum\""),
      "study.toml:44:6: error: a distributed force is on \"colum\", which is the name of no beam or truss; did you "
      "mean \"column\"? (known: column, 2-tip, foot-tip)");
  // A beam without a name is FIRST-SECOND.
  EXPECT_EQ(with("on = \"column\"", "on = \"2-tip\""), "accepted");
  EXPECT_EQ(
      with("direction = [1.0, 0.0]", "direction = [1.0]"),
      "study.toml:44:6: error: the distributed force on \"column\": direction takes 2 numbers, as the positions of "
      "nodes do, got 1");
  EXPECT_EQ(with("direction = [1.0, 0.0]", "direction = [0, 0.0]"),
            "study.toml:44:6: error: the distributed force on \"column\": its direction has no length, and it would do "
            "nothing; give the direction in which it pushes, such as [0, -1]");
  EXPECT_EQ(with("1e3 * t", "1e3 / t"),
            "study.toml:46:14: error: the distributed force on \"column\": \"1e3 / t\" is inf at t = 0; give a formula "
            "that is finite at all times");
  EXPECT_EQ(
      with("1e3 * t", "1e3 / 0"),
      "study.toml:46:14: error: the distributed force on \"column\": expression is inf (from \"1e3 / 0\"); give a "
      "finite number");
}

TEST(NodeFault, RefusesTheNameOfTheGround) {
  EXPECT_EQ(
      portal_with("name = \"tip\"", "name = \"ground\""),
      "study.toml:8:8: error: a node cannot be called \"ground\", which is the name of what does not move; give it "
      "another name, and hold it by a [[support]]");
}

TEST(ReleaseFile, IsReadAndPointsAtItsFaults) {
  const auto with = [](const std::string& release) {
    return portal_with("elements = 4\n", "elements = 4\nrelease = " + release + "\n");  // line 26
  };
  EXPECT_EQ(with("{ first = [\"rz\"] }"), "accepted");
  EXPECT_EQ(with("{ second = [\"rx\"] }"),
            "study.toml:26:11: error: beam \"column\" releases \"rx\"; an end of a beam has x, y, rz in the plane");
  EXPECT_EQ(with("{ frist = [\"rz\"] }"),
            "study.toml:26:13: error: beam \"column\": release has no key \"frist\"; did you mean \"first\"? "
            "(known: first, second)");
  EXPECT_EQ(portal_with("elements = 4\n", "release = { first = [\"x\"], second = [\"x\"] }\n"),
            "study.toml:25:11: error: beam \"column\" releases so much that it moves by itself without resistance: a "
            "mechanism; keep one of the ends of each motion");
}

TEST(StopFile, IsReadAndPointsAtItsFaults) {
  const std::string stop =
      "[[stop]]\n"                           // 57
      "name = \"bumper\"\n"                  // 58
      "between = [\"tip.x\", \"ground\"]\n"  // 59
      "gap = -0.001\n"                       // 60
      "stiffness = 1e6\n"                    // 61
      "damping = 10.0\n"                     // 62
      "[[analysis]]\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    return verdict(edited(from, to, edited("[[analysis]]\n", stop, portal_text)));
  };
  EXPECT_EQ(with("-0.001", "\"2 * 0.001\""), "accepted");
  EXPECT_EQ(with("damping = 10.0\n", ""), "accepted");
  EXPECT_EQ(with("stiffness = 1e6", "stiffness = 0"),
            "study.toml:61:13: error: stop \"bumper\": stiffness must be positive, got 0");
  EXPECT_EQ(with("damping = 10.0", "damping = -1"),
            "study.toml:62:11: error: stop \"bumper\": damping must not be negative, got -1");
  EXPECT_EQ(with("gap = -0.001\n", ""), "study.toml:57:1: error: stop \"bumper\" lacks the key \"gap\"");
  EXPECT_EQ(with("\"tip.x\", \"ground\"", "\"tip.x\", \"tip.x\""),
            "study.toml:59:21: error: stop \"bumper\" joins \"tip.x\" with itself");
  EXPECT_EQ(with("name = \"bumper\"", "name = \"hinge\""),
            "study.toml:58:8: error: stop \"hinge\" has the name of a slider or a coordinate; results would mix them "
            "up");
}

// Weight of what hangs on the foot: column 1e-3 m2 x 3 m, beam 2 m, truss sqrt(13) m of steel, and the mass of 10 kg;
// of what a support holds, the foot's share, nothing arrives.
TEST(Gravity, PullsElementsAndMasses) {
  const auto study = io::read_study_text(portal_text, "study.toml", ".");
  const auto system = system::assemble(model::build(study.model, {}));
  Vector load(system.size());
  system.loads().evaluate(0.0, load);
  const double line = 7850.0 * 1e-3;
  double vertical = 0.0;
  for (Index i = 0; i < system.size(); ++i) {
    const std::string& name = system.coordinates()[static_cast<std::size_t>(i)];
    if (name.ends_with(".y")) vertical += load[i];
  }
  const double expected = -9.81 * (line * (3.0 - 3.0 / 8.0 + 2.0 + std::sqrt(13.0) / 2.0) + 10.0);
  EXPECT_NEAR(vertical, expected, 1e-12 * std::abs(expected));
}

}  // namespace
}  // namespace rubato::testing
