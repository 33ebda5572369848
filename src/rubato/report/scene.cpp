#include <rubato/report/scene.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace rubato::report {
namespace {

constexpr std::array<std::string_view, 6> axis_names{"x", "y", "z", "rx", "ry", "rz"};

const TableSource* find_table(const AnalysisTables& analysis, const std::string& name) {
  for (const auto& table : analysis.tables)
    if (table->name() == name) return table.get();
  return nullptr;
}

std::optional<std::size_t> find_variable(const TableSource& table, const std::string& name) {
  for (std::size_t i = 0; i < table.variables().size(); ++i)
    if (table.variables()[i].name == name) return i;
  return std::nullopt;
}

std::string attribute(const TableSource& table, const std::string& name) {
  for (const auto& [key, value] : table.attributes())
    if (key == name) return value;
  return {};
}

std::vector<double> column(const TableSource& table, std::size_t variable) {
  std::vector<double> values(table.rows());
  if (!values.empty()) table.read(variable, 0, values.size(), 1, values);
  return values;
}

/// A column of words, empty where there is none.
std::vector<std::string> words(const TableSource& table, const std::string& name) {
  std::vector<std::string> all;
  const auto variable = find_variable(table, name);
  if (!variable) return all;
  const auto& known = table.variables()[*variable].categories;
  for (const double value : column(table, *variable)) {
    const bool is_known = value >= 0.0 && value < static_cast<double>(known.size());
    all.push_back(is_known ? known[static_cast<std::size_t>(value)] : "");
  }
  return all;
}

std::vector<double> numbers(const TableSource& table, const std::string& name) {
  const auto variable = find_variable(table, name);
  return variable ? column(table, *variable) : std::vector<double>{};
}

SceneJoints joints_of(const TableSource* table) {
  if (!table) return {};
  return {words(*table, "joint"),
          words(*table, "type"),
          words(*table, "law"),
          words(*table, "limit"),
          numbers(*table, "first"),
          numbers(*table, "second"),
          {numbers(*table, "axis_x"), numbers(*table, "axis_y"), numbers(*table, "axis_z")}};
}

SceneShapes shapes_of(const TableSource* table) {
  if (!table) return {};
  return {numbers(*table, "body"),
          words(*table, "kind"),
          {numbers(*table, "size_x"), numbers(*table, "size_y"), numbers(*table, "size_z")}};
}

/// The columns of the main table that move nodes.
class Motion {
 public:
  Motion(const TableSource& table, const std::vector<std::string>& nodes) : table_(table) {
    for (std::size_t i = 0; i < nodes.size(); ++i) numbers_.emplace(nodes[i], i);
    for (const char* name : {"position", "angle", "shape", "angle_shape"}) take(name);
  }

  bool is_empty() const { return node_.empty(); }
  std::size_t size() const { return node_.size(); }
  const std::vector<std::size_t>& nodes() const { return node_; }
  const std::vector<std::size_t>& axes() const { return axis_; }
  bool is_complex() const {
    return std::any_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.imaginary.has_value(); });
  }

  /// The values of all places in a row.
  void read(std::size_t row, bool imaginary, std::vector<double>& values) const {
    values.clear();
    std::vector<double> all;
    for (const Part& part : parts_) {
      const auto variable = imaginary ? part.imaginary : std::optional(part.variable);
      if (!variable) {
        values.resize(values.size() + part.labels.size());
        continue;
      }
      all.resize(table_.variables()[*variable].width());
      table_.read(*variable, row, 1, all.size(), all);
      for (const std::size_t label : part.labels) values.push_back(all[label]);
    }
  }

 private:
  struct Part {
    std::size_t variable;
    std::optional<std::size_t> imaginary;
    std::vector<std::size_t> labels;  ///< those that are degrees of freedom of nodes
  };

  void take(const std::string& name) {
    const auto variable = find_variable(table_, name);
    if (!variable) return;
    Part part{*variable, find_variable(table_, name + "_imaginary"), {}};
    const auto& labels = table_.variables()[*variable].labels;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const std::size_t dot = labels[i].rfind('.');
      if (dot == std::string::npos) continue;
      std::string node = labels[i].substr(0, dot);
      std::replace(node.begin(), node.end(), ' ', '_');  // as netCDF keeps words
      const auto found = numbers_.find(node);
      const auto axis = std::find(axis_names.begin(), axis_names.end(), std::string_view(labels[i]).substr(dot + 1));
      if (found == numbers_.end() || axis == axis_names.end()) continue;
      part.labels.push_back(i);
      node_.push_back(found->second);
      axis_.push_back(static_cast<std::size_t>(axis - axis_names.begin()));
    }
    if (!part.labels.empty()) parts_.push_back(std::move(part));
  }

  const TableSource& table_;
  std::unordered_map<std::string, std::size_t> numbers_;
  std::vector<Part> parts_;
  std::vector<std::size_t> node_, axis_;
};

