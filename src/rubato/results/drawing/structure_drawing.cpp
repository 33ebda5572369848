#include <rubato/results/drawing/structure_drawing.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace rubato::results {
namespace {

enum Support { free_to_move, held, pinned, clamped };

/// Whether a beam gives rotations to each node.
std::vector<char> turning_nodes(const model::Structure& structure) {
  std::vector<char> turns(structure.names.size(), 0);
  for (const model::LineElement& element : structure.elements) {
    if (structure.properties[static_cast<std::size_t>(element.properties)].kind == model::LineProperties::Kind::truss)
      continue;
    for (const Index node : {element.first, element.second}) turns[static_cast<std::size_t>(node)] = 1;
  }
  return turns;
}

/// How a node is supported, from its degrees of freedom that are fixed.
Support support_of(const model::Structure& structure, std::size_t node, bool turns) {
  const bool in_space = structure.dimension == 3;
  const std::array<bool, 6> exists{true, true, in_space, turns && in_space, turns && in_space, turns};
  int fixed_translations = 0, translations = 0, fixed_rotations = 0, rotations = 0;
  for (std::size_t axis = 0; axis < exists.size(); ++axis) {
    if (!exists[axis]) continue;
    const bool is_fixed = structure.places[node][axis] == ground;
    (model::is_rotation(axis) ? rotations : translations) += 1;
    (model::is_rotation(axis) ? fixed_rotations : fixed_translations) += is_fixed;
  }
  if (fixed_translations < translations) return fixed_translations > 0 ? held : free_to_move;
  return rotations > 0 && fixed_rotations == rotations ? clamped : pinned;
}

std::size_t moving_places(const model::Structure& structure) {
  std::size_t count = 0;
  for (const auto& places : structure.places)
    count += static_cast<std::size_t>(std::count_if(places.begin(), places.end(), [](Index i) { return i != ground; }));
  return count;
}

}  // namespace

void write_structure(const std::string& analysis, const model::Structure& structure, Sink& sink) {
  if (structure.elements.empty() || structure.names.size() > most_drawn_nodes) return;
  const Block node{"node", "1", "name of the node", "", {}, structure.names};
  const auto nodes = sink.open({analysis,
                                "nodes",
                                "node",
                                {node,
                                 {"x", "m", "reference position along x", "", {}},
                                 {"y", "m", "reference position along y", "", {}},
                                 {"z", "m", "reference position along z", "", {}},
                                 {"support", "1", "what is fixed", "", {}, {"free", "held", "pinned", "clamped"}}},
                                {{"type", "nodes"},
                                 {"motion", "displacement"},
                                 {"degrees_of_freedom", std::to_string(moving_places(structure))}}});
  const std::vector<char> turns = turning_nodes(structure);
  for (std::size_t i = 0; i < structure.names.size(); ++i) {
    const model::Axis& at = structure.positions[i];
    const std::array<double, 5> row{static_cast<double>(i), at[0], at[1], at[2],
                                    static_cast<double>(support_of(structure, i, turns[i] != 0))};
    nodes->append(row);
  }
  const auto lines = sink.open({analysis,
                                "lines",
                                "line",
                                {{"line", "1", "number of the element", "", {}},
                                 {"first", "1", "node where it begins", "", {}, structure.names},
                                 {"second", "1", "node where it ends", "", {}, structure.names}},
                                {{"type", "lines"}}});
  for (std::size_t i = 0; i < structure.elements.size(); ++i) {
    const model::LineElement& element = structure.elements[i];
    const std::array<double, 3> row{static_cast<double>(i + 1), static_cast<double>(element.first),
                                    static_cast<double>(element.second)};
    lines->append(row);
  }
}

}  // namespace rubato::results
