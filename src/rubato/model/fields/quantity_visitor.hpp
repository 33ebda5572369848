#pragma once

#include <rubato/model/fields/model_fields.hpp>

#include <utility>

namespace rubato::model {

/// Walks the fields of descriptions and calls take(quantity, role, may_use_t) for each quantity there is. Everything
/// else that fields() tells is passed over.
template <class Take>
class QuantityVisitor {
 public:
  explicit QuantityVisitor(Take take) : take_(std::move(take)) {}

  void quantity(const char*, const Quantity& quantity, const Key& key) const { take_(quantity, key.role, false); }
  void quantity(const char*, const std::optional<Quantity>& quantity, const Key& key) const {
    if (quantity) take_(*quantity, key.role, false);
  }
  void quantity_of_rate(const char*, const Quantity& quantity, bool uses_rate, const Key& key) const {
    take_(quantity, key.role, uses_rate);
  }
  void load_or_part(const char*, const Quantity& quantity, bool uses_time, const Key& key, const auto&) const {
    if (quantity.expression == "reaction") return;  // a word: of the joint of a slider
    take_(quantity, key.role, uses_time);
  }
  void formula(const char*, const Quantity& quantity, const Key& key) const { take_(quantity, key.role, true); }
  void quantities(const char*, const std::vector<Quantity>& list, const Size&, const Key& key) const {
    for (const Quantity& quantity : list) take_(quantity, key.role, false);
  }
  void one_or_more(const char*, const std::vector<Quantity>& list, const Size&, const Key& key) const {
    for (const Quantity& quantity : list) take_(quantity, key.role, false);
  }
  void by_name(const char*, const std::vector<std::pair<std::string, Quantity>>& list, const Key& key) const {
    for (const auto& [name, quantity] : list) take_(quantity, key.role, false);
  }
  void one_or_two_by_name(const char* key, const std::vector<std::vector<std::pair<std::string, Quantity>>>& tables,
                          const Key& about) const {
    for (const auto& table : tables) by_name(key, table, about);
  }
  void either_quantity(const std::array<const char*, 2>&, const Quantity& quantity, bool, const Key& key, const Key&,
                       const auto&) const {
    take_(quantity, key.role, false);
  }
  void quantity_or_table(const char*, const std::optional<Quantity>& quantity, const std::optional<TableDescription>&,
                         const TableUse&, const Key& key) const {
    if (quantity) take_(*quantity, key.role, false);
  }
  void formula_or_table(const char*, const std::optional<DriveDescription>& drive, const TableUse&,
                        const Key& key) const {
    if (!drive) return;
    if (const auto* law = std::get_if<TimeFormulaDescription>(&drive->law)) take_(law->formula, key.role, true);
  }

  template <class Description, class... More>
  void table(const char*, const std::optional<Description>& description, const Key&, const More&... more) const {
    if (description) fields(*this, *description, more...);
  }
  template <class Description>
  void table(const char*, const Description& description, const Key&) const {
    fields(*this, description);
  }
  void part(const char*, const Key&, const auto& inner) const { inner(*this); }
  template <class Description>
  void tables(const char*, const std::vector<Description>& descriptions, const char*) const {
    for (const Description& description : descriptions) fields(*this, description);
  }
  template <class Description>
  void table_or_tables(const char*, const std::vector<Description>& descriptions, const Key&) const {
    for (const Description& description : descriptions) fields(*this, description);
  }
  template <class Description>
  void tables_like(const char*, const std::vector<Description>& descriptions, const Description& prototype,
                   const char*) const {
    for (const Description& description : descriptions)
      if (description.kind == prototype.kind) fields(*this, description);
  }
  template <class Moving>
  void held_or_moving(const char*, const char*, const std::vector<HeldDescription>& held, Held what,
                      const std::vector<Moving>& moving, const char*) const {
    for (const HeldDescription& description : held) fields(*this, description, what);
    for (const Moving& description : moving) fields(*this, description);
  }
  /// What the chosen alternative holds.
  template <class... Types, class... More>
  void alternatives(const std::variant<Types...>& chosen, const std::vector<const char*>&, const auto&,
                    const More&... more) const {
    const auto walk = [&](const auto& description) {
      if constexpr (!std::is_same_v<std::decay_t<decltype(description)>, std::monostate>)
        fields(*this, description, more...);
    };
    std::visit(walk, chosen);
  }
  bool applies(bool condition) const { return condition; }

  // Without quantities.
  void title(const char*, const std::string&) const {}
  void where(const Location&, const char* = nullptr) const {}
  void where_given(const Location&, const char*) const {}
  void text(const char*, const std::string&, const Key&) const {}
  void name(const char*, const std::string&, const Location&, const Key&) const {}
  void numbered_name(const char*, const std::string&, const Location&, const Key&) const {}
  void between(const char*, const Between&, const std::array<Location, 2>&, const Key&) const {}
  void names(const char*, const std::vector<std::string>&, const std::vector<Location>*,
             const std::vector<const char*>&, const Key&) const {}
  template <class Value>
  void word(const char*, const Value&, const std::type_identity_t<std::vector<Choice<Value>>>&, const Key&) const {}
  void flag(const char*, bool, const Key&) const {}
  void whole(const char*, long, long, const Bounds&, const Key&) const {}
  void columns(const char*, const TableDescription&, const TableUse&, const Key&) const {}
  void matrix(const char*, const MatrixDescription&, const Key&) const {}
  void matrix(const char*, const std::optional<MatrixDescription>&, const Key&) const {}
  template <class File>
  void rows(const char*, const auto&, const char*) const {}

  // Rules between keys.
  void check(const auto&) const {}
  void check_at_end(const auto&) const {}
  void needs(const char*) const {}
  void excludes(const char*, const char*) const {}
  void requires_beside(const char*, const char*) const {}
  void some_of(const std::vector<const char*>&) const {}
  void exactly_one_of(const std::vector<const char*>&) const {}
  void of_words(const char*, const std::vector<std::pair<const char*, std::vector<const char*>>>&) const {}
  void belong(const char*, const std::vector<std::pair<const char*, std::vector<const char*>>>&, const char*,
              const auto&) const {}
  void rule(const std::string&) const {}

 private:
  Take take_;
};

/// Calls take(quantity, role, may_use_t) for each quantity of a model, in the order of fields(ModelDescription).
template <class Take>
void for_each_quantity(const ModelDescription& model, Take take) {
  const QuantityVisitor visitor(std::move(take));
  fields(visitor, model);
}

}  // namespace rubato::model
