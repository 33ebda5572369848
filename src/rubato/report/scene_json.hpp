#pragma once

#include <rubato/report/results_tables.hpp>

#include <string>

namespace rubato::report {

/// How much of the motion of a structure goes into a report.
struct SceneExtent {
  std::size_t frames = 300;       ///< at most, evenly spread over time; of modes the first so many
  std::size_t numbers = 250'000;  ///< at most, over all frames
};

/// A structure and how it moves, from the tables `nodes` and `lines` of an analysis and its main table, as JSON:
///
///   {"names": [node, ...], "position": [[x, ...], [y, ...], [z, ...]], "support": ["free", ...],
///    "lines": [[first node, ...], [second node, ...]], "kinds": ["beam", ...] or null, "is_absolute": bool,
///    "places": [[node, ...], [axis, ...]], "rows": [row of the main table, ...], "coordinate": [its time, ...],
///    "values": [[a number a place], ...], "imaginary": null or likewise}
///
/// Places are the degrees of freedom that the results hold: axes 0 to 2 are displacements along x, y, z (positions,
/// where `is_absolute`), 3 to 5 rotations about them. "null" for analyses without such tables, and
/// where not every degree of freedom (attribute `degrees_of_freedom` of `nodes`) was kept.
std::string scene_json(const AnalysisTables& analysis, const SceneExtent& extent = {});

}  // namespace rubato::report
