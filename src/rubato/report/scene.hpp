#pragma once

#include <rubato/report/results_tables.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace rubato::report {

/// The joints of a mechanism, for their symbols. Words and values as of the table `joints`.
struct SceneJoints {
  std::vector<std::string> names, types, laws, limits;
  std::vector<double> first, second;        ///< nodes of the scene
  std::array<std::vector<double>, 3> axis;  ///< in the axes of the node that carries the first [-]; 0 without one
};

/// Bodies of simple shapes.
struct SceneShapes {
  std::vector<double> node;  ///< in whose axes each lies
  std::vector<std::string> kinds;
  std::array<std::vector<double>, 3> size;  ///< along its axes [m]
};

/// A structure and how it moves.
struct Scene {
  std::vector<std::string> names;               ///< of the nodes, [p]
  std::array<std::vector<double>, 3> position;  ///< reference positions along x, y and z, [p] each [m]
  std::vector<std::string> support;             ///< "free", "held", "pinned", "clamped", [p] or empty
  std::vector<double> first, second;            ///< nodes that each line joins, [lines]
  /// Points that a node carries: its number (their own, or -1 where nothing does), and their place in its axes, [p]
  /// each [m]; empty where every node moves by itself.
  std::vector<double> carrier, offset_x, offset_y, offset_z;
  /// Rotation vectors of the axes of the nodes in the configuration about which shapes are told, [p] each [rad]:
  /// rotations of nodes are then about these axes. Empty where they are those of the world.
  std::array<std::vector<double>, 3> rotation;
  std::vector<std::string> kinds;  ///< of the lines, or empty
  SceneJoints joints;              ///< of a mechanism, or empty
  SceneShapes shapes;              ///< likewise
  bool is_absolute = false;        ///< the values are positions instead of displacements

  /// The degrees of freedom that the results hold: axes 0 to 2 are along x, y, z, 3 to 5 rotations about them. [d]
  std::vector<std::size_t> place_node, place_axis;
  std::vector<std::size_t> rows;               ///< of the main table, one a frame
  std::vector<double> coordinate;              ///< their time [s]; of modes and static states a number
  std::vector<std::vector<double>> values;     ///< [frames][d]
  std::vector<std::vector<double>> imaginary;  ///< likewise, of complex modes; else empty
};

/// How much of the motion is read.
struct SceneExtent {
  std::size_t frames = 300;       ///< at most, evenly spread over time; of modes the first so many
  std::size_t numbers = 250'000;  ///< at most, over all frames
};

/// The scene of an analysis, from its tables `nodes` and `lines`, where there are any `joints` and `shapes`, and its
/// main table. Nothing for analyses without such
/// tables, and where not every degree of freedom (attribute `degrees_of_freedom` of `nodes`) was kept.
std::optional<Scene> read_scene(const AnalysisTables& analysis, const SceneExtent& extent = {});

}  // namespace rubato::report
