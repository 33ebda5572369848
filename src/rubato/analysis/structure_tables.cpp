#include <rubato/analysis/structure_tables.hpp>
#include <rubato/numerics/rotations.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace rubato::analysis {
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

void write_structure(const std::string& analysis, const model::Structure& structure, results::Sink& sink) {
  if (structure.elements.empty() || structure.names.size() > most_drawn_nodes) return;
  const results::Block node{"node", "1", "name of the node", "", {}, structure.names};
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

void write_structure(const std::string& analysis, const model::Mechanism& mechanism, results::Sink& sink) {
  if (mechanism.lines.empty() || mechanism.nodes.size() > most_drawn_nodes) return;
  struct Point {
    std::string name;
    double carrier;
    std::array<double, 3> at, offset;
    Support support;
  };
  const bool in_space = mechanism.dimension == 3;
  std::vector<Point> points;
  for (std::size_t i = 1; i < mechanism.nodes.size(); ++i) {  // the first is the ground
    const auto& node = mechanism.nodes[i];
    const bool is_still = node.place[0] == ground && node.place[1] == ground && (!in_space || node.place[2] == ground);
    points.push_back({node.name,
                      static_cast<double>(points.size()),
                      {node.numbers[0], node.numbers[1], in_space ? node.numbers[2] : 0.0},
                      {0.0, 0.0, 0.0},
                      is_still ? pinned : free_to_move});
  }
  const auto where = [&](const model::DrawnLine::End& end) {
    const auto& numbers = mechanism.nodes[static_cast<std::size_t>(end.node)].numbers;
    const numerics::Vector3 offset(end.offset[0], end.offset[1], end.offset[2]);
    const numerics::Rotation turn = in_space ? numerics::Rotation(numbers[3], numbers[4], numbers[5], numbers[6])
                                             : numerics::rotation_of({0.0, 0.0, numbers[2]});
    const numerics::Vector3 moved = turn * offset;
    return std::array<double, 3>{numbers[0] + moved[0], numbers[1] + moved[1], in_space ? numbers[2] + moved[2] : 0.0};
  };
  const auto place_of = [&](const model::DrawnLine::End& end) {
    const double carrier = static_cast<double>(end.node) - 1.0;
    if (carrier >= 0.0 && end.offset == std::array<double, 3>{}) return carrier;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (points[i].carrier == carrier && points[i].offset == end.offset) return static_cast<double>(i);
    const std::string of = mechanism.nodes[static_cast<std::size_t>(end.node)].name;
    points.push_back({of + ":" + std::to_string(points.size() + 1), carrier, where(end), end.offset,
                      carrier < 0.0 ? pinned : free_to_move});
    return static_cast<double>(points.size() - 1);
  };
  std::vector<std::array<double, 4>> ends;
  for (const model::DrawnLine& line : mechanism.lines)
    ends.push_back({static_cast<double>(ends.size() + 1), place_of(line.first), place_of(line.second),
                    static_cast<double>(line.kind)});

  std::vector<std::string> names;
  for (const Point& point : points) names.push_back(point.name);
  const auto number = [](const char* name, const char* unit, const char* description) {
    return results::Block{name, unit, description, "", {}};
  };
  const auto nodes = sink.open(
      {analysis,
       "nodes",
       "node",
       {{"node", "1", "name of the node or point", "", {}, names},
        number("x", "m", "position along x at the start"),
        number("y", "m", "position along y at the start"),
        number("z", "m", "position along z at the start"),
        {"support", "1", "what is fixed", "", {}, {"free", "held", "pinned", "clamped"}},
        number("carrier", "1", "row of the node that carries it; -1: the ground"),
        number("offset_x", "m", "place in the axes of the carrier"),
        number("offset_y", "m", "place in the axes of the carrier"),
        number("offset_z", "m", "place in the axes of the carrier")},
       {{"type", "nodes"}, {"motion", "position"}, {"degrees_of_freedom", std::to_string(mechanism.size())}}});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& p = points[i];
    const std::array<double, 9> row{static_cast<double>(i),
                                    p.at[0],
                                    p.at[1],
                                    p.at[2],
                                    static_cast<double>(p.support),
                                    p.carrier,
                                    p.offset[0],
                                    p.offset[1],
                                    p.offset[2]};
    nodes->append(row);
  }
  const auto lines = sink.open({analysis,
                                "lines",
                                "line",
                                {number("line", "1", "number of the line"),
                                 {"first", "1", "node where it begins", "", {}, names},
                                 {"second", "1", "node where it ends", "", {}, names},
                                 {"kind", "1", "what it is", "", {}, {"beam", "body", "link"}}},
                                {{"type", "lines"}}});
  for (const auto& row : ends) lines->append(row);
}

}  // namespace rubato::analysis
