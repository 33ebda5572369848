#pragma once

#include <rubato/integrate/kinds/system_kind.hpp>
#include <rubato/results/sink.hpp>

#include <string>

namespace rubato::results {

/// Writes what a picture of a mechanism needs beside positions: see write_structure(). Nothing of structures, which are
/// drawn from their model.
void draw_start(const std::string& analysis, const integrate::SystemKind& kind, Sink& sink);

/// The same beside modes: small motions about the configuration of a state.
void draw_configuration(const std::string& analysis, const integrate::SystemKind& kind, const system::State& state,
                        Sink& sink);

}  // namespace rubato::results
