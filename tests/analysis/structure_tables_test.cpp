#include <rubato/model/model.hpp>
#include <rubato/results/drawing/structure_drawing.hpp>

#include "support/frame.hpp"
#include "support/memory_sink.hpp"

#include <gtest/gtest.h>

namespace rubato::analysis {
namespace {

using results::write_structure;

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
  const auto add_node = [&](const std::string& name, double x) {
    model::NodeDescription& node = description.structure.nodes.emplace_back();
    node.name = name;
    node.position = {x, 0.0};
  };
  add_node("a", 0.0);
  add_node("b", 1.0);
  description.structure.materials = {{"steel", 2e11, 0.3, {}, 7800.0, {}, {}}};
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

TEST(StructureTables, AreNotWrittenForCoordinates) {
  testing::MemorySink sink;
  write_structure("run", model::Structure{}, sink);
  EXPECT_TRUE(sink.tables.empty());
}

}  // namespace
}  // namespace rubato::analysis
