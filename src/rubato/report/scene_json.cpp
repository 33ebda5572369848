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

}  // namespace

std::string scene_json(const std::optional<Scene>& scene) {
  if (!scene) return "null";
  const auto &position = scene->position, &rotation = scene->rotation;
  return fmt::format(
      R"({{"names":{},"position":[{},{},{}],"support":{},"lines":[{},{}],"kinds":{},"is_absolute":{},"carrier":{},)"
      R"("offset":[{},{},{}],"rotation":[{},{},{}],"places":[{},{}],)"
      R"("rows":{},"coordinate":{},"values":{},"imaginary":{}}})",
      json_strings(scene->names), json_numbers(position[0]), json_numbers(position[1]), json_numbers(position[2]),
      json_strings(scene->support), json_numbers(scene->first), json_numbers(scene->second), json_strings(scene->kinds),
      scene->is_absolute, json_numbers(scene->carrier), json_numbers(scene->offset_x), json_numbers(scene->offset_y),
      json_numbers(scene->offset_z), json_numbers(rotation[0]), json_numbers(rotation[1]), json_numbers(rotation[2]),
      integers_json(scene->place_node), integers_json(scene->place_axis), integers_json(scene->rows),
      json_numbers(scene->coordinate, coordinate_digits), frames_json(scene->values),
      scene->imaginary.empty() ? "null" : frames_json(scene->imaginary));
}

}  // namespace rubato::report
