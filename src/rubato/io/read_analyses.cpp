#include <rubato/io/read_parts.hpp>
#include <rubato/io/read_step.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace rubato::io {
namespace {

using namespace model;

ObservationDescription to_observation(const std::string& text, const Location& where) {
  const std::size_t minus = text.find(" - ");
  if (minus == std::string::npos) return {text, "", where};
  return {text.substr(0, minus), text.substr(minus + 3), where};
}

}  // namespace

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

std::optional<std::vector<ObservationDescription>> read_observe(TomlReader& reader) {
  std::vector<Location> places;
  std::optional<std::vector<std::string>> texts;
  if (const toml::node* node = reader.node("observe"); node && !node->is_array()) {
    places.emplace_back();
    texts = {reader.name("observe", &places.front())};
  } else {
    texts = reader.optional_texts("observe", &places);
  }
  if (!texts) return std::nullopt;
  std::vector<ObservationDescription> observations;
  for (std::size_t i = 0; i < texts->size(); ++i) {
    const std::string& text = (*texts)[i];
    if (std::find(texts->begin(), texts->begin() + static_cast<std::ptrdiff_t>(i), text) !=
        texts->begin() + static_cast<std::ptrdiff_t>(i))
      throw InvalidInput(places[i], fmt::format("{}: observe names \"{}\" twice", reader.what(), text));
    observations.push_back(to_observation(text, places[i]));
  }
  return observations;
}

