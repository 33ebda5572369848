#include <rubato/core/excerpt.hpp>
#include <rubato/io/schema.hpp>
#include <rubato/io/toml_reader.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace rubato::io {
namespace {

std::string value_found(const toml::node& node) {
  if (const auto* text = node.as_string()) return fmt::format("the text \"{}\"", excerpt(text->get()));
  if (const auto* number = node.as_integer()) return fmt::format("the number {}", number->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("the number {}", number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* list = node.as_array())
    return list->empty() ? "an empty list" : fmt::format("a list of {}", list->size());
  if (node.is_table()) return "a table";
  return "a date";
}

/// As suggestion(), with every name: which keys and words there are cannot be guessed.
std::string whole_suggestion(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  if (nearest.empty()) return fmt::format("; known: {}", fmt::join(known, ", "));
  return fmt::format("; did you mean \"{}\"? (known: {})", nearest, fmt::join(known, ", "));
}

/// Whether the study itself has a key of this name, with such a value: a table, or a list of tables.
bool is_part_of_the_study(const std::string& name, const toml::node& value) {
  const std::vector<std::string>& keys = study_keys();
  const auto* list = value.as_array();
  const bool is_list = list && !list->empty() && list->front().is_table();
  return (value.is_table() || is_list) && std::find(keys.begin(), keys.end(), name) != keys.end();
}

}  // namespace

TomlReader::TomlReader(const toml::table& table, std::string what, std::string file)
    : table_(table), what_(std::move(what)), file_(std::move(file)) {}

Location TomlReader::location(const toml::node& node) const {
  const auto& begin = node.source().begin;
  return {file_, static_cast<int>(begin.line), static_cast<int>(begin.column)};
}

Location TomlReader::location(const toml::key& key) const {
  const auto& begin = key.source().begin;
  return {file_, static_cast<int>(begin.line), static_cast<int>(begin.column)};
}

Location TomlReader::where(const std::string& key) const {
  const toml::node* found = table_.get(key);
  return found ? location(*found) : where();
}

const toml::node* TomlReader::node(const std::string& key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  return table_.get(key);
}

bool TomlReader::has(const std::string& key) { return node(key) != nullptr; }

const toml::node& TomlReader::required(const std::string& key) {
  const toml::node* found = node(key);
  if (found) return *found;
  refuse_to_lack(key);
}

void TomlReader::refuse_to_lack(const std::string& key, const std::string& rest) const {
  refuse_misspelling_of(key);
  throw InvalidInput(where(), fmt::format("{} lacks the key \"{}\"{}", what_, key, rest));
}

std::string TomlReader::name_of_part(const std::string& key) const {
  return what_ == "the study" ? fmt::format("[{}]", key) : fmt::format("{}: {}", what_, key);
}

void TomlReader::refuse_misspelling_of(const std::string& key) const {
  for (const auto& [present, value] : table_) {
    const std::string name(present.str());
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    const bool has_its_begin = name.starts_with(key + "_") || (name.size() >= 3 && key.starts_with(name));
    if (!has_its_begin && nearest_name(name, std::vector<std::string>{key}).empty()) continue;
    throw InvalidInput(location(present), fmt::format("{} has no key \"{}\"; did you mean \"{}\"?", what_, name, key));
  }
}

void TomlReader::refuse_beside(const std::string& chosen, const std::vector<std::string>& keys) {
  for (const std::string& key : keys)
    if (has(key))
      throw InvalidInput(location(table_.find(key)->first),
                         fmt::format("{}: \"{}\" does not go with \"{}\"; keep one of them", what_, key, chosen));
}

void TomlReader::refuse_type(const toml::node& node, const std::string& key, const std::string& expected) const {
  throw InvalidInput(location(node), fmt::format("{}: {} must be {}, got {}", what_, key, expected, value_found(node)));
}

std::string TomlReader::text(const std::string& key) {
  const toml::node& found = required(key);
  if (!found.is_string()) refuse_type(found, key, "a text in quotes");
  return found.as_string()->get();
}

std::optional<std::string> TomlReader::optional_text(const std::string& key) {
  if (!has(key)) return std::nullopt;
  return text(key);
}

std::optional<std::string> TomlReader::optional_word(const std::string& key, const std::vector<std::string>& words) {
  auto word = optional_text(key);
  if (word && std::find(words.begin(), words.end(), *word) == words.end())
    throw InvalidInput(where(key),
                       fmt::format("{}: {} cannot be \"{}\"{}", what_, key, *word, whole_suggestion(*word, words)));
  return word;
}

model::Quantity TomlReader::to_quantity(const toml::node& node, const std::string& key) const {
  model::Quantity quantity;
  if (const auto* number = node.as_integer())
    quantity.value = static_cast<double>(number->get());
  else if (const auto* real = node.as_floating_point())
    quantity.value = real->get();
  else if (const auto* formula = node.as_string())
    quantity.expression = formula->get();
  else
    refuse_type(node, key, "a number or an expression in quotes");
  quantity.where = location(node);
  if (node.is_string() && quantity.expression.find_first_not_of(" \t\n") == std::string::npos)
    throw InvalidInput(quantity.where,
                       fmt::format("{}: {} is an empty expression; give a number or a formula", what_, key));
  return quantity;
}

model::Quantity TomlReader::quantity(const std::string& key) { return to_quantity(required(key), key); }

std::optional<model::Quantity> TomlReader::optional_quantity(const std::string& key) {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  return to_quantity(*found, key);
}

std::optional<std::vector<model::Quantity>> TomlReader::optional_quantities(const std::string& key) {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  const auto* list = found->as_array();
  if (!list || list->empty()) refuse_type(*found, key, "a list of numbers");
  std::vector<model::Quantity> quantities;
  for (const toml::node& entry : *list) quantities.push_back(to_quantity(entry, key));
  return quantities;
}

std::optional<long> TomlReader::optional_integer(const std::string& key) {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  if (!found->is_integer()) refuse_type(*found, key, "a whole number");
  return static_cast<long>(found->as_integer()->get());
}

std::optional<bool> TomlReader::optional_bool(const std::string& key) {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  if (!found->is_boolean()) refuse_type(*found, key, "true or false");
  return found->as_boolean()->get();
}

std::string TomlReader::to_name(const toml::node& node, const std::string& key) const {
  if (const auto* name = node.as_string()) return name->get();
  if (const auto* number = node.as_integer()) return std::to_string(number->get());
  refuse_type(node, key, "the name of a coordinate");
}

std::string TomlReader::name(const std::string& key, Location* where_found) {
  const toml::node& found = required(key);
  if (where_found) *where_found = location(found);
  return to_name(found, key);
}

std::optional<std::vector<std::string>> TomlReader::optional_texts(const std::string& key,
                                                                   std::vector<Location>* where_found) {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  const auto* list = found->as_array();
  if (!list) refuse_type(*found, key, "a list of names");
  std::vector<std::string> texts;
  for (const toml::node& entry : *list) {
    texts.push_back(to_name(entry, key));
    if (where_found) where_found->push_back(location(entry));
  }
  return texts;
}

model::Between TomlReader::between(const std::string& key, std::array<Location, 2>& where_found) {
  const toml::node& found = required(key);
  const auto* list = found.as_array();
  if (!list || list->size() != 2) refuse_type(found, key, "a list of two names, such as [\"blade1\", \"ground\"]");
  model::Between names;
  for (std::size_t i = 0; i < 2; ++i) {
    names[i] = to_name(*list->get(i), key);
    where_found[i] = location(*list->get(i));
  }
  return names;
}

std::optional<std::vector<std::pair<std::string, model::Quantity>>> TomlReader::optional_quantities_by_name(
    const std::string& key) {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  const auto* table = found->as_table();
  if (!table) refuse_type(*found, key, "a table of numbers by name, such as { tip = 1.0 }");
  std::vector<std::pair<std::string, model::Quantity>> quantities;
  for (const auto& [name, value] : *table)
    quantities.emplace_back(std::string(name.str()), to_quantity(value, key + "." + std::string(name.str())));
  return quantities;
}

std::vector<std::vector<std::pair<std::string, model::Quantity>>> TomlReader::optional_lists_by_name(
    const std::string& key, std::size_t most) {
  const toml::node* found = node(key);
  if (!found) return {};
  const auto* list = found->as_array();
  if (!list) return {*optional_quantities_by_name(key)};
  if (list->empty() || list->size() > most)
    throw InvalidInput(location(*found), fmt::format("{}: {} must be a table of numbers by name or a list of up to {}, "
                                                     "got a list of {}",
                                                     what_, key, most, list->size()));
  std::vector<std::vector<std::pair<std::string, model::Quantity>>> all;
  for (const toml::node& entry : *list) {
    const auto* table = entry.as_table();
    if (!table) refuse_type(entry, key, "a list of tables of numbers by name, such as [{ x = 1.0 }, { y = 1.0 }]");
    auto& quantities = all.emplace_back();
    for (const auto& [name, value] : *table)
      quantities.emplace_back(std::string(name.str()), to_quantity(value, key + "." + std::string(name.str())));
  }
  return all;
}

std::optional<TomlReader> TomlReader::optional_table(const std::string& key, const std::string& what) {
  const toml::node* found = node(key);
  if (!found) return std::nullopt;
  const auto* table = found->as_table();
  if (!table && found->is_array_of_tables())
    throw InvalidInput(location(*found), what == "[" + key + "]"
                                             ? fmt::format("\"{0}\" must be written as [{0}], once", key)
                                             : fmt::format("{}: {} must be one table {{ ... }}, got a list of {}",
                                                           what_, key, found->as_array()->size()));
  if (!table) refuse_type(*found, key, "a table");
  return TomlReader(*table, what, file_);
}

std::vector<TomlReader> TomlReader::tables(const std::string& key) {
  std::vector<TomlReader> readers;
  const toml::node* found = node(key);
  if (!found) return readers;
  const auto* list = found->as_array();
  if (!list || !std::all_of(list->begin(), list->end(), [](const toml::node& n) { return n.is_table(); }))
    throw InvalidInput(location(*found), fmt::format("\"{0}\" must be written as [[{0}]], a table for each", key));
  for (const toml::node& entry : *list) readers.emplace_back(*entry.as_table(), "[[" + key + "]]", file_);
  return readers;
}

std::vector<TomlReader> TomlReader::parts(const std::string& key) {
  std::vector<TomlReader> readers;
  const toml::node& found = required(key);
  const auto* list = found.as_array();
  if (!list || list->empty() ||
      !std::all_of(list->begin(), list->end(), [](const toml::node& n) { return n.is_table(); }))
    refuse_type(found, key, "a table { ... }, or a list of tables");
  for (const toml::node& entry : *list)
    readers.emplace_back(*entry.as_table(), fmt::format("{}({})", name_of_part(key), readers.size() + 1), file_);
  return readers;
}

void TomlReader::finish() const {
  for (const auto& [key, value] : table_) {
    const std::string name(key.str());
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    std::vector<std::string> all = known_;
    for (const auto& [other, what] : elsewhere_) all.push_back(other);
    const auto found = elsewhere_.find(nearest_name(name, all));
    if (found == elsewhere_.end() && !table_.is_inline() && is_part_of_the_study(name, value))
      throw InvalidInput(
          location(key),
          fmt::format(
              "{0} has no key \"{1}\": in TOML the keys after a line in brackets belong to it, up to the next such "
              "line; write \"{1} = ...\" above the first of them, or under a line {2}",
              what_, name, value.is_table() ? "[" + name + "]" : "[[" + name + "]]"));
    throw InvalidInput(location(key),
                       fmt::format("{} has no key \"{}\"{}", what_, name,
                                   found != elsewhere_.end() ? "; " + found->second : whole_suggestion(name, known_)));
  }
}

}  // namespace rubato::io
