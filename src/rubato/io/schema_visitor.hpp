#pragma once

#include <rubato/io/json_value.hpp>
#include <rubato/model/fields/key.hpp>
#include <rubato/model/fields/model_fields.hpp>

#include <algorithm>
#include <functional>

// Private to io.
namespace rubato::io {

/// Makes of the fields of a description the JSON schema of its table: {"type": "object", "properties": ...}. Values of
/// the description are not looked at.
class SchemaVisitor {
 public:
  using Key = model::Key;
  using Quantity = model::Quantity;
  using Words = std::vector<const char*>;

  /// The schema of a table. Composite values refer to definitions(), which study_schema() adds.
  Json schema() const;
  /// The keys, in the order of the fields.
  const std::vector<std::string>& keys() const { return properties_.names(); }
  template <class Description, class... More>
  static SchemaVisitor of(const More&... more) {
    SchemaVisitor visitor;
    Description description;
    fields(visitor, description, more...);
    return visitor;
  }
  /// A property that no field tells.
  void property(const std::string& key, Json schema, const Key& about);

  void title(const std::string&, const std::string&) {}
  void where(const Location&, const char* = nullptr) {}
  void where_given(const Location&, const char*) {}

  void text(const char* key, const std::string&, const Key& about) {
    Json schema = Json::object({{"type", Json::text("string")}});
    if (about.required) schema.set("minLength", Json::number(1));
    property(key, schema, about);
  }
  void name(const char* key, const std::string&, const Location&, const Key& about) {
    property(key, any_name(), about);
  }
  void numbered_name(const char* kind, const std::string&, const Location&, Key about);
  void between(const char* key, const model::Between&, const std::array<Location, 2>&, const Key& about) {
    property(key, reference("between"), about);
  }
  void names(const char* key, const std::vector<std::string>&, const std::vector<Location>*, const Words& choices,
             const Key& about);
  void names_with_places(const char* key, const std::optional<std::vector<model::ObservationDescription>>&,
                         const Key& about) {
    property(key, list(any_name()), about);
  }

  void quantity(const char* key, const Quantity&, const Key& about) { property(key, reference("quantity"), about); }
  void quantity(const char* key, const std::optional<Quantity>&, const Key& about) {
    property(key, reference("quantity"), about);
  }
  void formula(const char* key, const Quantity&, const Key& about) { property(key, formula(), about); }
  void quantity_of_rate(const char* key, const Quantity& of, bool, const Key& about) { quantity(key, of, about); }
  void quantities(const char* key, const std::vector<Quantity>&, const model::Size& size, const Key& about) {
    property(key, list(reference("quantity"), size), about);
  }
  void one_or_more(const char* key, const std::vector<Quantity>&, const model::Size& size, const Key& about) {
    property(key, one_of({reference("quantity"), list(reference("quantity"), size)}), about);
  }
  void by_name(const char* key, const std::vector<std::pair<std::string, Quantity>>&, const Key& about) {
    property(key, Json::object({{"type", Json::text("object")}, {"additionalProperties", reference("quantity")}}),
             about);
  }
  void one_or_two_by_name(const char* key, const std::vector<std::vector<std::pair<std::string, Quantity>>>&,
                          const Key& about) {
    const Json table = Json::object({{"type", Json::text("object")}, {"additionalProperties", reference("quantity")}});
    property(key, one_of({table, list(table, {1, 2})}), about);
  }
  void either_quantity(const std::array<const char*, 2>& keys, const Quantity&, bool, const Key& first,
                       const Key& second, const auto&) {
    property(keys[0], reference("quantity"), first);
    property(keys[1], reference("quantity"), second);
    exactly_one_of({keys[0], keys[1]});
  }

  template <class Value>
  void word(const char* key, const Value&, const std::type_identity_t<std::vector<model::Choice<Value>>>& choices,
            const Key& about) {
    property(key, enumeration(choices), about);
  }
  template <class Value>
  void word(const char* key, const std::optional<Value>&,
            const std::type_identity_t<std::vector<model::Choice<Value>>>& choices, const Key& about) {
    property(key, enumeration(choices), about);
  }
  void flag(const char* key, bool, const Key& about) {
    property(key, Json::object({{"type", Json::text("boolean")}}), about);
  }
  void whole(const char* key, long, long, const model::Bounds& bounds, const Key& about);
  void whole(const char* key, const std::optional<long>&, const model::Bounds& bounds, const Key& about) {
    whole(key, 0, 0, bounds, about);
  }

