#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::io {

using namespace model;

ValuesDescription to_values(TomlReader& reader, const toml::node& node, const std::string& key) {
  ValuesDescription values;
  values.where = reader.location(node);
  if (const auto* list = node.as_array()) {
    if (list->empty()) reader.refuse_type(node, key, "a list of numbers");
    for (const toml::node& entry : *list) values.list.push_back(reader.to_quantity(entry, key));
    return values;
  }
  const auto* table = node.as_table();
  if (!table) reader.refuse_type(node, key, "a list of numbers, or a range such as { from = 1, to = 2, points = 11 }");
  TomlReader range(*table, reader.what() + ": " + key, reader.file());
  values.from = range.quantity("from");
  values.to = range.quantity("to");
  values.points = range.quantity("points");
  values.logarithmic = range.optional_word("spacing", {"linear", "log"}).value_or("linear") == "log";
  range.finish();
  return values;
}

namespace {

/// toml++ sorts keys; sweeps keep the order of the file.
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

DistributionDescription read_distribution(TomlReader& reader, const std::string& parameter, const toml::node& node) {
  const auto* table = node.as_table();
  if (!table)
    reader.refuse_type(node, parameter,
                       "a distribution, such as { distribution = \"normal\", mean = 1.0, deviation = 0.1 }");
  TomlReader inner(*table, reader.what() + ": " + parameter, reader.file());
  DistributionDescription distribution;
  distribution.parameter = parameter;
  distribution.where = inner.where();
  const std::string kind = inner.text("distribution");
  (void)inner.optional_word("distribution", {"normal", "uniform", "lognormal"});
  if (kind == "uniform") {
    distribution.kind = DistributionDescription::Kind::uniform;
    distribution.first = inner.quantity("from");
    distribution.second = inner.quantity("to");
  } else {
    const bool is_normal = kind == "normal";
    distribution.kind = is_normal ? DistributionDescription::Kind::normal : DistributionDescription::Kind::lognormal;
    distribution.first = is_normal ? inner.quantity("mean") : inner.quantity("median");
    distribution.second = inner.quantity("deviation");
  }
  inner.finish();
  return distribution;
}

RandomSweepDescription read_random_sweep(TomlReader& reader) {
  using Sampling = RandomSweepDescription::Sampling;
  RandomSweepDescription sweep;
  sweep.where = reader.where();
  sweep.samples = reader.quantity("samples");
  sweep.seed = reader.optional_integer("seed").value_or(1);
  const std::string sampling =
      reader.optional_word("sampling", {"latin_hypercube", "sobol", "random"}).value_or("latin_hypercube");
  sweep.sampling = sampling == "random"  ? Sampling::random
                   : sampling == "sobol" ? Sampling::sobol
                                         : Sampling::latin_hypercube;
  if (!reader.has("parameters")) {
    reader.refuse_misspelling_of("parameters");
    throw InvalidInput(reader.where(),
                       fmt::format("{}: samples need \"parameters\", a distribution for each", reader.what()));
  }
  auto parameters = reader.optional_table("parameters", reader.what() + ": parameters");
  const auto* table = reader.node("parameters")->as_table();
  for (const auto& [name, node] : in_order_of_the_file(*table))
    sweep.parameters.push_back(read_distribution(*parameters, name, *node));
  if (sweep.parameters.empty())
    throw InvalidInput(parameters->where(), fmt::format("{}: parameters is empty", reader.what()));
  reader.finish();
  return sweep;
}

}  // namespace

SweepDescription read_sweep(TomlReader& reader, const StudyFolder& folder) {
  auto sweep = reader.optional_table("sweep", reader.what() + ": sweep");
  if (!sweep) return std::monostate{};
  const toml::table& table = *reader.node("sweep")->as_table();
  // Lists are the values of parameters, which may be called "file" and "samples" too.
  if (const toml::node* file = table.get("file"); file && file->is_string()) {
    const std::string name = sweep->text("file");
    sweep->finish();
    return read_cases(name, folder, sweep->where("file"));
  }
  if (const toml::node* samples = table.get("samples"); samples && !samples->is_array() && !samples->is_table())
    return read_random_sweep(*sweep);
  GridSweepDescription grid;
  for (const auto& [name, node] : in_order_of_the_file(table))
    grid.parameters.emplace_back(name, to_values(*sweep, *node, name));
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
