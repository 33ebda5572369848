#include <rubato/io/reading_visitor.hpp>
#include <rubato/model/fields/analysis_fields.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace rubato::io {

using namespace model;

ObservationDescription to_observation(const std::string& text, const Location& where) {
  const std::size_t minus = text.find(" - ");
  if (minus == std::string::npos) return {text, "", where};
  return {text.substr(0, minus), text.substr(minus + 3), where};
}

MethodDescription to_method(TomlReader& reader, const toml::node& node, const std::string& key) {
  MethodDescription method;
  method.where = reader.location(node);
  if (const auto* name = node.as_string()) {
    method.name = name->get();
    return method;
  }
  const auto* table = node.as_table();
  if (!table) reader.refuse_type(node, key, "a method's name, or a table such as { name = \"hht\", alpha = -0.05 }");
  TomlReader inner(*table, reader.what() + ": " + key, reader.file());
  method.name = inner.text("name");
  for (const auto& [parameter, value] : *table) {
    const std::string word(parameter.str());
    if (word != "name") method.parameters.emplace_back(word, inner.quantity(word));
  }
  return method;
}

namespace {

/// The name of an analysis is that of files in the folder of results, and of a group of netCDF, which both have rules.
bool is_fit(const std::string& name) {
  constexpr std::size_t longest = 200;  // bytes: file systems take 255, and ".waveforms.csv.partial" follows
  const auto is_unfit = [](unsigned char c) { return c < 0x20 || c == 0x7f || c == '/' || c == '\\' || c == '.'; };
  if (name.empty() || name.size() > longest || std::any_of(name.begin(), name.end(), is_unfit)) return false;
  const auto first = static_cast<unsigned char>(name.front());
  if (!(std::isalnum(first) || first == '_' || first >= 0x80) || name.back() == ' ') return false;
  // Accents that follow their letter (U+0300 to U+036F): netCDF joins the two, and the name is another then.
  for (std::size_t i = 0; i + 1 < name.size(); ++i) {
    const auto c = static_cast<unsigned char>(name[i]), next = static_cast<unsigned char>(name[i + 1]);
    if (c == 0xcc || (c == 0xcd && next <= 0xaf)) return false;
  }
  return name != "results";
}

bool differ_in_case_alone(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

void require_name(const std::string& name, const std::vector<AnalysisDescription>& before, const Location& where) {
  constexpr std::size_t most_told = 60;
  if (!is_fit(name))
    throw InvalidInput(
        where,
        fmt::format("the analysis name \"{}{}\" becomes the name of files and of a netCDF group: it begins with a "
                    "letter, a digit or an underscore, has at most 200 bytes, holds no slash, dot, control "
                    "character or separate accent, does not end with a blank, and is not \"results\"",
                    name.substr(0, most_told), name.size() > most_told ? "..." : ""));
  for (const auto& other : before) {
    if (other.name == name)
      throw InvalidInput(
          where, fmt::format("two analyses are called \"{}\"; the first is on line {}", name, other.where.line));
    if (differ_in_case_alone(other.name, name))
      throw InvalidInput(where, fmt::format("the analyses \"{}\" (line {}) and \"{}\" differ in case alone, and some "
                                            "file systems would take their files for the same; rename one",
                                            other.name, other.where.line, name));
  }
}

}  // namespace

std::vector<AnalysisDescription> read_analyses(TomlReader& root, const std::string& key, const StudyFolder& folder) {
  std::vector<std::string> known;
  analysis_types([&]<class Task>(const char* type, const char*) { known.emplace_back(type); });
  std::vector<AnalysisDescription> analyses;
  for (TomlReader& reader : root.tables(key)) {
    AnalysisDescription analysis;
    ReadingVisitor visitor(reader, folder);
    name_field(visitor, analysis);
    require_name(analysis.name, analyses, reader.where("name"));
    const std::string type = reader.text("type");
    (void)reader.optional_word("type", known);
    analysis_types([&]<class Task>(const char* one, const char*) {
      if (one == type) visitor.read(analysis.task.emplace<Task>());
    });
    analyses.push_back(std::move(analysis));
  }
  return analyses;
}

}  // namespace rubato::io
