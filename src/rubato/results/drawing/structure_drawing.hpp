#pragma once

#include <rubato/model/structure.hpp>
#include <rubato/results/sink.hpp>

#include <string>

namespace rubato::results {

/// Larger structures are not drawn by the report, and their tables would be longer than what they explain.
inline constexpr std::size_t most_drawn_nodes = 20'000;

/// Writes the tables `nodes` (name, reference position [m], support) and `lines` (the nodes that each element joins)
/// beside the results of an analysis: what a picture of the structure needs. Writes nothing without elements or beyond
/// most_drawn_nodes.
void write_structure(const std::string& analysis, const model::Structure& structure, Sink& sink);

}  // namespace rubato::results
