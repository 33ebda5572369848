#include <rubato/core/excerpt.hpp>
#include <rubato/io/read_study.hpp>
#include <rubato/io/reading_visitor.hpp>
#include <rubato/io/toml_limits.hpp>
#include <rubato/model/fields/study_fields.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <sstream>

namespace rubato::io {
namespace {

constexpr std::uintmax_t largest_study = 16u << 20;  // large models come from matrix and table files

void require_text(const std::string& text, const std::string& name) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    throw InvalidInput({name, 0, 0}, "the file is empty; `rubato example` shows what a study looks like");
  refuse_binary(text, name, "a study is a TOML text");
}

// toml++ reports an unclosed quote as the line break that it runs into.
/// What follows a place in the text on its line. Lines and columns count from 1, columns in characters.
std::string_view rest_of_line(std::string_view text, const toml::source_position& place) {
  for (toml::source_index line = 1; line < place.line; ++line) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  text = text.substr(0, text.find_first_of("\r\n"));
  for (toml::source_index column = 1; column < place.column && !text.empty(); ++column) {
    text.remove_prefix(1);
    while (!text.empty() && (static_cast<unsigned char>(text.front()) & 0xC0u) == 0x80u) text.remove_prefix(1);
  }
  return text;
}

/// What is probably meant where a text is no TOML; or nothing.
std::string syntax_hint(std::string_view description, std::string_view text, const toml::source_position& place) {
  const auto tells = [&](std::string_view words) { return description.find(words) != std::string_view::npos; };
  if (tells("unescaped control characters")) return " (is the closing quote missing?)";
  const std::string_view rest = rest_of_line(text, place);
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; };
  if (tells("could not be interpreted as a value")) return "; numbers go up to 1.8e308";
  if (tells("could not determine value type") && !rest.empty() && is_letter(rest.front())) {
    const std::string_view word = rest.substr(0, rest.find_first_of(",]}#"));
    const std::string_view trimmed = word.substr(0, word.find_last_not_of(" \t") + 1);
    return fmt::format("; texts and formulas stand in quotes: \"{}\"", excerpt(trimmed));
  }
  if (tells("saw ','") && rest.size() > 1 && std::isdigit(static_cast<unsigned char>(rest[1])))
    return "; decimals are written with a point, 1.5";
  return "";
}

/// Where [matrices] names its coordinates, their numbers serve in `observe` too.
void name_by_number(const std::vector<std::string>& names, model::ObservationDescription& observation) {
  for (std::string* name : {&observation.first, &observation.second}) {
    std::size_t number = 0;
    const auto [end, fault] = std::from_chars(name->data(), name->data() + name->size(), number);
    if (fault == std::errc() && end == name->data() + name->size() && number >= 1 && number <= names.size() &&
        std::find(names.begin(), names.end(), *name) == names.end())
      *name = names[number - 1];
  }
}

void name_by_number(model::StudyDescription& study) {
  if (!study.model.matrices) return;
  const auto& names = study.model.matrices->names;
  const auto name_all = [&](auto& task) {
    if constexpr (requires { task.observe->begin(); }) {
      if (!task.observe) return;
      for (auto& observation : *task.observe) name_by_number(names, observation);
    } else if constexpr (requires { task.observe; }) {
      if (task.observe) name_by_number(names, *task.observe);
    }
  };
  for (auto& analysis : study.analyses) std::visit(name_all, analysis.task);
}

/// What stands in place of tables that users look for.
void note_elsewhere(TomlReader& root) {
  for (const auto& type : model::joint_types())
    root.note_elsewhere(type.word, fmt::format("write [[joint]] with type = \"{}\"", type.word));
  root.note_elsewhere("hinge", "write [[joint]] with type = \"revolute\"");
}

}  // namespace

