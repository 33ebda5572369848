#include <rubato/report/json.hpp>
#include <rubato/report/table_pieces.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>

namespace rubato::report {
namespace {

/// 0: a coordinate or a joint, 1: a degree of freedom of a node, 2: of a node within a beam.
int rank_of(std::string_view label) {
  const std::size_t dot = label.rfind('.');
  if (dot == std::string_view::npos) return 0;
  const std::string_view axis = label.substr(dot + 1), node = label.substr(0, dot);
  constexpr std::array<std::string_view, 6> axes{"x", "y", "z", "rx", "ry", "rz"};
  if (std::find(axes.begin(), axes.end(), axis) == axes.end()) return 0;
  const std::size_t colon = node.rfind(':');
  const bool is_inner = colon != std::string_view::npos && colon + 1 < node.size() &&
                        node.find_first_not_of("0123456789", colon + 1) == std::string_view::npos;
  return is_inner ? 2 : 1;
}

}  // namespace

std::string columns_json(const Columns& columns, int digits) {
  std::string out = "[";
  for (const auto& column : columns) out += (out.size() > 1 ? "," : "") + json_numbers(column, digits);
  return out + ']';
}

std::string variable_json(const Variable& variable, std::span<const std::size_t> labels) {
  std::vector<std::string> shown;
  if (!variable.dimension.empty())
    for (const std::size_t label : labels) shown.push_back(variable.labels[label]);
  return fmt::format(
      R"({{"name":{},"unit":{},"description":{},"dimension":{},"labels":{},"label_count":{},"categories":{}}})",
      json_string(variable.name), json_string(variable.unit), json_string(variable.description),
      json_string(variable.dimension), json_strings(shown), variable.labels.size(), json_strings(variable.categories));
}

std::string variable_json(const Variable& variable, std::size_t labels) {
  std::vector<std::size_t> places(labels);
  std::iota(places.begin(), places.end(), std::size_t{0});
  return variable_json(variable, places);
}

std::vector<std::size_t> shown_labels(const Variable& variable, std::size_t most) {
  std::vector<std::size_t> places(variable.width());
  std::iota(places.begin(), places.end(), std::size_t{0});
  if (places.size() <= most) return places;
  std::vector<int> rank;
  for (const std::string& label : variable.labels) rank.push_back(rank_of(label));
  std::stable_sort(places.begin(), places.end(), [&](std::size_t a, std::size_t b) { return rank[a] < rank[b]; });
  places.resize(most);
  std::sort(places.begin(), places.end());
  return places;
}

}  // namespace rubato::report
