#include <rubato/integrate/catalogue.hpp>
#include <rubato/io/schema.hpp>
#include <rubato/io/schema_visitor.hpp>
#include <rubato/model/fields/study_fields.hpp>
#include <rubato/model/fields/sweep_fields.hpp>

#include <fmt/format.h>

namespace rubato::io {
namespace {

using namespace model;

Json with_description(Json schema, const std::string& text) { return schema.set("description", Json::text(text)); }

/// A method's name, or a table of its name and parameters.
Json method_schema() {
  SchemaVisitor table;
  table.property("name", SchemaVisitor::reference("method_name"), {.required = true});
  std::vector<std::string> names;
  for (const auto& method : integrate::catalogue())
    for (const auto& parameter : method.parameters)
      if (std::find(names.begin(), names.end(), parameter.name) == names.end()) names.push_back(parameter.name);
  for (const std::string& name : names) {
    std::vector<std::string> takers;
    for (const auto& method : integrate::catalogue())
      for (const auto& parameter : method.parameters)
        if (parameter.name == name) takers.push_back(fmt::format("{} ({})", method.name, parameter.range));
    const std::string says = fmt::format("of {}", fmt::join(takers, ", "));
    table.property(name, SchemaVisitor::reference("quantity"), {.says = says.c_str()});
  }
  return SchemaVisitor::one_of({SchemaVisitor::reference("method_name"), table.schema()});
}

Json method_names() {
  std::vector<std::string> names;
  for (const auto& method : integrate::catalogue()) names.push_back(method.name);
  return Json::object({{"enum", Json::texts(names)}});
}

Json sweep_schema() {
  const Json grid = Json::object({{"type", Json::text("object")},
                                  {"minProperties", Json::number(1)},
                                  {"additionalProperties", SchemaVisitor::reference("values")}});
  return SchemaVisitor::one_of(
      {grid, SchemaVisitor::of<CaseSweepDescription>().schema(), SchemaVisitor::of<RandomSweepDescription>().schema()});
}

Json between_schema() {
  const Json end = with_description(SchemaVisitor::any_name(), "a coordinate: its name, or its number with [matrices]");
  return with_description(SchemaVisitor::list(end, {2, 2}), "the two coordinates it joins, or \"ground\"");
}

Json definitions() {
  const Json quantity =
      Json::object({{"description", Json::text("a number, or an expression of the parameters in quotes")},
                    {"type", Json::texts({"number", "string"})},
                    {"minLength", Json::number(1)}});
  const Json quantities = SchemaVisitor::list(SchemaVisitor::reference("quantity"), {1});
  return Json::object(
      {{"quantity", quantity},
       {"between", between_schema()},
       {"method_name", method_names()},
       {"method", method_schema()},
       {"values", with_description(SchemaVisitor::one_of({quantities, SchemaVisitor::of<ValuesDescription>().schema()}),
                                   "a list, or a range with both ends")},
       {"frequency_range", SchemaVisitor::of<PeakRangeDescription>().schema()},
       {"sweep", sweep_schema()}});
}

}  // namespace

std::string study_schema() {
  Json schema =
      Json::object({{"$schema", Json::text("https://json-schema.org/draft/2020-12/schema")},
                    {"title", Json::text("Rubato study")},
                    {"description",
                     Json::text("A model, its parameters, and the analyses to run on it. SI units. Every number may be "
                                "an expression in quotes.")}});
  const Json study = SchemaVisitor::of<StudyDescription>().schema();
  for (std::size_t i = 0; i < study.names().size(); ++i) schema.set(study.names()[i], study.values()[i]);
  schema.set("$defs", definitions());
  return schema.written() + "\n";
}

const std::vector<std::string>& study_keys() {
  static const std::vector<std::string> keys = keys_of<StudyDescription>();
  return keys;
}

}  // namespace rubato::io
