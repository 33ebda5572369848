#include <rubato/analysis/structure_tables.hpp>
#include <rubato/model/model.hpp>

#include "support/frame.hpp"
#include "support/memory_sink.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace rubato::analysis {
namespace {

TEST(StructureTables, NameNodesWithTheirPositionsAndSupports) {
  testing::MemorySink sink;
  write_structure("run", model::build(testing::portal_frame(), {}).structure, sink);
  const auto& nodes = sink.tables.at("run.nodes");
  ASSERT_EQ(nodes.rows.size(), 7u);
  EXPECT_EQ(nodes.layout.blocks.front().categories.front(), "1");
  EXPECT_EQ(nodes.rows[3], (std::vector<double>{3, 0.0, 2.7, 0.0, 0}));  // the corner is free
  EXPECT_EQ(nodes.rows[0].back(), 1);                                    // held in x and rz, free in y
  EXPECT_EQ(nodes.rows[6].back(), 3);                                    // clamped
  // Seven nodes of three, five of them held.
  EXPECT_EQ(nodes.layout.attributes.back().second, "16");
}

TEST(StructureTables, NameTheEndsOfEveryElement) {
  testing::MemorySink sink;
  write_structure("run", model::build(testing::portal_frame(), {}).structure, sink);
  const auto& lines = sink.tables.at("run.lines");
  ASSERT_EQ(lines.rows.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const double first = static_cast<double>(i);
    EXPECT_EQ(lines.rows[i], (std::vector<double>{first + 1.0, first, first + 1.0}));
  }
}

TEST(StructureTables, CallASupportedNodeOfTrussesPinned) {
  model::ModelDescription description;
  description.structure.nodes = {{"a", {0.0, 0.0}, {}}, {"b", {1.0, 0.0}, {}}};
  description.structure.materials = {{"steel", 2e11, 0.3, {}, 7800.0, {}}};
  description.structure.sections = {{"bar", 1e-3, {}, {}, {}, {}}};
  model::TrussDescription bar;
  bar.nodes = {"a", "b"};
  bar.section = "bar";
  bar.material = "steel";
  description.structure.trusses = {bar};
  model::SupportDescription at;
  at.node = "a";
  at.fix = {"x", "y"};
  description.structure.supports = {at};
  testing::MemorySink sink;
  write_structure("run", model::build(description, {}).structure, sink);
  EXPECT_EQ(sink.tables.at("run.nodes").rows[0].back(), 2);
}

TEST(StructureTables, TellWhereABodyCarriesItsJoints) {
  model::Mechanism m(2);
  const Index crank = m.add_node("crank", {0.5, 0.0, std::numbers::pi / 2.0});
  const model::PlanePoint joint = m.plane_point(crank, 0.0, 0.0);
  const model::DrawnLine::End at{crank, {joint.offset[0], joint.offset[1], 0.0}}, still{};
  m.lines = {{model::DrawnLine::Kind::body, {crank, {}}, at}, {model::DrawnLine::Kind::link, at, still}};
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
TEST(StructureTables, TellWhereABodyInSpaceCarriesItsJoints) {
  model::Mechanism m(3);
  const Index body =
      m.add_space_node("body", {1.0, 2.0, 3.0}, numerics::rotation_of({std::numbers::pi / 2.0, 0.0, 0.0}));
  m.lines = {{model::DrawnLine::Kind::body, {body, {}}, {body, {0.5, 0.0, 0.25}}}};
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

TEST(StructureTables, AreNotWrittenForCoordinates) {
  testing::MemorySink sink;
  write_structure("run", model::Structure{}, sink);
  EXPECT_TRUE(sink.tables.empty());
}

}  // namespace
}  // namespace rubato::analysis
