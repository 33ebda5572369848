#include <rubato/core/error.hpp>
#include <rubato/report/curves_json.hpp>
#include <rubato/report/json.hpp>
#include <rubato/report/page.hpp>
#include <rubato/report/results_tables.hpp>
#include <rubato/report/scene_json.hpp>
#include <rubato/report/table_json.hpp>
#include <rubato/report/theory_json.hpp>
#include <rubato/report/write_report.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

namespace rubato::report {
namespace {

// The text of the study is shown whole up to here: beyond it the page would outgrow its figures.
constexpr std::size_t longest_study = 1u << 20;

// Shapes of modes are drawn over all their coordinates while these numbers suffice.
constexpr std::size_t most_shape_numbers = 200'000;

bool is_modes(const TableSource& table) {
  const auto& variables = table.variables();
  return std::any_of(variables.begin(), variables.end(), [](const Variable& v) { return v.name == "damping_ratio"; });
}

/// A table that is there for the picture of a structure.
bool is_drawing(const TableSource& table) {
  constexpr std::array<std::string_view, 4> names{"nodes", "lines", "joints", "shapes"};
  return std::find(names.begin(), names.end(), table.name()) != names.end();
}

std::string digest_json(const TableSource& table, const Attributes& analysis) {
  if (is_modes(table)) {
    Extent extent;
    extent.labels = std::max(extent.labels, most_shape_numbers / std::max<std::size_t>(table.rows(), 1));
    return table_json(table, extent);
  }
  if (const auto layout = curve_layout(table, analysis)) return curves_json(table, *layout);
  return table_json(table);
}

std::string analysis_json(const AnalysisTables& analysis) {
  std::string tables;
  for (const auto& table : analysis.tables) {
    if (is_drawing(*table)) continue;  // the scene holds what it says
    tables += (tables.empty() ? "" : ",") + digest_json(*table, analysis.attributes);
  }
  return fmt::format(R"({{"name":{},"attributes":{},"scene":{},"tables":[{}]}})", json_string(analysis.name),
                     attributes_json(analysis.attributes), scene_json(read_scene(analysis)), tables);
}

/// Writes beside `file` and moves it there, so that a full disk leaves what was there before.
void replace_file(const std::filesystem::path& file, std::string_view content) {
  const std::filesystem::path partial = file.string() + ".partial";
  const auto fail = [&](const std::string& reason) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw OutputError(fmt::format("cannot write {}: {}", file.string(), reason));
  };
  std::FILE* stream = std::fopen(partial.c_str(), "wb");
  if (stream == nullptr) fail(std::strerror(errno));
  bool is_written = std::fwrite(content.data(), 1, content.size(), stream) == content.size();
  int reason = errno;
  // A full disk may be heard of only when the buffers are emptied.
  if (std::fclose(stream) != 0 && is_written) {
    is_written = false;
    reason = errno;
  }
  if (!is_written) fail(std::strerror(reason));
  std::error_code error;
  std::filesystem::rename(partial, file, error);
  if (error) fail(error.message());
}

}  // namespace

void write_report(const std::filesystem::path& results_nc, const std::filesystem::path& html) {
  const ResultsTables results(results_nc);
  std::string title = results_nc.filename().string(), analyses;
  for (const auto& [name, value] : results.attributes()) {
    if (name == "title" && !value.empty()) title = value;
  }
  for (const AnalysisTables& analysis : results.analyses()) {
    analyses += (analyses.empty() ? "" : ",\n") + analysis_json(analysis);
  }
  const std::string data = fmt::format("{{\"results_file\":{},\"attributes\":{},\"theory\":{},\"analyses\":[\n{}]}}",
                                       json_string(results_nc.filename().string()),
                                       attributes_json(results.attributes(), longest_study), theory_json(), analyses);
  replace_file(html, html_page(title, data));
}

}  // namespace rubato::report
