#include <rubato/io/reading_visitor.hpp>
#include <rubato/model/fields/sweep_fields.hpp>

namespace rubato::io {

using namespace model;

void ReadingVisitor::names(const char* key, std::vector<std::string>& to, std::vector<Location>* places, const Words&,
                           const Key& about) {
  const auto texts = reader_.optional_texts(key, places);
  if (!texts && about.required) reader_.refuse_to_lack(key);
  to = texts.value_or(std::vector<std::string>{});
}

void ReadingVisitor::names_with_places(const char* key, std::optional<std::vector<ObservationDescription>>& to,
                                       const Key&) {
  std::vector<Location> places;
  const auto names = reader_.optional_texts(key, &places);
  if (!names) return;
  to.emplace();
  for (std::size_t i = 0; i < names->size(); ++i) to->push_back({(*names)[i], "", places[i]});
}

void ReadingVisitor::one_or_more(const char* key, std::vector<Quantity>& to, const Size&, const Key& about) {
  const toml::node* found = reader_.node(key);
  if (found && found->is_array())
    to = *reader_.optional_quantities(key);
  else if (found || about.required)
    to = {reader_.quantity(key)};
}

Quantity ReadingVisitor::formula(const char* key) {
  Quantity formula = reader_.quantity(key);
  if (formula.expression.empty()) formula.expression = fmt::format("{}", formula.value);
  return formula;
}

void ReadingVisitor::quantity_or_table(const char* key, std::optional<Quantity>& to,
                                       std::optional<TableDescription>& table, const TableUse& use, const Key& about) {
  const toml::node* node = reader_.node(key);
  if (!node || !node->is_table())
    quantity(key, to, about);
  else
    part(key, about, [&](ReadingVisitor& inner) { fields(inner, table.emplace(), use); });
}

void ReadingVisitor::formula_or_table(const char* key, std::optional<DriveDescription>& to, const TableUse& use,
                                      const Key& about) {
  const toml::node* node = reader_.node(key);
  if (!node) return;
  to.emplace();
  to->where = reader_.where(key);
  if (node->is_table())
    part(key, about, [&](ReadingVisitor& inner) { fields(inner, to->law.emplace<TableDescription>(), use); });
  else
    to->law = TimeFormulaDescription{formula(key)};
}

void ReadingVisitor::quantity_or_word(const char* key, std::optional<Quantity>& to, bool& is_word, const char* word,
                                      const Key& about) {
  const toml::node* node = reader_.node(key);
  is_word = node && node->is_string() && node->as_string()->get() == word;
  if (!is_word) quantity(key, to, about);
}

void ReadingVisitor::part(const char* key, const Key&, const std::function<void(ReadingVisitor&)>& read_inner) {
  auto reader = reader_.optional_table(key, reader_.name_of_part(key));
  if (!reader) return;
  ReadingVisitor inner(*reader, folder_);
  read_inner(inner);
  inner.finish();
}

void ReadingVisitor::quantity_or_part(const char* key, std::optional<Quantity>& to, const Key& about,
                                      const std::function<void(ReadingVisitor&)>& read_inner) {
  const toml::node* node = reader_.node(key);
  if (node && node->is_table())
    part(key, about, read_inner);
  else
    quantity(key, to, about);
}

void ReadingVisitor::methods(const char* key, std::vector<MethodDescription>& to, const Key&) {
  const toml::node* node = reader_.node(key);
  if (!node) return;
  const auto* list = node->as_array();
  if (!list || list->empty()) reader_.refuse_type(*node, key, "a list of methods");
  for (const toml::node& entry : *list) to.push_back(to_method(reader_, entry, key));
}

void ReadingVisitor::observation(const char* key, std::optional<ObservationDescription>& to, const Key&) {
  if (const auto text = reader_.optional_text(key)) to = to_observation(*text, reader_.where(key));
}

void ReadingVisitor::observe(const char* key, std::optional<std::vector<ObservationDescription>>& to, const Key&) {
  std::vector<Location> places;
  std::optional<std::vector<std::string>> texts;
  if (const toml::node* node = reader_.node(key); node && !node->is_array()) {
    places.emplace_back();
    texts = {reader_.name(key, &places.front())};
  } else {
    texts = reader_.optional_texts(key, &places);
  }
  if (!texts) return;
  to.emplace();
  for (std::size_t i = 0; i < texts->size(); ++i) {
    const std::string& text = (*texts)[i];
    const auto here = texts->begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find(texts->begin(), here, text) != here)
      throw InvalidInput(places[i], fmt::format("{}: {} names \"{}\" twice", reader_.what(), key, text));
    to->push_back(to_observation(text, places[i]));
  }
}

