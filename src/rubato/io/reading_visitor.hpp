#pragma once

#include <rubato/io/read_parts.hpp>
#include <rubato/io/schema_visitor.hpp>
#include <rubato/model/fields/key.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

// Private to io.
namespace rubato::io {

/// Fills a description with what a table of the file says of its fields. Throws InvalidInput as TomlReader does, and as
/// the checks among the fields do.
class ReadingVisitor {
 public:
  using Location = rubato::Location;
  using Quantity = model::Quantity;
  using Key = model::Key;
  using Words = std::vector<const char*>;

  /// @param number  of the table among those of its kind, from 1
  ReadingVisitor(TomlReader& reader, const StudyFolder& folder, std::size_t number = 1)
      : reader_(reader), folder_(folder), number_(number) {}

  /// Reads all fields of a description and refuses keys that none of them asked for.
  template <class Description, class... More>
  void read(Description& description, const More&... more) {
    fields(*this, description, more...);
    finish();
  }

  void title(const std::string& kind, const std::string& name) { reader_.rename(fmt::format("{} \"{}\"", kind, name)); }
  void where(Location& place) { place = reader_.where(); }
  void where(Location& place, const char* key) { place = reader_.where(key); }
  void where_given(Location& place, const char* key) {
    if (reader_.has(key)) place = reader_.where(key);
  }

  void text(const char* key, std::string& to, const Key& about) {
    to = about.required ? reader_.text(key) : reader_.optional_text(key).value_or("");
  }
  void name(const char* key, std::string& to, Location& place, const Key& about) {
    if (about.required || reader_.has(key)) to = reader_.name(key, &place);
  }
  void numbered_name(const char* kind, std::string& to, Location& place, const Key&) {
    to = reader_.optional_text("name").value_or(fmt::format("{}{}", kind, number_));
    place = reader_.where("name");
    title(kind, to);
  }
  void between(const char* key, model::Between& to, std::array<Location, 2>& places, const Key& about) {
    if (about.required || reader_.has(key)) to = reader_.between(key, places);
  }
  void names(const char* key, std::vector<std::string>& to, std::vector<Location>* places, const Words&,
             const Key& about);
  void names_with_places(const char* key, std::optional<std::vector<model::ObservationDescription>>& to, const Key&);

  void quantity(const char* key, Quantity& to, const Key& about) {
    if (about.required || reader_.has(key)) to = reader_.quantity(key);
  }
  void quantity(const char* key, std::optional<Quantity>& to, const Key& about) {
    if (about.required || reader_.has(key)) to = reader_.quantity(key);
  }
  void formula(const char* key, Quantity& to, const Key&) { to = formula(key); }
  /// A quantity that may use the rate where it is looked at as one that does.
  void quantity_of_rate(const char* key, Quantity& to, bool, const Key& about) { quantity(key, to, about); }
  void quantities(const char* key, std::vector<Quantity>& to, const model::Size&, const Key& about) {
    if (about.required && !reader_.has(key)) reader_.refuse_to_lack(key);
    to = reader_.optional_quantities(key).value_or(std::vector<Quantity>{});
  }
  void one_or_more(const char* key, std::vector<Quantity>& to, const model::Size&, const Key&);
  void by_name(const char* key, std::vector<std::pair<std::string, Quantity>>& to, const Key&) {
    to = reader_.optional_quantities_by_name(key).value_or(std::vector<std::pair<std::string, Quantity>>{});
  }
  /// A table, or a list of one or two.
  void one_or_two_by_name(const char* key, std::vector<std::vector<std::pair<std::string, Quantity>>>& to, const Key&) {
    to = reader_.optional_lists_by_name(key, 2);
  }
  /// @param complain  (reader, how many are given, where); throws
  void either_quantity(const std::array<const char*, 2>& keys, Quantity& to, bool& is_second, const Key&, const Key&,
                       const auto& complain) {
    const auto first = reader_.optional_quantity(keys[0]), second = reader_.optional_quantity(keys[1]);
    if (first && second) complain(reader_, 2, second->where);
    if (!first && !second) {
      for (const char* key : keys) reader_.refuse_misspelling_of(key);
      complain(reader_, 0, reader_.where());
    }
    to = first ? *first : *second;
    is_second = second.has_value();
  }

  template <class Value>
  void word(const char* key, Value& to, const std::type_identity_t<std::vector<model::Choice<Value>>>& choices,
            const Key& about) {
    const auto found = choice(key, choices, about.required);
    if (found < choices.size()) to = choices[found].value;
  }
  template <class Value>
  void word(const char* key, std::optional<Value>& to,
            const std::type_identity_t<std::vector<model::Choice<Value>>>& choices, const Key& about) {
    const auto found = choice(key, choices, about.required);
    if (found < choices.size()) to = choices[found].value;
  }
  void flag(const char* key, bool& to, const Key&) { to = reader_.optional_bool(key).value_or(to); }
  template <class Number>
  void whole(const char* key, Number& to, long unless, const model::Bounds& bounds, const Key&) {
    const long value = reader_.optional_integer(key).value_or(unless);
    if (value < bounds.least || value > bounds.most)
      throw InvalidInput(reader_.where(key),
                         fmt::format("{}: {} must be {}, got {}", reader_.what(), key, bounds.said, value));
    to = static_cast<Number>(value);
  }
  /// The bounds are for the schema; a check looks at them.
  void whole(const char* key, std::optional<long>& to, const model::Bounds&, const Key&) {
    to = reader_.optional_integer(key);
  }

