#pragma once

#include <rubato/io/toml_reader.hpp>

namespace rubato::io {

/// The table of an automatic step: step = { tolerance = 1e-3, controller = "pi", ... }.
/// @param table  what stands behind `step`
model::StepDescription read_step(const TomlReader& analysis, const toml::table& table);

}  // namespace rubato::io