void ReadingVisitor::contact_limits(const char* key, std::optional<std::vector<ContactLimitDescription>>& to,
                                    Location& where, const Key&) {
  using Kind = ContactLimitDescription::Kind;
  static const std::vector<std::pair<std::string, Kind>> words{{"open", Kind::open},
                                                               {"stuck", Kind::stuck},
                                                               {"frictionless", Kind::frictionless},
                                                               {"static", Kind::static_state}};
  constexpr const char* expected = "a list such as [\"stuck\", \"frictionless\", { sliding = { pad = 1 } }]";
  const toml::node* node = reader_.node(key);
  if (!node) return;
  where = reader_.where(key);
  const toml::array* list = node->as_array();
  if (!list || list->empty()) reader_.refuse_type(*node, key, expected);
  to.emplace();
  for (const toml::node& entry : *list) {
    ContactLimitDescription& limit = to->emplace_back();
    limit.where = reader_.location(entry);
    if (const toml::table* table = entry.as_table()) {
      TomlReader inner(*table, fmt::format("{}: {}", reader_.what(), key), reader_.file());
      limit.kind = Kind::sliding;
      if (const auto sliding = inner.optional_quantities_by_name("sliding"); sliding && !sliding->empty())
        limit.sliding = *sliding;
      else
        inner.refuse_to_lack("sliding", ": { NAME = 1 }, the contacts that slide, each with its sign");
      inner.finish();
      continue;
    }
    const auto word = entry.value<std::string>();
    if (!word) reader_.refuse_type(entry, key, expected);
    const auto found = std::find_if(words.begin(), words.end(), [&](const auto& one) { return one.first == *word; });
    if (found == words.end()) {
      std::vector<std::string> known;
      for (const auto& one : words) known.push_back(one.first);
      throw InvalidInput(limit.where, fmt::format("{}: {} takes no \"{}\"{}", reader_.what(), key, *word,
                                                  *word == "sliding" ? "; write { sliding = { NAME = 1 } }"
                                                                     : suggestion(*word, known)));
    }
    limit.kind = found->second;
  }
}

void ReadingVisitor::section_forces(const char* key, SectionForcesDescription& to, const Key&) {
  const toml::node* node = reader_.node(key);
  to.where = reader_.where(key);
  if (node && node->is_boolean()) {
    to.of_all = reader_.optional_bool(key).value_or(false);
  } else {
    std::vector<Location> places;
    if (const auto names = reader_.optional_texts(key, &places))
      for (std::size_t i = 0; i < names->size(); ++i) to.beams.push_back({(*names)[i], "", places[i]});
  }
}

void ReadingVisitor::values(const char* key, ValuesDescription& to, const Key&) {
  if (const toml::node* node = reader_.node(key)) to = to_values(reader_, *node, key, folder_);
}

void ReadingVisitor::frequencies(ValuesDescription& to, bool& in_hertz, const Key&, const Key&) {
  const std::string key = frequency_key(reader_);
  in_hertz = key == "frequency";
  to = to_values(reader_, *reader_.node(key), key, folder_);
}

void ReadingVisitor::frequency_range(ValuesDescription& to, bool& in_hertz, bool& has_points, const Key&, const Key&) {
  const std::string key = frequency_key(reader_);
  in_hertz = key == "frequency";
  const toml::node& node = *reader_.node(key);
  if (!node.is_table())
    reader_.refuse_type(node, key, "a range in which peaks are looked for, such as { from = 7.0, to = 8.5 }");
  part(key.c_str(), {}, [&](ReadingVisitor& inner) {
    PeakRangeDescription range;
    fields(inner, range);
    to.where = range.where;
    to.from = range.from;
    to.to = range.to;
    has_points = range.points.has_value();
    if (has_points) to.points = *range.points;
  });
}

void ReadingVisitor::sweep(const char* key, SweepDescription& to, const Key&) {
  to = read_sweep(reader_, key, folder_);
}

void ReadingVisitor::distributions(const char* key, std::vector<DistributionDescription>& to, const Key&) {
  if (!reader_.has(key))
    reader_.refuse_misspelling_of(key),
        throw InvalidInput(reader_.where(),
                           fmt::format("{}: samples need \"{}\", a distribution for each", reader_.what(), key));
  auto inner = reader_.optional_table(key, reader_.name_of_part(key));
  for (const auto& [name, node] : in_order_of_the_file(*reader_.node(key)->as_table())) {
    if (!node->is_table())
      inner->refuse_type(*node, name,
                         "a distribution, such as { distribution = \"normal\", mean = 1.0, deviation = 0.1 }");
    TomlReader one(*node->as_table(), inner->name_of_part(name), inner->file());
    to.emplace_back().parameter = name;
    ReadingVisitor(one, folder_).read(to.back());
  }
  if (to.empty()) throw InvalidInput(inner->where(), fmt::format("{}: {} is empty", reader_.what(), key));
}

void ReadingVisitor::belong(const char* type, const std::vector<std::pair<const char*, Words>>& takers,
                            const char* kind,
                            const std::function<std::string(const std::string&, const std::string&)>& instead) {
  const std::string chosen = reader_.text(type);
  for (const auto& [key, words] : takers) {
    if (!reader_.has(key) || std::find(words.begin(), words.end(), chosen) != words.end()) continue;
    const std::string last = words.size() > 1 ? std::string(" or ") + words.back() : "";
    throw InvalidInput(reader_.where(key),
                       fmt::format("{}: \"{}\" belongs to a {}{} {}, and this one is {}{}", reader_.what(), key,
                                   fmt::join(words.begin(), words.end() - (words.size() > 1 ? 1 : 0), ", "), last, kind,
                                   chosen, instead(key, chosen)));
  }
}

void ReadingVisitor::refuse_to_lack(const char* key, const std::vector<std::string>& words) {
  const std::string last = words.size() > 1 ? fmt::format(" or \"{}\"", words.back()) : "";
  reader_.refuse_to_lack(
      key, fmt::format(": \"{}\"{}", fmt::join(words.begin(), words.end() - (words.size() > 1), "\", \""), last));
}

}  // namespace rubato::io
