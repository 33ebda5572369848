#include <rubato/analysis/structure_tables.hpp>
#include <rubato/numerics/rotations.hpp>

#include <algorithm>
#include <array>
#include <span>
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

namespace {

/// A node, or a point that one carries.
struct Point {
  std::string name;
  double carrier;  ///< row of the node; itself, or -1 for the ground
  std::array<double, 3> at, turn, offset;
  Support support;
};

/// The numbers of a node in a configuration, as vectors.
class Places {
 public:
  Places(const model::Mechanism& mechanism, std::span<const double> numbers)
      : numbers_(numbers),
        width_(static_cast<std::size_t>(mechanism.numbers_a_node())),
        in_space_(mechanism.dimension == 3) {}

  numerics::Vector3 at(std::size_t node) const {
    const auto own = of(node);
    return {own[0], own[1], in_space_ ? own[2] : 0.0};
  }
  numerics::Rotation rotation(std::size_t node) const {
    const auto own = of(node);
    if (!in_space_) return numerics::rotation_of({0.0, 0.0, own[2]});
    return {own[3], own[4], own[5], own[6]};
  }
  /// The rotation vector, in the plane with its whole turns.
  numerics::Vector3 turn(std::size_t node) const {
    if (!in_space_) return {0.0, 0.0, of(node)[2]};
    return numerics::vector_of(rotation(node));
  }

 private:
  std::span<const double> of(std::size_t node) const { return numbers_.subspan(node * width_, width_); }

  std::span<const double> numbers_;
  std::size_t width_;
  bool in_space_;
};

std::array<double, 3> numbers_of(const numerics::Vector3& v) { return {v[0], v[1], v[2]}; }

results::Block number(const std::string& name, const std::string& unit, const std::string& description) {
  return {name, unit, description, "", {}};
}

/// Lines, and the nodes and points that they join.
struct Drawing {
  std::vector<Point> points;
  std::vector<std::array<double, 4>> lines;

  Drawing(const model::Mechanism& mechanism, const Places& places) {
    const bool in_space = mechanism.dimension == 3;
    for (std::size_t i = 1; i < mechanism.nodes.size(); ++i) {  // the first is the ground
      const auto& node = mechanism.nodes[i];
      const bool is_still =
          node.place[0] == ground && node.place[1] == ground && (!in_space || node.place[2] == ground);
      points.push_back({node.name,
                        static_cast<double>(points.size()),
                        numbers_of(places.at(i)),
                        numbers_of(places.turn(i)),
                        {0.0, 0.0, 0.0},
                        is_still ? pinned : free_to_move});
    }
    for (const model::DrawnLine& line : mechanism.lines)
      lines.push_back({static_cast<double>(lines.size() + 1), row_of(line.first, mechanism, places),
                       row_of(line.second, mechanism, places), static_cast<double>(line.kind)});
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const Point& point : points) all.push_back(point.name);
    return all;
  }

 private:
  /// The row of a point at which a line ends, which is added where it is new.
  double row_of(const model::DrawnLine::End& end, const model::Mechanism& mechanism, const Places& places) {
    const double carrier = static_cast<double>(end.node) - 1.0;
    if (carrier >= 0.0 && end.offset == std::array<double, 3>{}) return carrier;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (points[i].carrier == carrier && points[i].offset == end.offset) return static_cast<double>(i);
    const auto node = static_cast<std::size_t>(end.node);
    const numerics::Vector3 offset(end.offset[0], end.offset[1], end.offset[2]);
    const numerics::Vector3 at = places.at(node) + places.rotation(node) * offset;
    points.push_back({mechanism.nodes[node].name + ":" + std::to_string(points.size() + 1), carrier, numbers_of(at),
                      numbers_of(places.turn(node)), end.offset, carrier < 0.0 ? pinned : free_to_move});
    return static_cast<double>(points.size() - 1);
  }
};

/// @param motion  what the main table tells: "position", or "shape" about the configuration of `numbers`
void write_drawing(const std::string& analysis, const model::Mechanism& mechanism, std::span<const double> numbers,
                   const std::string& motion, results::Sink& sink) {
  if (mechanism.lines.empty() || mechanism.nodes.size() > most_drawn_nodes) return;
  const Drawing drawing(mechanism, Places(mechanism, numbers));
  const bool is_shape = motion == "shape";
  const std::string where = is_shape ? " in the configuration of the modes" : " at the start";
  const std::vector<std::string> names = drawing.names();
  std::vector<results::Block> columns{{"node", "1", "name of the node or point", "", {}, names},
                                      number("x", "m", "position along x" + where),
                                      number("y", "m", "position along y" + where),
                                      number("z", "m", "position along z" + where),
                                      {"support", "1", "what is fixed", "", {}, {"free", "held", "pinned", "clamped"}},
                                      number("carrier", "1", "row of the node that carries it; -1: the ground"),
                                      number("offset_x", "m", "place in the axes of the carrier"),
                                      number("offset_y", "m", "place in the axes of the carrier"),
                                      number("offset_z", "m", "place in the axes of the carrier")};
  if (is_shape)
    for (const char* name : {"rotation_x", "rotation_y", "rotation_z"})
      columns.push_back(number(name, "rad", "rotation vector of its axes" + where));
  const auto nodes =
      sink.open({analysis,
                 "nodes",
                 "node",
                 columns,
                 {{"type", "nodes"}, {"motion", motion}, {"degrees_of_freedom", std::to_string(mechanism.size())}}});
  for (std::size_t i = 0; i < drawing.points.size(); ++i) {
    const Point& p = drawing.points[i];
    std::vector<double> row{static_cast<double>(i)};
    row.insert(row.end(), p.at.begin(), p.at.end());
    row.insert(row.end(), {static_cast<double>(p.support), p.carrier});
    row.insert(row.end(), p.offset.begin(), p.offset.end());
    if (is_shape) row.insert(row.end(), p.turn.begin(), p.turn.end());
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
  for (const auto& row : drawing.lines) lines->append(row);
}

}  // namespace

void write_structure(const std::string& analysis, const model::Mechanism& mechanism, results::Sink& sink) {
  write_drawing(analysis, mechanism, mechanism.numbers(), "position", sink);
}

void write_configuration(const std::string& analysis, const model::Mechanism& mechanism,
                         std::span<const double> numbers, results::Sink& sink) {
  write_drawing(analysis, mechanism, numbers, "shape", sink);
}

}  // namespace rubato::analysis
