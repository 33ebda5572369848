#include <rubato/model/build_mechanism.hpp>
#include <rubato/results/drawing/mechanism_drawing.hpp>

#include "support/memory_sink.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rubato::analysis {
namespace {

using results::write_structure;

TEST(MechanismTables, TellWhereABodyCarriesItsJoints) {
  model::Mechanism m(2);
  const Index crank = m.add_node("crank", {0.5, 0.0, std::numbers::pi / 2.0});
  const model::PlanePoint joint = m.plane_point(crank, 0.0, 0.0);
  const model::DrawnLine::End at{crank, {joint.offset[0], joint.offset[1], 0.0}}, still{};
  m.drawing.lines = {{model::DrawnLine::Kind::body, {crank, {}}, at}, {model::DrawnLine::Kind::link, at, still}};
  testing::MemorySink sink;
  write_structure("run", m, sink);
  const auto& nodes = sink.tables.at("run.nodes").rows;
  ASSERT_EQ(nodes.size(), 3u);
  EXPECT_EQ(nodes[0], (std::vector<double>{0, 0.5, 0.0, 0.0, 0, 0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(nodes[1][5], 0.0);           // carried by the crank
  EXPECT_NEAR(nodes[1][6], 0.0, 1e-16);  // (-0.5, 0) of the world, in axes that are turned by a right angle
  EXPECT_NEAR(nodes[1][7], 0.5, 1e-16);
  EXPECT_EQ(nodes[2][5], -1.0);
  EXPECT_EQ(nodes[2][4], 2.0);  // pinned
  const auto& lines = sink.tables.at("run.lines").rows;
  EXPECT_EQ(lines[0], (std::vector<double>{1, 0, 1, 1}));
  EXPECT_EQ(lines[1], (std::vector<double>{2, 1, 2, 2}));
  EXPECT_EQ(sink.tables.at("run.nodes").layout.attributes.back().second, "3");
}

// A body turned by a right angle about x: its own z points along -y of the world.
TEST(MechanismTables, TellWhereABodyInSpaceCarriesItsJoints) {
  model::Mechanism m(3);
  const Index body =
      m.add_space_node("body", {1.0, 2.0, 3.0}, numerics::rotation_of({std::numbers::pi / 2.0, 0.0, 0.0}));
  m.drawing.lines = {{model::DrawnLine::Kind::body, {body, {}}, {body, {0.5, 0.0, 0.25}}}};
  testing::MemorySink sink;
  write_structure("run", m, sink);
  const auto& nodes = sink.tables.at("run.nodes").rows;
  ASSERT_EQ(nodes.size(), 2u);
  EXPECT_NEAR(nodes[1][1], 1.5, 1e-15);
  EXPECT_NEAR(nodes[1][2], 1.75, 1e-15);
  EXPECT_NEAR(nodes[1][3], 3.0, 1e-15);
  EXPECT_EQ(nodes[1][8], 0.25);
  EXPECT_EQ(sink.tables.at("run.nodes").layout.attributes.back().second, "6");
}

/// A sledge on a ground guide along the diagonal, turned by a right angle, with a stop, and a strut from it to the
/// ground.
model::ModelDescription sledge_on_a_guide() {
  model::ModelDescription description;
  model::BodyDescription sledge;
  sledge.name = "sledge";
  sledge.position = {0.0, 0.0};
  sledge.angle = std::numbers::pi / 2.0;
  sledge.shape = model::ShapeDescription{};
  sledge.shape->size = {0.4, 0.2, 0.1};
  sledge.shape->density = 1000.0;
  model::JointDescription guide;
  guide.name = "guide";
  guide.type = model::JointDescription::Type::prismatic;
  guide.between = {"sledge", "ground"};
  guide.at = {0.0, 0.0};
  guide.axis = {1.0, 1.0};
  guide.locks = {{0.5, false, {}, {}, {}, {}}};
  model::JointDescription strut;
  strut.name = "strut";
  strut.type = model::JointDescription::Type::strut;
  strut.between = {"sledge", "ground"};
  strut.at = {0.0, 0.0};
  strut.to = {1.0, 0.0};
  strut.stiffness = 10.0;
  strut.damping = 1.0;
  description.bodies = {sledge};
  description.joints = {guide, strut};
  return description;
}

TEST(MechanismTables, TellTheTypeThePointsAndTheAxisOfAJoint) {
  testing::MemorySink sink;
  write_structure("run", model::build_mechanism(sledge_on_a_guide(), {}), sink);
  const auto& joints = sink.tables.at("run.joints");
  ASSERT_EQ(joints.rows.size(), 2u);
  const auto word = [&](std::size_t row, std::size_t column) {
    return joints.layout.blocks[column].categories[static_cast<std::size_t>(joints.rows[row][column])];
  };
  EXPECT_EQ(word(0, 0), "guide");
  EXPECT_EQ(word(0, 1), "prismatic");
  EXPECT_EQ(word(0, 2), "sledge");  // at its centre of mass
  EXPECT_EQ(word(0, 8), "stop");
  // The diagonal, in axes that are turned by a right angle: (x, y) there is (y, -x).
  EXPECT_NEAR(joints.rows[0][4], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(joints.rows[0][5], -std::sqrt(0.5), 1e-15);
  EXPECT_EQ(word(1, 1), "strut");
  EXPECT_EQ(word(1, 7), "spring");  // and a damper, which the symbol leaves out
  EXPECT_EQ(word(1, 8), "none");
}

TEST(MechanismTables, TellTheShapeOfABodyByTheBoxAroundIt) {
  testing::MemorySink sink;
  write_structure("run", model::build_mechanism(sledge_on_a_guide(), {}), sink);
  EXPECT_EQ(sink.tables.at("run.shapes").rows, (std::vector<std::vector<double>>{{1, 0, 0, 0.4, 0.2, 0.1}}));
  model::ModelDescription description = sledge_on_a_guide();
  description.bodies[0].shape->kind = model::ShapeDescription::Kind::cylinder;
  description.bodies[0].shape->radius = 0.3;
  description.bodies[0].shape->length = 0.7;
  testing::MemorySink other;
  write_structure("run", model::build_mechanism(description, {}), other);
  EXPECT_EQ(other.tables.at("run.shapes").rows, (std::vector<std::vector<double>>{{1, 0, 1, 0.6, 0.6, 0.7}}));
}

TEST(MechanismTables, TellAScrewAndAUniversalJointByTheAxisOfTheFirstPart) {
  model::ModelDescription description;
  model::BodyDescription nut;
  nut.name = "nut";
  nut.mass = 1.0;
  nut.inertia = {1.0, 1.0, 1.0};
  nut.position = {0.0, 0.0, 0.0};
  model::BodyDescription arm = nut;
  arm.name = "arm";
  arm.position = {1.0, 0.0, 0.0};
  model::JointDescription thread;
  thread.name = "thread";
  thread.type = model::JointDescription::Type::screw;
  thread.between = {"ground", "nut"};
  thread.at = {0.0, 0.0, 0.0};
  thread.axis = {0.0, 2.0, 0.0};
  thread.lead = 0.1;
  model::JointDescription cross = thread;
  cross.name = "cross";
  cross.type = model::JointDescription::Type::universal;
  cross.between = {"nut", "arm"};
  cross.lead.reset();
  cross.second_axis = {1.0, 0.0, 0.0};
  description.bodies = {nut, arm};
  description.joints = {thread, cross};
  testing::MemorySink sink;
  write_structure("run", model::build_mechanism(description, {}), sink);
  for (const auto& row : sink.tables.at("run.joints").rows) {
    EXPECT_NEAR(row[4], 0.0, 1e-15);
    EXPECT_NEAR(row[5], 1.0, 1e-15);
    EXPECT_NEAR(row[6], 0.0, 1e-15);
  }
}

}  // namespace
}  // namespace rubato::analysis
