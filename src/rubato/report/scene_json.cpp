#include <rubato/report/json.hpp>
#include <rubato/report/scene_json.hpp>
#include <rubato/report/table_pieces.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace rubato::report {
namespace {

std::string integers_json(const std::vector<std::size_t>& values) {
  return fmt::format("[{}]", fmt::join(values, ","));
}

std::string frames_json(const std::vector<std::vector<double>>& frames) {
  std::string all = "[";
  for (const auto& values : frames) all += (all.size() > 1 ? "," : "") + json_numbers(values, 5);
  return all + ']';
}

std::string vector_json(const std::array<std::vector<double>, 3>& components) {
  return fmt::format("[{},{},{}]", json_numbers(components[0]), json_numbers(components[1]),
                     json_numbers(components[2]));
}

std::string joints_json(const SceneJoints& joints) {
  return fmt::format(R"({{"names":{},"types":{},"first":{},"second":{},"axis":{},"laws":{},"limits":{}}})",
                     json_strings(joints.names), json_strings(joints.types), json_numbers(joints.first),
                     json_numbers(joints.second), vector_json(joints.axis), json_strings(joints.laws),
                     json_strings(joints.limits));
}

std::string shapes_json(const SceneShapes& shapes) {
  return fmt::format(R"({{"nodes":{},"kinds":{},"size":{}}})", json_numbers(shapes.node), json_strings(shapes.kinds),
                     vector_json(shapes.size));
}

}  // namespace

std::string scene_json(const std::optional<Scene>& scene) {
  if (!scene) return "null";
  return fmt::format(
      R"({{"names":{},"position":{},"support":{},"lines":[{},{}],"kinds":{},"is_absolute":{},"carrier":{},)"
      R"("offset":[{},{},{}],"rotation":{},"places":[{},{}],"joints":{},"shapes":{},)"
      R"("rows":{},"coordinate":{},"values":{},"imaginary":{}}})",
      json_strings(scene->names), vector_json(scene->position), json_strings(scene->support),
      json_numbers(scene->first), json_numbers(scene->second), json_strings(scene->kinds), scene->is_absolute,
      json_numbers(scene->carrier), json_numbers(scene->offset_x), json_numbers(scene->offset_y),
      json_numbers(scene->offset_z), vector_json(scene->rotation), integers_json(scene->place_node),
      integers_json(scene->place_axis), joints_json(scene->joints), shapes_json(scene->shapes),
      integers_json(scene->rows), json_numbers(scene->coordinate, coordinate_digits), frames_json(scene->values),
      scene->imaginary.empty() ? "null" : frames_json(scene->imaginary));
}

}  // namespace rubato::report
