#pragma once

#include <rubato/model/mechanism.hpp>
#include <rubato/results/sink.hpp>

#include <span>
#include <string>

namespace rubato::results {

/// Writes beside the results of an analysis what a picture of the mechanism needs; nothing beyond most_drawn_nodes.
///
/// `nodes`: nodes, and the points of bodies and of the ground at which lines and joints end, each with the node that
/// carries it (`carrier`, a row; itself, or -1 for the ground) and its place there (`offset_x`, `offset_y` [m], in the
/// axes of that node). `lines`: of the kinds beam, body, link and strut. `joints`: type, the points `first` and
/// `second`, the axis in the axes of the node that carries the first, `law` and `limit`. `shapes`: of bodies, with the
/// box around each [m]. The last two are written where there are any. The main table tells positions.
void write_structure(const std::string& analysis, const model::Mechanism& mechanism, Sink& sink);

/// Likewise beside the modes of a mechanism, whose main table tells shapes: small motions about the configuration with
/// these numbers, where the positions are, with the rotation vectors of the axes there (`rotation_x` and so on [rad]).
/// @param numbers  of all nodes, the ground first: a configuration q, of which what follows is not read
void write_configuration(const std::string& analysis, const model::Mechanism& mechanism,
                         std::span<const double> numbers, Sink& sink);

}  // namespace rubato::results
