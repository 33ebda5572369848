#pragma once

#include <rubato/model/model.hpp>
#include <rubato/system/assemble.hpp>

#include <support/frame.hpp>

#include <algorithm>
#include <string>
#include <utility>

// Equations of structures as their description gives them, and a portal to build small ones from.
namespace rubato::testing {

inline system::LocallyNonlinear assembled(const model::ModelDescription& description) {
  return system::assemble(model::build(description, {}));
}

inline Index place_of(const system::LocallyNonlinear& system, const std::string& name) {
  const auto& names = system.coordinates();
  return std::find(names.begin(), names.end(), name) - names.begin();
}

/// Two columns of height H, fixed at their feet, and a beam of length B between their heads.
inline model::ModelDescription portal(double height, double width) {
  model::ModelDescription description;
  model::StructureDescription& frame = description.structure;
  const double places[][2] = {{0.0, 0.0}, {0.0, height}, {width, height}, {width, 0.0}};
  for (const auto& p : places) frame.nodes.push_back(node_at(std::to_string(frame.nodes.size() + 1), p[0], p[1]));
  frame.materials = {{"steel", 2.1e11, 0.3, {}, 7850.0, {}}};
  frame.sections = {{"tube", 1e-3, {1e-6}, {}, {}, {}}};
  for (const auto& [first, second] : {std::pair{"1", "2"}, {"2", "3"}, {"4", "3"}}) {
    model::BeamDescription beam;
    beam.nodes = {first, second};
    beam.section = "tube";
    beam.material = "steel";
    beam.formulation = model::BeamDescription::Formulation::euler_bernoulli;
    frame.beams.push_back(beam);
  }
  model::SupportDescription left, right;
  left.node = "1";
  right.node = "4";
  left.fix = right.fix = {"x", "y", "rz"};
  frame.supports = {left, right};
  return description;
}

}  // namespace rubato::testing
