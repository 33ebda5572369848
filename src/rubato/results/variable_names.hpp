#pragma once

#include <rubato/results/sink.hpp>

#include <string>
#include <vector>

namespace rubato::results {

/// The names of the variables of a table, one a block, each once: where a name is taken (sliders and stops both have a
/// `force`), or is that of a dimension, the block's own dimension comes before it: `stop_force`. Blocks without labels
/// take no name.
std::vector<std::string> variable_names(const TableLayout& layout);

}  // namespace rubato::results