  void columns(const char* key, model::TableDescription& to, const model::TableUse& use, const Key&) {
    to = read_table(reader_.text(key), folder_, reader_.where(key), use.units, {use.over, use.over_unit});
  }
  void matrix(const char* key, model::MatrixDescription& to, const Key&) {
    const std::string file = reader_.text(key);
    to = read_matrix_market(file, folder_, reader_.where(key));
  }
  void matrix(const char* key, std::optional<model::MatrixDescription>& to, const Key& about) {
    if (reader_.has(key)) matrix(key, to.emplace(), about);
  }
  void quantity_or_table(const char* key, std::optional<Quantity>& to, std::optional<model::TableDescription>& table,
                         const model::TableUse& use, const Key& about);
  void formula_or_table(const char* key, std::optional<model::DriveDescription>& to, const model::TableUse& use,
                        const Key& about);
  void quantity_or_word(const char* key, std::optional<Quantity>& to, bool& is_word, const char* word, const Key&);

  template <class Description, class... More>
  void table(const char* key, std::optional<Description>& to, const Key& about, const More&... more) {
    part(key, about, [&](ReadingVisitor& inner) { fields(inner, to.emplace(), more...); });
  }
  template <class Description>
  void table(const char* key, Description& to, const Key& about) {
    part(key, about, [&](ReadingVisitor& inner) { fields(inner, to); });
  }
  void part(const char* key, const Key&, const std::function<void(ReadingVisitor&)>& read_inner);
  void quantity_or_part(const char* key, std::optional<Quantity>& to, const Key& about,
                        const std::function<void(ReadingVisitor&)>& read_inner);
  /// A quantity that may use t where it is looked at as one that does.
  void load_or_part(const char* key, Quantity& to, bool, const Key& about,
                    const std::function<void(ReadingVisitor&)>& read_inner) {
    const toml::node* node = reader_.node(key);
    if (node && node->is_table())
      part(key, about, read_inner);
    else
      quantity(key, to, about);
  }
  template <class Value>
  void word_or_part(const char* key, Value& to, const std::type_identity_t<std::vector<model::Choice<Value>>>& choices,
                    const Key& about, const std::function<void(ReadingVisitor&)>& read_inner) {
    const toml::node* node = reader_.node(key);
    if (node && node->is_table())
      part(key, about, read_inner);
    else
      word(key, to, choices, about);
  }
  template <class Description>
  void tables(const char* key, std::vector<Description>& to, const char*) {
    for (TomlReader& reader : reader_.tables(key)) {
      Description description;
      ReadingVisitor(reader, folder_, to.size() + 1).read(description);
      to.push_back(std::move(description));
    }
  }
  /// One table within the table, or a list of them.
  template <class Description>
  void table_or_tables(const char* key, std::vector<Description>& to, const Key& about) {
    if (!reader_.has_list(key)) {
      part(key, about, [&](ReadingVisitor& inner) { fields(inner, to.emplace_back()); });
      return;
    }
    for (TomlReader& reader : reader_.parts(key)) {
      ReadingVisitor inner(reader, folder_);
      fields(inner, to.emplace_back());
      inner.finish();
    }
  }
  /// Tables that share a list with others: each begins as a description that says which it is.
  template <class Description>
  void tables_like(const char* key, std::vector<Description>& to, const Description& prototype, const char*) {
    std::size_t number = 0;
    for (TomlReader& reader : reader_.tables(key)) {
      Description description = prototype;
      ReadingVisitor(reader, folder_, ++number).read(description);
      to.push_back(std::move(description));
    }
  }
  /// Tables of one name: with the key `chosen` they hold something in static states, without it they move it.
  template <class Moving>
  void held_or_moving(const char* key, const char* chosen, std::vector<model::HeldDescription>& held, model::Held what,
                      std::vector<Moving>& moving, const char*) {
    for (TomlReader& reader : reader_.tables(key)) {
      ReadingVisitor inner(reader, folder_);
      if (reader.table_has(chosen)) {
        fields(inner, held.emplace_back(), what);
        reader.refuse_beside(chosen, without(keys_of<Moving>(), keys_of<model::HeldDescription>(what)));
      } else {
        fields(inner, moving.emplace_back());
        (void)reader.has(chosen);
      }
      inner.finish();
    }
  }
  /// The alternative of a variant whose first key is there.
  /// @param leads     the first keys of the alternatives
  /// @param complain  (reader, how many are given); throws
  template <class... Types, class... More>
  void alternatives(std::variant<Types...>& to, const Words& leads, const auto& complain, const More&... more) {
    int given = 0;
    std::size_t chosen = 0;
    for (std::size_t i = 0; i < leads.size(); ++i)
      if (reader_.has(leads[i])) {
        ++given;
        chosen = i;
      }
    if (given == 0)
      for (const char* lead : leads) reader_.refuse_misspelling_of(lead);
    if (given != 1) complain(reader_, given);
    std::size_t place = 0;
    const auto take = [&]<class Type>(std::type_identity<Type>) {
      if constexpr (!std::is_same_v<Type, std::monostate>)
        if (place++ == chosen) {
          reader_.refuse_beside(leads[chosen], keys_of_others<Type, Types...>(more...));
          fields(*this, to.template emplace<Type>(), more...);
        }
    };
    (take(std::type_identity<Types>{}), ...);
  }
  /// Whether a part of the fields is for this table; those who list all keys take every part.
  bool applies(bool condition) const { return condition; }
  template <class File>
  void rows(const char* key, auto& to, const char*) {
    if (auto reader = reader_.optional_table(key, fmt::format("[{}]", key))) {
      File file;
      ReadingVisitor(*reader, folder_).read(file);
      read_mesh(file, folder_, to);
    }
  }