namespace {

/// true, or the names of beams.
SectionForcesDescription read_section_forces(TomlReader& reader) {
  SectionForcesDescription wanted;
  const toml::node* node = reader.node("section_forces");
  wanted.where = reader.where("section_forces");
  if (node && node->is_boolean()) {
    wanted.of_all = reader.optional_bool("section_forces").value_or(false);
  } else {
    std::vector<Location> places;
    if (const auto names = reader.optional_texts("section_forces", &places))
      for (std::size_t i = 0; i < names->size(); ++i) wanted.beams.push_back({(*names)[i], "", places[i]});
  }
  return wanted;
}

OutputDescription read_output(TomlReader& reader) {
  OutputDescription output;
  auto table = reader.optional_table("output", reader.what() + ": output");
  if (!table) return output;
  output.where = table->where();
  const auto every = table->optional_integer("every");
  const auto interval = table->optional_quantity("interval");
  const auto times = table->optional_quantities("times");
  table->finish();
  if (every.has_value() + interval.has_value() + times.has_value() != 1)
    throw InvalidInput(table->where(),
                       fmt::format("{}: output needs exactly one of \"every\" (steps), \"interval\" [s] "
                                   "and \"times\" [s]",
                                   reader.what()));
  if (every) {
    output.kind = OutputDescription::Kind::every;
    if (*every < 1 || *every > 2'000'000'000)
      throw InvalidInput(table->where("every"), fmt::format("every must be at least 1, got {}", *every));
    output.every = static_cast<int>(*every);
  } else if (interval) {
    output.kind = OutputDescription::Kind::interval;
    output.interval = *interval;
  } else {
    output.kind = OutputDescription::Kind::times;
    output.times = *times;
  }
  return output;
}

/// The [[displacement]]s that are held; all of them unless listed.
StaticDescription read_static(TomlReader& reader) {
  StaticDescription equilibrium;
  std::vector<Location> places;
  if (const auto names = reader.optional_texts("displacements", &places)) {
    equilibrium.displacements.emplace();
    for (std::size_t i = 0; i < names->size(); ++i) equilibrium.displacements->push_back({(*names)[i], "", places[i]});
  }
  return equilibrium;
}

TransientDescription read_transient(TomlReader& reader) {
  TransientDescription transient;
  if (const toml::node* method = reader.node("method")) transient.method = to_method(reader, *method, "method");
  if (const toml::node* step = reader.node("step")) {
    if (const auto* table = step->as_table())
      transient.automatic_step = read_step(reader, *table);
    else
      transient.step = reader.quantity("step");
  }
  transient.duration = reader.quantity("duration");
  transient.output = read_output(reader);
  transient.observe = read_observe(reader);
  transient.section_forces = read_section_forces(reader);
  transient.energy = reader.optional_bool("energy").value_or(true);
  transient.allow_unstable = reader.optional_bool("allow_unstable").value_or(false);
  transient.project_velocities = reader.optional_bool("project_velocities").value_or(false);
  transient.project_velocities_where = reader.where("project_velocities");
  if (reader.optional_word("initial", {"given", "static"}) == "static")
    transient.initial = read_static(reader);
  else if (reader.has("displacements"))
    throw InvalidInput(reader.where("displacements"),
                       reader.what() + ": displacements are held in the static start; add initial = \"static\"");
  return transient;
}

MethodStudyDescription read_method_study(TomlReader& reader) {
  MethodStudyDescription study;
  if (const toml::node* methods = reader.node("methods")) {
    const auto* list = methods->as_array();
    if (!list || list->empty()) reader.refuse_type(*methods, "methods", "a list of methods");
    for (const toml::node& entry : *list) study.methods.push_back(to_method(reader, entry, "methods"));
  }
  study.step = reader.quantity("step");
  study.duration = reader.quantity("duration");
  study.ladder = reader.optional_quantities("ladder").value_or(std::vector<Quantity>{});
  if (const auto observe = reader.optional_text("observe"))
    study.observe = to_observation(*observe, reader.where("observe"));
  study.as_printed = reader.optional_bool("as_printed").value_or(false);
  return study;
}

/// { analysis = "NAME", time = 1.2, static = true }
ReachedDescription read_reached(TomlReader& reader) {
  ReachedDescription reached;
  auto inner = reader.optional_table("about", fmt::format("{}: about", reader.what()));
  reached.where = inner->where();
  reached.analysis = inner->text("analysis");
  reached.analysis_where = inner->where("analysis");
  reached.time = inner->optional_quantity("time");
  reached.settles = inner->optional_bool("static").value_or(false);
  inner->finish();
  return reached;
}

ModesDescription read_modes(TomlReader& reader) {
  ModesDescription modes;
  modes.count = reader.optional_quantity("count");
  modes.observe = read_observe(reader);
  const toml::node* about = reader.node("about");
  if (about && about->is_table())
    modes.about_reached = read_reached(reader);
  else if (reader.optional_word("about", {"given", "static"}) == "static")
    modes.about_equilibrium = reader.where("about");
  return modes;
}

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

std::vector<AnalysisDescription> read_analyses(TomlReader& root, const StudyFolder& folder) {
  const std::vector<std::string> known{"transient",          "method_study", "modes",
                                       "frequency_response", "damper_curve", "static"};
  std::vector<AnalysisDescription> analyses;
  for (TomlReader& reader : root.tables("analysis")) {
    AnalysisDescription analysis;
    analysis.where = reader.where();
    analysis.name = reader.text("name");
    reader.rename(fmt::format("analysis \"{}\"", analysis.name));
    require_name(analysis.name, analyses, reader.where("name"));
    const std::string type = reader.text("type");
    (void)reader.optional_word("type", known);
    if (type == "transient")
      analysis.task = read_transient(reader);
    else if (type == "modes")
      analysis.task = read_modes(reader);
    else if (type == "frequency_response")
      analysis.task = read_frequency_response(reader, folder);
    else if (type == "damper_curve")
      analysis.task = read_damper_curve(reader, folder);
    else if (type == "static") {
      StaticDescription equilibrium = read_static(reader);
      equilibrium.observe = read_observe(reader);
      equilibrium.section_forces = read_section_forces(reader);
      analysis.task = equilibrium;
    } else
      analysis.task = read_method_study(reader);
    reader.finish();
    analyses.push_back(std::move(analysis));
  }
  return analyses;
}

}  // namespace rubato::io