/// Rows at even distances in time; rows of a table that is not over time as they come.
std::vector<std::size_t> choose_rows(const TableSource& table, const std::vector<double>& times, std::size_t most) {
  std::vector<std::size_t> rows;
  if (table.row_dimension() != "time" || times.size() <= most) {
    for (std::size_t i = 0; i < std::min(times.size(), most); ++i) rows.push_back(i);
    return rows;
  }
  const double first = times.front(), length = times.back() - first;
  for (std::size_t i = 0; i < most; ++i) {
    const double wanted = first + length * static_cast<double>(i) / static_cast<double>(most - 1);
    const auto after = std::lower_bound(times.begin(), times.end(), wanted);
    auto row = static_cast<std::size_t>(std::min(after, times.end() - 1) - times.begin());
    if (row > 0 && wanted - times[row - 1] < times[row] - wanted) --row;
    if (rows.empty() || row > rows.back()) rows.push_back(row);
  }
  return rows;
}

std::vector<std::vector<double>> frames(const Motion& motion, const std::vector<std::size_t>& rows, bool imaginary) {
  std::vector<std::vector<double>> all(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) motion.read(rows[i], imaginary, all[i]);
  return all;
}

}  // namespace

std::optional<Scene> read_scene(const AnalysisTables& analysis, const SceneExtent& extent) {
  const TableSource *nodes = find_table(analysis, "nodes"), *lines = find_table(analysis, "lines"),
                    *main = find_table(analysis, "");
  if (!nodes || !lines || !main || main->rows() == 0) return std::nullopt;
  const auto name = find_variable(*nodes, "node"), first = find_variable(*lines, "first"),
             second = find_variable(*lines, "second");
  if (!name || !first || !second) return std::nullopt;
  Scene scene;
  scene.names = nodes->variables()[*name].categories;
  const Motion motion(*main, scene.names);
  // A structure of which some degrees of freedom are not known would be drawn torn.
  if (motion.is_empty() || attribute(*nodes, "degrees_of_freedom") != std::to_string(motion.size()))
    return std::nullopt;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto variable = find_variable(*nodes, std::string(axis_names[axis]));
    if (!variable) return std::nullopt;
    scene.position[axis] = column(*nodes, *variable);
  }
  for (const auto& [variable, values] :
       {std::pair{"carrier", &scene.carrier}, std::pair{"offset_x", &scene.offset_x},
        std::pair{"offset_y", &scene.offset_y}, std::pair{"offset_z", &scene.offset_z},
        std::pair{"rotation_x", &scene.rotation[0]}, std::pair{"rotation_y", &scene.rotation[1]},
        std::pair{"rotation_z", &scene.rotation[2]}})
    *values = numbers(*nodes, variable);
  scene.support = words(*nodes, "support");
  scene.kinds = words(*lines, "kind");
  scene.first = column(*lines, *first);
  scene.second = column(*lines, *second);
  scene.joints = joints_of(find_table(analysis, "joints"));
  scene.shapes = shapes_of(find_table(analysis, "shapes"));
  scene.is_absolute = attribute(*nodes, "motion") == "position";
  scene.place_node = motion.nodes();
  scene.place_axis = motion.axes();
  const std::size_t most = std::clamp<std::size_t>(extent.numbers / motion.size(), 2, extent.frames);
  const std::vector<double> times = column(*main, 0);
  scene.rows = choose_rows(*main, times, most);
  for (const std::size_t row : scene.rows) scene.coordinate.push_back(times[row]);
  scene.values = frames(motion, scene.rows, false);
  if (motion.is_complex()) scene.imaginary = frames(motion, scene.rows, true);
  return scene;
}

}  // namespace rubato::report