  void method(const char* key, model::MethodDescription& to, const Key&) {
    if (const toml::node* node = reader_.node(key)) to = to_method(reader_, *node, key);
  }
  void method(const char* key, std::optional<model::MethodDescription>& to, const Key&) {
    if (const toml::node* node = reader_.node(key)) to = to_method(reader_, *node, key);
  }
  void methods(const char* key, std::vector<model::MethodDescription>& to, const Key&);
  void observation(const char* key, std::optional<model::ObservationDescription>& to, const Key&);
  void observe(const char* key, std::optional<std::vector<model::ObservationDescription>>& to, const Key&);
  void contact_limits(const char* key, std::optional<std::vector<model::ContactLimitDescription>>& to, Location& where,
                      const Key&);
  void section_forces(const char* key, model::SectionForcesDescription& to, const Key&);
  void values(const char* key, model::ValuesDescription& to, const Key&);
  void frequencies(model::ValuesDescription& to, bool& in_hertz, const Key&, const Key&);
  void frequency_range(model::ValuesDescription& to, bool& in_hertz, bool& has_points, const Key&, const Key&);
  void parameters(const char* key, std::vector<model::ParameterDescription>& to, const Key&) {
    to = read_parameters(reader_, key);
  }
  void analyses(const char* key, std::vector<model::AnalysisDescription>& to, const Key&) {
    to = read_analyses(reader_, key, folder_);
  }
  void sweep(const char* key, model::SweepDescription& to, const Key&);
  void distributions(const char* key, std::vector<model::DistributionDescription>& to, const Key&);

  /// Code beside the declaration that throws where keys do not go together.
  void check(const auto& look) { look(reader_); }
  /// As check, when keys that nothing asked for have been refused.
  void check_at_end(std::function<void(TomlReader&)> look) { at_end_.push_back(std::move(look)); }

  // Rules that the schema tells, and that a check, or the builder of the model, refuses to break.
  void needs(const char*) {}
  void excludes(const char*, const char*) {}
  void requires_beside(const char*, const char*) {}
  void some_of(const Words&) {}
  void exactly_one_of(const Words&) {}
  void of_words(const char*, const std::vector<std::pair<const char*, Words>>&) {}
  void rule(const std::string&) {}
  /// Keys that belong to some words of `type` only: others are refused with the words that take them.
  /// @param kind     "joint"
  /// @param instead  (key, word): what to do then
  void belong(const char* type, const std::vector<std::pair<const char*, Words>>& takers, const char* kind,
              const std::function<std::string(const std::string&, const std::string&)>& instead);

 private:
  /// The keys of the alternatives, but for those of one.
  template <class One, class... Types, class... More>
  static std::vector<std::string> keys_of_others(const More&... more) {
    std::vector<std::string> keys;
    const auto add = [&]<class Type>(std::type_identity<Type>) {
      if constexpr (!std::is_same_v<Type, std::monostate> && !std::is_same_v<Type, One>)
        for (const std::string& key : keys_of<Type>(more...)) keys.push_back(key);
    };
    (add(std::type_identity<Types>{}), ...);
    return without(keys, keys_of<One>(more...));
  }
  void finish() {
    reader_.finish();
    for (const auto& look : at_end_) look(reader_);
  }
  Quantity formula(const char* key);
  /// The place of the word among the choices; their number where the key is left out.
  template <class Value>
  std::size_t choice(const char* key, const std::vector<model::Choice<Value>>& choices, bool is_required) {
    std::vector<std::string> words;
    for (const auto& one : choices) words.emplace_back(one.word);
    const auto word = reader_.optional_word(key, words);
    if (!word && is_required) refuse_to_lack(key, words);
    return word ? static_cast<std::size_t>(std::find(words.begin(), words.end(), *word) - words.begin()) : words.size();
  }
  [[noreturn]] void refuse_to_lack(const char* key, const std::vector<std::string>& words);

  TomlReader& reader_;
  const StudyFolder& folder_;
  std::size_t number_;
  std::vector<std::function<void(TomlReader&)>> at_end_;
};

}  // namespace rubato::io
