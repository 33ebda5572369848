#pragma once

#include <rubato/model/mechanism.hpp>
#include <rubato/model/structure.hpp>
#include <rubato/results/sink.hpp>

#include <span>
#include <string>

namespace rubato::analysis {

/// Larger structures are not drawn by the report, and their tables would be longer than what they explain.
inline constexpr std::size_t most_drawn_nodes = 20'000;

/// Writes the tables `nodes` (name, reference position [m], support) and `lines` (the nodes that each element joins)
/// beside the results of an analysis: what a picture of the structure needs. Writes nothing without elements or beyond
/// most_drawn_nodes.
void write_structure(const std::string& analysis, const model::Structure& structure, results::Sink& sink);

/// Likewise of a mechanism: its nodes, the points of bodies and of the ground at which lines end, each
/// with the node that carries it (`carrier`, a row; itself, or -1 for the ground) and its place there (`offset_x`,
/// `offset_y` [m], in the axes of that node); and lines of the kinds beam, body and link. The main table tells
/// positions.
void write_structure(const std::string& analysis, const model::Mechanism& mechanism, results::Sink& sink);

/// Likewise beside the modes of a mechanism, whose main table tells shapes: small motions about the configuration with
/// these numbers, where the positions are, with the rotation vectors of the axes there (`rotation_x` and so on [rad]).
/// @param numbers  of all nodes, the ground first: a configuration q, of which what follows is not read
void write_configuration(const std::string& analysis, const model::Mechanism& mechanism,
                         std::span<const double> numbers, results::Sink& sink);

}  // namespace rubato::analysis
