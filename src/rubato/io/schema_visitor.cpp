#include <rubato/io/schema_visitor.hpp>
#include <rubato/model/fields/analysis_fields.hpp>
#include <rubato/model/fields/sweep_fields.hpp>

#include <fmt/format.h>

namespace rubato::io {
namespace {

/// "kT [N/m], positive (default: 0)"
std::string description(const model::Key& key) {
  std::string text = key.says;
  const auto add = [&](const std::string& separator, const std::string& more) {
    text += text.empty() ? more : separator + more;
  };
  if (*key.unit) add(" ", fmt::format("[{}]", key.unit));
  if (key.range == model::Range::positive) add(", ", "positive");
  if (key.range == model::Range::not_negative) add(", ", "not negative");
  if (*key.unless) add(" ", fmt::format("(default: {})", key.unless));
  return text;
}

}  // namespace

std::vector<std::string> without(const std::vector<std::string>& all, const std::vector<std::string>& others) {
  std::vector<std::string> rest;
  for (const std::string& one : all)
    if (std::find(others.begin(), others.end(), one) == others.end()) rest.push_back(one);
  return rest;
}

Json SchemaVisitor::schema() const {
  Json schema = Json::object(
      {{"type", Json::text("object")}, {"additionalProperties", Json::boolean(false)}, {"properties", properties_}});
  if (!required_.empty()) schema.set("required", Json::texts(required_));
  if (!rules_.empty()) schema.set("allOf", Json::array(rules_));
  return schema;
}

void SchemaVisitor::property(const std::string& key, Json schema, const Key& about) {
  if (const std::string text = description(about); !text.empty()) schema.set("description", Json::text(text));
  properties_.set(key, std::move(schema));
  if (about.required) required_.push_back(key);
}

void SchemaVisitor::numbered_name(const char* kind, const std::string&, const Location&, Key about) {
  const std::string unless = fmt::format("{0}1, {0}2, ...", kind);
  about.unless = unless.c_str();
  property("name", Json::object({{"type", Json::text("string")}, {"minLength", Json::number(1)}}), about);
}

void SchemaVisitor::names(const char* key, const std::vector<std::string>&, const std::vector<Location>*,
                          const Words& choices, const Key& about) {
  Json entry = any_name();
  if (!choices.empty()) entry = Json::object({{"enum", Json::texts({choices.begin(), choices.end()})}});
  property(key, list(entry, {choices.empty() ? 0 : 1}).set("uniqueItems", Json::boolean(true)), about);
}

void SchemaVisitor::whole(const char* key, long, long, const model::Bounds& bounds, const Key& about) {
  Json schema = Json::object({{"type", Json::text("integer")}});
  const model::Bounds none;
  if (bounds.least != none.least) schema.set("minimum", Json::number(bounds.least));
  if (bounds.most != none.most) schema.set("maximum", Json::number(bounds.most));
  property(key, schema, about);
}

void SchemaVisitor::contact_limits(const char* key, const std::optional<std::vector<model::ContactLimitDescription>>&,
                                   const Location&, const Key& about) {
  const Json by_name = Json::object({{"type", Json::text("object")},
                                     {"minProperties", Json::number(1)},
                                     {"additionalProperties", reference("quantity")}});
  const Json sliding = Json::object({{"type", Json::text("object")},
                                     {"properties", Json::object({{"sliding", by_name}})},
                                     {"required", Json::texts({"sliding"})},
                                     {"additionalProperties", Json::boolean(false)}});
  const Json word = Json::object({{"enum", Json::texts({"open", "stuck", "frictionless", "static"})}});
  property(key, list(one_of({word, sliding}), {1}), about);
}

void SchemaVisitor::section_forces(const char* key, const model::SectionForcesDescription&, const Key& about) {
  property(key,
           one_of({Json::object({{"type", Json::text("boolean")}}),
                   list(Json::object({{"type", Json::text("string")}})).set("uniqueItems", Json::boolean(true))}),
           about);
}

void SchemaVisitor::distributions(const char* key, const std::vector<model::DistributionDescription>&,
                                  const Key& about) {
  property(key,
           Json::object({{"type", Json::text("object")},
                         {"minProperties", Json::number(1)},
                         {"additionalProperties", of<model::DistributionDescription>().schema()}}),
           about);
}

void SchemaVisitor::parameters(const char* key, const std::vector<model::ParameterDescription>&, const Key& about) {
  const char* names = R"({"pattern": "^[A-Za-z_][A-Za-z0-9_]*$", "not": {"enum": ["t", "pi"]}})";
  property(key,
           Json::object({{"type", Json::text("object")},
                         {"propertyNames", Json::raw(names)},
                         {"additionalProperties", reference("quantity")}}),
           about);
}

void SchemaVisitor::analyses(const char* key, const std::vector<model::AnalysisDescription>&, const Key& about) {
  Json types = Json::array();
  model::analysis_types([&]<class Task>(const char* type, const char* says) {
    SchemaVisitor one;
    model::AnalysisDescription analysis;
    name_field(one, analysis);
    one.property("type", Json::object({{"const", Json::text(type)}}), {.required = true, .says = says});
    fields(one, analysis.task.emplace<Task>());
    types.add(one.schema());
  });
  property(key, list(Json::object({{"oneOf", types}}), {1}), about);
}

void SchemaVisitor::excludes(const char* first, const char* second) {
  rules_.push_back(Json::object({{"not", Json::object({{"required", Json::texts({first, second})}})}}));
}

void SchemaVisitor::requires_beside(const char* key, const char* other) {
  rules_.push_back(Json::object({{"dependentRequired", Json::object({{key, Json::texts({other})}})}}));
}

void SchemaVisitor::of_words(const char* type, const std::vector<std::pair<const char*, Words>>& takers) {
  std::vector<std::string> all;
  for (const auto& [word, keys] : takers) {
    all.insert(all.end(), keys.begin(), keys.end());
    rules_.push_back(Json::object(
        {{"if", Json::object({{"properties", Json::object({{type, Json::object({{"const", Json::text(word)}})}})}})},
         {"then", Json::object({{"required", Json::texts({keys.begin(), keys.end()})}})}}));
    std::erase_if(required_, [&, &own = keys](const std::string& key) {
      return std::find(own.begin(), own.end(), key) != own.end();
    });
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (std::find(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(i), all[i]) !=
        all.begin() + static_cast<std::ptrdiff_t>(i))
      continue;
    Words words;
    for (const auto& [word, keys] : takers)
      if (std::find(keys.begin(), keys.end(), all[i]) != keys.end()) words.push_back(word);
    only_for(all[i].c_str(), type, words);
  }
}

Json SchemaVisitor::list(Json entry, const model::Size& size) {
  Json list = Json::object({{"type", Json::text("array")}, {"items", std::move(entry)}});
  if (size.least > 0) list.set("minItems", Json::number(size.least));
  if (size.most != model::Size{}.most) list.set("maxItems", Json::number(size.most));
  return list;
}

Json SchemaVisitor::requirements(const Words& keys) {
  Json all = Json::array();
  for (const char* key : keys) all.add(Json::object({{"required", Json::texts({key})}}));
  return all;
}

void SchemaVisitor::only_for(const char* key, const char* type, const Words& words) {
  const Json those = Json::object({{"enum", Json::texts({words.begin(), words.end()})}});
  rules_.push_back(Json::object({{"if", Json::object({{"required", Json::texts({key})}})},
                                 {"then", Json::object({{"properties", Json::object({{type, those}})}})}}));
}

void SchemaVisitor::take_one_of(const std::vector<SchemaVisitor>& all) {
  std::vector<std::string> keys;
  for (const SchemaVisitor& one : all)
    for (std::size_t i = 0; i < one.keys().size(); ++i)
      if (!properties_.has(one.keys()[i])) {
        properties_.set(one.keys()[i], one.properties_.values()[i]);
        keys.push_back(one.keys()[i]);
      }
  for (const std::string& key : all.front().required_)
    if (std::all_of(all.begin(), all.end(), [&](const SchemaVisitor& one) {
          return std::find(one.required_.begin(), one.required_.end(), key) != one.required_.end();
        }))
      required_.push_back(key);
  Json choices = Json::array();
  for (const SchemaVisitor& one : all) {
    Json choice = Json::object();
    if (!one.required_.empty()) choice.set("required", Json::texts(one.required_));
    const std::vector<std::string> foreign = without(keys, one.keys());
    if (!foreign.empty())
      choice.set("not", Json::object({{"anyOf", requirements([&] {
                                         Words words;
                                         for (const std::string& key : foreign) words.push_back(key.c_str());
                                         return words;
                                       }())}}));
    if (!one.rules_.empty()) choice.set("allOf", Json::array(one.rules_));
    choices.add(choice);
  }
  rules_.push_back(Json::object({{"oneOf", choices}}));
}

}  // namespace rubato::io
