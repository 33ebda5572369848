#include <rubato/io/reading_visitor.hpp>
#include <rubato/model/fields/sweep_fields.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::io {

using namespace model;

ValuesDescription to_values(TomlReader& reader, const toml::node& node, const std::string& key,
                            const StudyFolder& folder) {
  ValuesDescription values;
  values.where = reader.location(node);
  if (const auto* list = node.as_array()) {
    if (list->empty()) reader.refuse_type(node, key, "a list of numbers");
    for (const toml::node& entry : *list) values.list.push_back(reader.to_quantity(entry, key));
    return values;
  }
  const auto* table = node.as_table();
  if (!table) reader.refuse_type(node, key, "a list of numbers, or a range such as { from = 1, to = 2, points = 11 }");
  TomlReader range(*table, reader.name_of_part(key), reader.file());
  ReadingVisitor(range, folder).read(values);
  return values;
}

std::vector<std::pair<std::string, const toml::node*>> in_order_of_the_file(const toml::table& table) {
  std::vector<std::pair<std::string, const toml::node*>> entries;
  std::vector<std::pair<toml::source_position, std::size_t>> order;
  for (const auto& [key, value] : table) {
    order.emplace_back(key.source().begin, entries.size());
    entries.emplace_back(std::string(key.str()), &value);
  }
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first.line, a.first.column) < std::pair(b.first.line, b.first.column);
  });
  std::vector<std::pair<std::string, const toml::node*>> sorted;
  for (const auto& [place, index] : order) sorted.push_back(entries[index]);
  return sorted;
}

SweepDescription read_sweep(TomlReader& reader, const std::string& key, const StudyFolder& folder) {
  auto sweep = reader.optional_table(key, reader.name_of_part(key));
  if (!sweep) return std::monostate{};
  const toml::table& table = *reader.node(key)->as_table();
  // Lists are the values of parameters, which may be called "file" and "samples" too.
  if (const toml::node* file = table.get("file"); file && file->is_string()) {
    CaseSweepDescription cases;
    ReadingVisitor(*sweep, folder).read(cases);
    return read_cases(cases.file, folder, cases.where);
  }
  if (const toml::node* samples = table.get("samples"); samples && !samples->is_array() && !samples->is_table()) {
    RandomSweepDescription random;
    ReadingVisitor(*sweep, folder).read(random);
    return random;
  }
  GridSweepDescription grid;
  for (const auto& [name, node] : in_order_of_the_file(table))
    grid.parameters.emplace_back(name, to_values(*sweep, *node, name, folder));
  if (grid.parameters.empty())
    throw InvalidInput(sweep->where(), fmt::format("{} is empty; give values such as {{ N0 = [10, 20] }}, or leave it "
                                                   "out",
                                                   sweep->what()));
  return grid;
}

std::string frequency_key(TomlReader& reader) {
  const bool is_in_hertz = reader.has("frequency");
  const bool is_angular = reader.node("angular_frequency") != nullptr;
  if (is_angular && is_in_hertz)
    throw InvalidInput(
        reader.where("frequency"),
        fmt::format("{}: \"angular_frequency\" and \"frequency\" say the same; keep one of them", reader.what()));
  if (!is_angular && !is_in_hertz) {
    reader.refuse_misspelling_of("angular_frequency");
    throw InvalidInput(
        reader.where(),
        fmt::format("{} lacks the key \"angular_frequency\" [rad/s] (or \"frequency\" [Hz])", reader.what()));
  }
  return is_in_hertz ? "frequency" : "angular_frequency";
}

}  // namespace rubato::io
