#include <rubato/model/joints/joint_kinds.hpp>
#include <rubato/numerics/rotations.hpp>
#include <rubato/results/drawing/mechanism_drawing.hpp>
#include <rubato/results/drawing/structure_drawing.hpp>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

namespace rubato::results {
namespace {

enum Support { free_to_move, held, pinned, clamped };

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

Block number(const std::string& name, const std::string& unit, const std::string& description) {
  return {name, unit, description, "", {}};
}

/// Lines, joints and shapes as rows, and the nodes and points that they join.
struct Drawing {
  std::vector<Point> points;
  std::vector<std::array<double, 4>> lines;
  std::vector<std::array<double, 9>> joints;
  std::vector<std::array<double, 6>> shapes;

  Drawing(const model::Mechanism& mechanism, const Places& places) {
    const bool in_space = mechanism.dimension == 3;
    for (std::size_t i = 1; i < mechanism.nodes.size(); ++i) {  // the first is the ground
      const auto& node = mechanism.nodes[i];
      points.push_back({node.name,
                        static_cast<double>(points.size()),
                        numbers_of(places.at(i)),
                        numbers_of(places.turn(i)),
                        {0.0, 0.0, 0.0},
                        support_of(node, in_space)});
    }
    for (const model::DrawnLine& line : mechanism.drawing.lines)
      lines.push_back({static_cast<double>(lines.size() + 1), row_of(line.first, mechanism, places),
                       row_of(line.second, mechanism, places), static_cast<double>(line.kind)});
    for (const model::DrawnJoint& joint : mechanism.drawing.joints)
      joints.push_back({static_cast<double>(joints.size()), static_cast<double>(joint.type),
                        row_of(joint.first, mechanism, places), row_of(joint.second, mechanism, places), joint.axis[0],
                        joint.axis[1], joint.axis[2], static_cast<double>(joint.law),
                        static_cast<double>(joint.limit)});
    for (const model::DrawnShape& shape : mechanism.drawing.shapes)
      shapes.push_back({static_cast<double>(shapes.size() + 1), static_cast<double>(shape.node - 1),
                        static_cast<double>(shape.kind), shape.size[0], shape.size[1], shape.size[2]});
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const Point& point : points) all.push_back(point.name);
    return all;
  }

 private:
  static Support support_of(const model::MechanismNode& node, bool in_space) {
    const auto is_held = [&](std::size_t axis) { return node.place[axis] == ground; };
    if (!is_held(0) || !is_held(1) || (in_space && !is_held(2))) return free_to_move;
    return is_held(5) && (!in_space || (is_held(3) && is_held(4))) ? clamped : pinned;
  }

  /// The row of a point at which a line ends, which is added where it is new.
  double row_of(const model::DrawnPoint& end, const model::Mechanism& mechanism, const Places& places) {
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

void write_joints(const std::string& analysis, const model::MechanismDrawing& drawn, const Drawing& drawing,
                  Sink& sink) {
  if (drawn.joints.empty()) return;
  std::vector<std::string> joints;
  for (const auto& joint : drawn.joints) joints.push_back(joint.name);
  std::vector<std::string> types;
  for (const auto& kind : model::joint_kinds()) types.emplace_back(kind.name);
  const std::vector<std::string> points = drawing.names(), laws{"none", "drive", "spring", "force", "damper"},
                                 limits{"none", "stop", "latch", "both"};
  const auto rows = sink.open({analysis,
                               "joints",
                               "joint",
                               {{"joint", "1", "name of the joint", "", {}, joints},
                                {"type", "1", "its type", "", {}, types},
                                {"first", "1", "point on its first part", "", {}, points},
                                {"second", "1", "point on its second part", "", {}, points},
                                number("axis_x", "1", "axis in the axes of its first part; 0 without one"),
                                number("axis_y", "1", "axis in the axes of its first part; 0 without one"),
                                number("axis_z", "1", "axis in the axes of its first part; 0 without one"),
                                {"law", "1", "what acts on its coordinate", "", {}, laws},
                                {"limit", "1", "kind of its lock", "", {}, limits}},
                               {{"type", "joints"}}});
  for (const auto& row : drawing.joints) rows->append(row);
}

void write_shapes(const std::string& analysis, const Drawing& drawing, Sink& sink) {
  if (drawing.shapes.empty()) return;
  const std::vector<std::string> kinds{"box", "cylinder", "sphere"};
  const auto rows = sink.open({analysis,
                               "shapes",
                               "shape",
                               {number("shape", "1", "number of the shape"),
                                {"body", "1", "node in whose axes it lies", "", {}, drawing.names()},
                                {"kind", "1", "what it is; a cylinder is along z of the body", "", {}, kinds},
                                number("size_x", "m", "size along x of the body"),
                                number("size_y", "m", "size along y of the body"),
                                number("size_z", "m", "size along z of the body")},
                               {{"type", "shapes"}}});
  for (const auto& row : drawing.shapes) rows->append(row);
}

/// @param motion  what the main table tells: "position", or "shape" about the configuration of `numbers`
void write_drawing(const std::string& analysis, const model::Mechanism& mechanism, std::span<const double> numbers,
                   const std::string& motion, Sink& sink) {
  const model::MechanismDrawing& drawn = mechanism.drawing;
  if (drawn.lines.empty() && drawn.joints.empty() && drawn.shapes.empty()) return;
  if (mechanism.nodes.size() > most_drawn_nodes) return;
  const Drawing drawing(mechanism, Places(mechanism, numbers));
  const bool is_shape = motion == "shape";
  const std::string where = is_shape ? " in the configuration of the modes" : " at the start";
  const std::vector<std::string> names = drawing.names();
  std::vector<Block> columns{{"node", "1", "name of the node or point", "", {}, names},
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
  const std::vector<std::string> kinds{"beam", "body", "link", "strut"};
  const auto lines = sink.open({analysis,
                                "lines",
                                "line",
                                {number("line", "1", "number of the line"),
                                 {"first", "1", "node where it begins", "", {}, names},
                                 {"second", "1", "node where it ends", "", {}, names},
                                 {"kind", "1", "what it is", "", {}, kinds}},
                                {{"type", "lines"}}});
  for (const auto& row : drawing.lines) lines->append(row);
  write_joints(analysis, drawn, drawing, sink);
  write_shapes(analysis, drawing, sink);
}

}  // namespace

void write_structure(const std::string& analysis, const model::Mechanism& mechanism, Sink& sink) {
  write_drawing(analysis, mechanism, mechanism.numbers(), "position", sink);
}

void write_configuration(const std::string& analysis, const model::Mechanism& mechanism,
                         std::span<const double> numbers, Sink& sink) {
  write_drawing(analysis, mechanism, numbers, "shape", sink);
}

}  // namespace rubato::results