  void columns(const char* key, const model::TableDescription&, const model::TableUse&, const Key& about) {
    property(key, Json::object({{"type", Json::text("string")}}), about);
  }
  void matrix(const char* key, const model::MatrixDescription&, const Key& about) {
    property(key, Json::object({{"type", Json::text("string")}}), about);
  }
  void matrix(const char* key, const std::optional<model::MatrixDescription>&, const Key& about) {
    property(key, Json::object({{"type", Json::text("string")}}), about);
  }
  void quantity_or_table(const char* key, const std::optional<Quantity>&, const std::optional<model::TableDescription>&,
                         const model::TableUse& use, const Key& about) {
    property(key, one_of({reference("quantity"), of<model::TableDescription>(use).schema()}), about);
  }
  void formula_or_table(const char* key, const std::optional<model::DriveDescription>&, const model::TableUse& use,
                        const Key& about) {
    property(key, one_of({formula(), of<model::TableDescription>(use).schema()}), about);
  }
  void quantity_or_word(const char* key, const std::optional<Quantity>&, bool, const char*, const Key& about) {
    property(key, reference("quantity"), about);  // a word is a text, as a formula is
  }

  template <class Description, class... More>
  void table(const char* key, const std::optional<Description>&, const Key& about, const More&... more) {
    property(key, of<Description>(more...).schema(), about);
  }
  template <class Description>
  void table(const char* key, const Description&, const Key& about) {
    property(key, of<Description>().schema(), about);
  }
  void part(const char* key, const Key& about, const std::function<void(SchemaVisitor&)>& inner) {
    property(key, inner_schema(inner), about);
  }
  void quantity_or_part(const char* key, const std::optional<Quantity>&, const Key& about,
                        const std::function<void(SchemaVisitor&)>& inner) {
    property(key, one_of({reference("quantity"), inner_schema(inner)}), about);
  }
  void load_or_part(const char* key, const Quantity&, bool, const Key& about,
                    const std::function<void(SchemaVisitor&)>& inner) {
    property(key, one_of({reference("quantity"), inner_schema(inner)}), about);
  }
  template <class Value>
  void word_or_part(const char* key, const Value&, const std::type_identity_t<std::vector<model::Choice<Value>>>& words,
                    const Key& about, const std::function<void(SchemaVisitor&)>& inner) {
    property(key, one_of({enumeration(words), inner_schema(inner)}), about);
  }
  template <class Description>
  void tables(const char* key, const std::vector<Description>&, const char* says) {
    property(key, list(of<Description>().schema(), {0}), {.says = says});
  }
  template <class Description>
  void table_or_tables(const char* key, const std::vector<Description>&, const Key& about) {
    const Json one = of<Description>().schema();
    property(key, one_of({one, list(one, {1})}), about);
  }
  template <class Description>
  void tables_like(const char* key, const std::vector<Description>&, Description prototype, const char* says) {
    SchemaVisitor one;
    fields(one, prototype);
    property(key, list(one.schema(), {0}), {.says = says});
  }
  template <class Moving>
  void held_or_moving(const char* key, const char*, const std::vector<model::HeldDescription>&, model::Held what,
                      const std::vector<Moving>&, const char* says) {
    SchemaVisitor either;
    either.take_one_of({of<model::HeldDescription>(what), of<Moving>()});
    property(key, list(either.schema(), {0}), {.says = says});
  }
  template <class... Types, class... More>
  void alternatives(const std::variant<Types...>&, const Words&, const auto&, const More&... more) {
    std::vector<SchemaVisitor> all;
    const auto take = [&]<class Type>(std::type_identity<Type>) {
      if constexpr (!std::is_same_v<Type, std::monostate>) all.push_back(of<Type>(more...));
    };
    (take(std::type_identity<Types>{}), ...);
    take_one_of(all);
  }
  bool applies(bool) const { return true; }
  template <class File>
  void rows(const char* key, const auto&, const char* says) {
    property(key, of<File>().schema(), {.says = says});
  }

