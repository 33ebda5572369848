#pragma once

#include <rubato/core/error.hpp>
#include <rubato/model/description.hpp>

#include <toml++/toml.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

// Private to io: the headers of toml++ stay out of the public ones.
namespace rubato::io {

/// One table of a study file on its way into a description. Every key that is asked for becomes a known key; finish()
/// refuses the others with the nearest known one. All messages carry the line and column of the value, or of the table
/// where a key is missing.
class TomlReader {
 public:
  /// @param what  for messages: `[[slider]] "contact1"`
  TomlReader(const toml::table& table, std::string what, std::string file);

  const std::string& what() const { return what_; }
  void rename(std::string what) { what_ = std::move(what); }
  Location where() const { return location(table_); }
  Location where(const std::string& key) const;
  bool has(const std::string& key);
  /// As has(), but without making the key a known one.
  bool table_has(const std::string& key) const { return table_.contains(key); }
  bool has_list(const std::string& key) { return has(key) && table_.get(key)->is_array(); }
  /// The text of a key; empty where it is missing or no text.
  std::string plain_text(const std::string& key) { return has(key) ? table_.get(key)->value_or<std::string>("") : ""; }
  /// What messages call a table within this one.
  std::string name_of_part(const std::string& key) const;

  std::string text(const std::string& key);
  std::optional<std::string> optional_text(const std::string& key);
  /// One of the words, spelled exactly.
  std::optional<std::string> optional_word(const std::string& key, const std::vector<std::string>& words);
  model::Quantity quantity(const std::string& key);
  std::optional<model::Quantity> optional_quantity(const std::string& key);
  std::optional<std::vector<model::Quantity>> optional_quantities(const std::string& key);
  std::optional<long> optional_integer(const std::string& key);
  std::optional<bool> optional_bool(const std::string& key);
  /// A coordinate's name, or its number as text.
  std::string name(const std::string& key, Location* where = nullptr);
  std::optional<std::vector<std::string>> optional_texts(const std::string& key,
                                                         std::vector<Location>* where = nullptr);
  model::Between between(const std::string& key, std::array<Location, 2>& where);
  /// A table of quantities by name: { tip = 1.0 }.
  std::optional<std::vector<std::pair<std::string, model::Quantity>>> optional_quantities_by_name(
      const std::string& key);
  /// One such table, or a list of them; empty where there is none.
  std::vector<std::vector<std::pair<std::string, model::Quantity>>> optional_lists_by_name(const std::string& key,
                                                                                           std::size_t most);
  std::optional<TomlReader> optional_table(const std::string& key, const std::string& what);
  /// [[key]] tables, in order; empty if there are none.
  std::vector<TomlReader> tables(const std::string& key);
  /// A list of tables within this one. Throws for an empty one.
  std::vector<TomlReader> parts(const std::string& key);
  const toml::node* node(const std::string& key);

  /// Throws for the first of `keys` that is present: each belongs to an alternative of `chosen`.
  void refuse_beside(const std::string& chosen, const std::vector<std::string>& keys);
  /// A missing key is more often misspelled than forgotten: points at the misspelling.
  void refuse_misspelling_of(const std::string& key) const;
  /// What to write in place of a key that users look for here: "a strut is a [[joint]] of type = "strut"".
  void note_elsewhere(const std::string& key, std::string what) { elsewhere_[key] = std::move(what); }
  /// Throws for a key that must be there.
  /// @param rest  what follows its name in the message: ": \"stop\" or \"latch\""
  [[noreturn]] void refuse_to_lack(const std::string& key, const std::string& rest = "") const;
  /// Throws for a key that nothing asked for.
  void finish() const;

  Location location(const toml::node& node) const;
  Location location(const toml::key& key) const;
  model::Quantity to_quantity(const toml::node& node, const std::string& key) const;
  [[noreturn]] void refuse_type(const toml::node& node, const std::string& key, const std::string& expected) const;
  const std::string& file() const { return file_; }

 private:
  const toml::node& required(const std::string& key);
  std::string to_name(const toml::node& node, const std::string& key) const;

  const toml::table& table_;
  std::string what_, file_;
  std::vector<std::string> known_;
  std::map<std::string, std::string> elsewhere_;
};

}  // namespace rubato::io
