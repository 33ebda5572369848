#pragma once

#include <rubato/report/scene.hpp>

#include <string>

namespace rubato::report {

/// A scene as JSON, "null" for none:
///
///   {"names": [node, ...], "position": [[x, ...], [y, ...], [z, ...]], "support": ["free", ...],
///    "lines": [[first node, ...], [second node, ...]], "kinds": ["beam", ...], "is_absolute": bool,
///    "carrier": [node, ...], "offset": [[x, ...], [y, ...], [z, ...]], "rotation": likewise,
///    "places": [[node, ...], [axis, ...]], "rows": [row of the main table, ...], "coordinate": [its time, ...],
///    "values": [[a number a place], ...], "imaginary": null or likewise}
std::string scene_json(const std::optional<Scene>& scene);

}  // namespace rubato::report