std::vector<model::ParameterDescription> read_parameters(TomlReader& root, const std::string& key) {
  std::vector<model::ParameterDescription> parameters;
  const auto values = root.optional_quantities_by_name(key);
  if (!values) return parameters;
  for (const auto& [name, value] : *values) {
    if (name == "t" || name == "pi")
      throw InvalidInput(value.where, fmt::format("parameter \"{}\": the name is taken ({}); choose another", name,
                                                  name == "t" ? "the time" : "3.14159..."));
    if (name.empty() || !(std::isalpha(static_cast<unsigned char>(name[0])) || name[0] == '_') ||
        name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") != std::string::npos)
      throw InvalidInput(value.where,
                         fmt::format("parameter \"{}\": a name is letters, digits and underscores, and does "
                                     "not begin with a digit",
                                     name));
    if (numerics::is_function(name))
      throw InvalidInput(value.where,
                         fmt::format("parameter \"{0}\": the name is taken (the function {0}); choose another", name));
    parameters.push_back({name, value, value.where});
  }
  // toml++ sorts keys; a parameter may use those before it in the file.
  std::stable_sort(parameters.begin(), parameters.end(), [](const auto& a, const auto& b) {
    return std::pair(a.where.line, a.where.column) < std::pair(b.where.line, b.where.column);
  });
  return parameters;
}

void refuse_binary(const std::string& text, const std::string& file, const std::string& expected) {
  const std::size_t zero = text.find('\0');
  if (zero != std::string::npos)
    throw InvalidInput({file, 0, 0}, fmt::format("the file is binary (byte {} is zero); {}", zero + 1, expected));
}

std::string read_text(const std::filesystem::path& path, const std::string& name, const Location& where,
                      std::uintmax_t limit, const std::string& what, const std::string& remedy) {
  namespace fs = std::filesystem;
  std::error_code fault;
  const fs::file_status status = fs::status(path, fault);
  if (!fs::exists(status)) throw InvalidInput(where, fmt::format("{} \"{}\" does not exist", what, name));
  if (fs::is_directory(status)) throw InvalidInput(where, fmt::format("{} \"{}\" is a folder, not a file", what, name));
  const std::uintmax_t size = fs::is_regular_file(status) ? fs::file_size(path, fault) : 0;
  if (size > limit)
    throw InvalidInput(where, fmt::format("{} \"{}\" has {} MB, more than the {} MB that are read{}", what, name,
                                          size >> 20, limit >> 20, remedy));
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw InvalidInput(where, fmt::format("{} \"{}\" cannot be opened: {}", what, name, std::strerror(errno)));
  std::string text;
  text.reserve(size);  // growing by copies would take three times the memory
  std::vector<char> chunk(1u << 16);
  while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())), stream.gcount() > 0) {
    text.append(chunk.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > limit)
      throw InvalidInput(where,
                         fmt::format("{} \"{}\" has more than the {} MB that are read", what, name, limit >> 20));
  }
  return text;
}

model::StudyDescription read_study_text(const std::string& text, const std::string& name,
                                        const std::filesystem::path& path, SourceFiles* files) {
  const StudyFolder folder(path, files);
  require_text(text, name);
  require_moderate_keys(text, name);
  toml::table table;
  try {
    table = toml::parse(text, name);
  } catch (const toml::parse_error& fault) {
    const auto& begin = fault.source().begin;
    throw InvalidInput(
        {name, static_cast<int>(begin.line), static_cast<int>(begin.column)},
        fmt::format("this is no TOML: {}{}", fault.description(), syntax_hint(fault.description(), text, begin)));
  }
  TomlReader root(table, "the study", name);
  model::StudyDescription study;
  study.file = name;
  study.text = text;
  note_elsewhere(root);
  ReadingVisitor(root, folder).read(study);
  if (!root.has("title")) study.title = std::filesystem::path(name).stem().string();
  name_by_number(study);
  keep_observed(study);
  return study;
}

model::StudyDescription read_study(const std::filesystem::path& path, SourceFiles* files) {
  const std::string name = path.string();
  const std::string text = read_text(path, name, {}, largest_study, "the study",
                                     "; give large models as [matrices] and long loads as tables");
  return read_study_text(text, name, path.has_parent_path() ? path.parent_path() : std::filesystem::path("."), files);
}

}  // namespace rubato::io
