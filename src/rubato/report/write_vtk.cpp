#include <rubato/core/error.hpp>
#include <rubato/numerics/rotations.hpp>
#include <rubato/report/json.hpp>
#include <rubato/report/scene.hpp>
#include <rubato/report/write_vtk.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

namespace rubato::report {
namespace {

constexpr SceneExtent extent{2000, std::numeric_limits<std::size_t>::max()};

constexpr std::string_view header = "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\">\n";

void write_file(const std::filesystem::path& file, const std::string& text) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw OutputError(fmt::format("cannot write {}: {}", file.string(), std::strerror(errno)));
}

std::string array(std::string_view type, std::string_view name, int components, const std::string& numbers) {
  return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n{}</DataArray>\n",
                     type, name, components, numbers);
}

/// Lines: pairs of nodes, and where each pair ends.
std::string lines_of(const Scene& scene) {
  std::string pairs, ends;
  for (std::size_t i = 0; i < scene.first.size(); ++i) {
    fmt::format_to(std::back_inserter(pairs), "{:.0f} {:.0f}\n", scene.first[i], scene.second[i]);
    fmt::format_to(std::back_inserter(ends), "{}\n", 2 * (i + 1));
  }
  return "<Lines>\n" + array("Int64", "connectivity", 1, pairs) + array("Int64", "offsets", 1, ends) + "</Lines>\n";
}

std::string frame_of(const Scene& scene, const std::vector<double>& values, const std::string& lines) {
  const std::size_t nodes = scene.names.size();
  std::vector<std::array<double, 6>> motion(nodes, std::array<double, 6>{});
  if (scene.is_absolute)
    for (std::size_t node = 0; node < nodes; ++node)
      for (std::size_t axis = 0; axis < 3; ++axis) motion[node][axis] = scene.position[axis][node];
  for (std::size_t place = 0; place < values.size(); ++place)
    motion[scene.place_node[place]][scene.place_axis[place]] = values[place];
  const auto& axes = scene.rotation;
  for (std::size_t node = 0; node < axes[0].size(); ++node) {  // a shape is told in the axes of the nodes
    auto& own = motion[node];
    const numerics::Vector3 turn = numerics::rotation_of({axes[0][node], axes[1][node], axes[2][node]}) *
                                   numerics::Vector3(own[3], own[4], own[5]);
    std::copy(turn.begin(), turn.end(), own.begin() + 3);
  }
  for (std::size_t node = 0; node < scene.carrier.size(); ++node) {
    if (scene.carrier[node] < 0.0 || scene.carrier[node] == static_cast<double>(node)) continue;
    const auto number = static_cast<std::size_t>(scene.carrier[node]);
    const std::array<double, 6>& carrier = motion[number];
    const numerics::Vector3 turn(carrier[3], carrier[4], carrier[5]);
    const numerics::Vector3 offset(scene.offset_x[node], scene.offset_y[node], scene.offset_z[node]);
    const auto& at = scene.position;
    const numerics::Vector3 arm(at[0][node] - at[0][number], at[1][node] - at[1][number], at[2][node] - at[2][number]);
    const numerics::Vector3 moved =
        scene.is_absolute ? numerics::Vector3(numerics::rotation_of(turn) * offset) : turn.cross(arm);
    motion[node] = {carrier[0] + moved[0], carrier[1] + moved[1], carrier[2] + moved[2], turn[0], turn[1], turn[2]};
  }
  std::string points, displacements, rotations;
  for (std::size_t node = 0; node < nodes; ++node) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double reference = scene.position[axis][node], moved = motion[node][axis];
      const double displacement = scene.is_absolute ? moved - reference : moved;
      const char* end = axis < 2 ? " " : "\n";
      fmt::format_to(std::back_inserter(points), "{:.10g}{}", reference + displacement, end);
      fmt::format_to(std::back_inserter(displacements), "{:.10g}{}", displacement, end);
      fmt::format_to(std::back_inserter(rotations), "{:.10g}{}", motion[node][3 + axis], end);
    }
  }
  return fmt::format(header, "PolyData") +
         fmt::format("<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfLines=\"{}\">\n", nodes, scene.first.size()) +
         "<PointData Vectors=\"displacement\">\n" + array("Float64", "displacement", 3, displacements) +
         array("Float64", "rotation", 3, rotations) + "</PointData>\n<Points>\n" +
         array("Float64", "points", 3, points) + "</Points>\n" + lines + "</Piece>\n</PolyData>\n</VTKFile>\n";
}

void write_scene(const std::string& name, const Scene& scene, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder / name, error);
  if (error) throw OutputError(fmt::format("cannot make {}: {}", (folder / name).string(), error.message()));
  const std::string lines = lines_of(scene);
  std::string list = fmt::format(header, "Collection") + "<Collection>\n";
  for (std::size_t i = 0; i < scene.values.size(); ++i) {
    const std::string file = fmt::format("{}/{:04}.vtp", name, i);
    write_file(folder / file, frame_of(scene, scene.values[i], lines));
    list += fmt::format("<DataSet timestep=\"{}\" file=\"{}\"/>\n", scene.coordinate[i], html_text(file));
  }
  write_file(folder / (name + ".pvd"), list + "</Collection>\n</VTKFile>\n");
}

}  // namespace

int write_vtk(const std::filesystem::path& results_nc, const std::filesystem::path& folder) {
  const ResultsTables results(results_nc);
  int count = 0;
  for (const AnalysisTables& analysis : results.analyses()) {
    const auto scene = read_scene(analysis, extent);
    if (!scene) continue;
    write_scene(analysis.name, *scene, folder);
    ++count;
  }
  return count;
}

}  // namespace rubato::report
