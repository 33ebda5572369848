#pragma once

#include <rubato/model/description.hpp>

#include <string>
#include <utility>

// The frame of Cardona and Cassano (1991), section 3 of the reference page.
namespace rubato::testing {

inline model::NodeDescription node_at(std::string name, double x, double y) {
  model::NodeDescription node;
  node.name = std::move(name);
  node.position = {x, y};
  return node;
}

/// Half of a symmetric portal: column 2.7 m, clamped foot (node 7), half beam 3 m to the plane of symmetry (node 1).
inline model::ModelDescription portal_frame() {
  model::ModelDescription description;
  model::StructureDescription& frame = description.structure;
  const double positions[][2] = {{3.0, 2.7}, {2.0, 2.7}, {1.0, 2.7}, {0.0, 2.7}, {0.0, 1.8}, {0.0, 0.9}, {0.0, 0.0}};
  for (const auto& p : positions) {
    frame.nodes.push_back(node_at(std::to_string(frame.nodes.size() + 1), p[0], p[1]));
    if (frame.nodes.size() == 1) continue;
    model::BeamDescription beam;
    beam.nodes = {std::to_string(frame.nodes.size() - 1), std::to_string(frame.nodes.size())};
    beam.section = "tube";
    beam.material = "steel";
    frame.beams.push_back(beam);
  }
  frame.materials = {{"steel", 206.01e9, 0.3, {}, 7800.0, {}, {}}};
  frame.sections = {{"tube", 3.2e-3, {1.707e-6}, {}, {5.0 / 6.0}, {}}};
  model::SupportDescription symmetry, foot;
  symmetry.node = "1";
  symmetry.fix = {"x", "rz"};
  foot.node = "7";
  foot.fix = {"x", "y", "rz"};
  frame.supports = {symmetry, foot};
  return description;
}

}  // namespace rubato::testing
