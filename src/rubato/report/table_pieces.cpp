#include <rubato/report/json.hpp>
#include <rubato/report/table_pieces.hpp>

#include <fmt/format.h>

namespace rubato::report {

std::string columns_json(const Columns& columns, int digits) {
  std::string out = "[";
  for (const auto& column : columns) out += (out.size() > 1 ? "," : "") + json_numbers(column, digits);
  return out + ']';
}

std::string variable_json(const Variable& variable, std::size_t labels) {
  const std::span<const std::string> shown(variable.labels.data(), variable.dimension.empty() ? 0 : labels);
  return fmt::format(
      R"({{"name":{},"unit":{},"description":{},"dimension":{},"labels":{},"label_count":{},"categories":{}}})",
      json_string(variable.name), json_string(variable.unit), json_string(variable.description),
      json_string(variable.dimension), json_strings(shown), variable.labels.size(), json_strings(variable.categories));
}

}  // namespace rubato::report