  void method(const char* key, const model::MethodDescription&, const Key& about) {
    property(key, reference("method"), about);
  }
  void method(const char* key, const std::optional<model::MethodDescription>&, const Key& about) {
    property(key, reference("method"), about);
  }
  void methods(const char* key, const std::vector<model::MethodDescription>&, const Key& about) {
    property(key, list(reference("method"), {1}), about);
  }
  void observation(const char* key, const std::optional<model::ObservationDescription>&, const Key& about) {
    property(key, Json::object({{"type", Json::text("string")}}), about);
  }
  void observe(const char* key, const std::optional<std::vector<model::ObservationDescription>>&, const Key& about) {
    property(key, one_of({any_name(), list(any_name()).set("uniqueItems", Json::boolean(true))}), about);
  }
  void contact_limits(const char* key, const std::optional<std::vector<model::ContactLimitDescription>>&,
                      const Location&, const Key& about);
  void section_forces(const char* key, const model::SectionForcesDescription&, const Key& about);
  void values(const char* key, const model::ValuesDescription&, const Key& about) {
    property(key, reference("values"), about);
  }
  void frequencies(const model::ValuesDescription&, bool, const Key& angular, const Key& hertz) {
    property("angular_frequency", reference("values"), angular);
    property("frequency", reference("values"), hertz);
    exactly_one_of({"angular_frequency", "frequency"});
  }
  void frequency_range(const model::ValuesDescription&, bool, bool, const Key& angular, const Key& hertz) {
    property("angular_frequency", reference("frequency_range"), angular);
    property("frequency", reference("frequency_range"), hertz);
    exactly_one_of({"angular_frequency", "frequency"});
  }
  void parameters(const char* key, const std::vector<model::ParameterDescription>&, const Key& about);
  void analyses(const char* key, const std::vector<model::AnalysisDescription>&, const Key& about);
  void sweep(const char* key, const model::SweepDescription&, const Key& about) {
    property(key, reference("sweep"), about);
  }
  void distributions(const char* key, const std::vector<model::DistributionDescription>&, const Key& about);

  void check(const auto&) {}
  void check_at_end(const auto&) {}
  void needs(const char* key) { required_.emplace_back(key); }
  void excludes(const char* first, const char* second);
  void requires_beside(const char* key, const char* other);
  void some_of(const Words& keys) { rules_.push_back(Json::object({{"anyOf", requirements(keys)}})); }
  void exactly_one_of(const Words& keys) { rules_.push_back(Json::object({{"oneOf", requirements(keys)}})); }
  /// Of the keys that words take, each takes its own, and needs them.
  void of_words(const char* type, const std::vector<std::pair<const char*, Words>>& takers);
  void belong(const char* type, const std::vector<std::pair<const char*, Words>>& takers, const char*, const auto&) {
    for (const auto& [key, words] : takers) only_for(key, type, words);
  }
  /// A rule in the words of JSON schema.
  void rule(const std::string& schema) { rules_.push_back(Json::raw(schema)); }

  static Json reference(const std::string& definition) {
    return Json::object({{"$ref", Json::text("#/$defs/" + definition)}});
  }
  static Json one_of(std::vector<Json> schemas) { return Json::object({{"oneOf", Json::array(std::move(schemas))}}); }
  static Json list(Json entry, const model::Size& size = {0});
  /// A name, or a number that serves as one.
  static Json any_name() {
    return Json::object({{"type", Json::texts({"string", "integer"})}, {"minLength", Json::number(1)}});
  }

 private:
  static Json formula() { return Json::object({{"type", Json::texts({"string", "number"})}}); }
  template <class Value>
  static Json enumeration(const std::vector<model::Choice<Value>>& choices) {
    std::vector<std::string> words;
    for (const auto& one : choices) words.emplace_back(one.word);
    return Json::object({{"enum", Json::texts(words)}});
  }
  static Json inner_schema(const std::function<void(SchemaVisitor&)>& inner) {
    SchemaVisitor visitor;
    inner(visitor);
    return visitor.schema();
  }
  static Json requirements(const Words& keys);
  void only_for(const char* key, const char* type, const Words& words);
  /// Takes over the keys of all; one of them must hold, without the keys of the others alone.
  void take_one_of(const std::vector<SchemaVisitor>& all);

  Json properties_ = Json::object();
  std::vector<std::string> required_;
  std::vector<Json> rules_;
};

/// The keys of a description, in the order of its fields.
template <class Description, class... More>
std::vector<std::string> keys_of(const More&... more) {
  return SchemaVisitor::of<Description>(more...).keys();
}

/// Those of `all` that are not among `others`.
std::vector<std::string> without(const std::vector<std::string>& all, const std::vector<std::string>& others);

}  // namespace rubato::io
