#pragma once

#include <rubato/results/sink.hpp>

#include <filesystem>
#include <string>
#include <vector>

// A results file as a run leaves it, made without the analyses.
namespace rubato::test {

/// Appends a whole table.
/// @param rows  [rows][row_width]
void add_table(results::Sink& sink, const results::TableLayout& layout, const std::vector<std::vector<double>>& rows);

/// A study of every analysis that there is: the under-platform damper (12,001 rows), one mass with a slider (whole), a
/// method study, responses, a damper curve, modes, an analysis that failed, and one of a kind that the report does not
/// know, with hostile names.
void write_sample_results(const std::filesystem::path& file);

}  // namespace rubato::test
