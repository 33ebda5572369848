#include <rubato/io/read_parts.hpp>
#include <rubato/io/read_study.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

namespace rubato::io {
namespace {

constexpr std::uintmax_t largest_study = 16u << 20;  // large models come from matrix and table files

void require_text(const std::string& text, const std::string& name) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    throw InvalidInput({name, 0, 0}, "the file is empty; `rubato example` shows what a study looks like");
  const std::size_t zero = text.find('\0');
  if (zero != std::string::npos)
    throw InvalidInput({name, 0, 0},
                       fmt::format("the file is binary (byte {} is zero); a study is a TOML text", zero + 1));
}

std::vector<model::ParameterDescription> read_parameters(TomlReader& root) {
  std::vector<model::ParameterDescription> parameters;
  const auto values = root.optional_quantities_by_name("parameters");
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
    parameters.push_back({name, value, value.where});
  }
  // toml++ sorts keys; a parameter may use those before it in the file.
  std::stable_sort(parameters.begin(), parameters.end(), [](const auto& a, const auto& b) {
    return std::pair(a.where.line, a.where.column) < std::pair(b.where.line, b.where.column);
  });
  return parameters;
}

}  // namespace

std::string read_text(const std::filesystem::path& path, const std::string& name, const Location& where,
                      std::uintmax_t limit, const std::string& what) {
  namespace fs = std::filesystem;
  std::error_code fault;
  const fs::file_status status = fs::status(path, fault);
  if (!fs::exists(status)) throw InvalidInput(where, fmt::format("{} \"{}\" does not exist", what, name));
  if (fs::is_directory(status)) throw InvalidInput(where, fmt::format("{} \"{}\" is a folder, not a file", what, name));
  const std::uintmax_t size = fs::is_regular_file(status) ? fs::file_size(path, fault) : 0;
  if (size > limit)
    throw InvalidInput(where, fmt::format("{} \"{}\" has {} MB, more than the {} MB that are read", what, name,
                                          size >> 20, limit >> 20));
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw InvalidInput(where, fmt::format("{} \"{}\" cannot be opened: {}", what, name, std::strerror(errno)));
  std::string text;
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
                                        const std::filesystem::path& folder) {
  require_text(text, name);
  toml::table table;
  try {
    table = toml::parse(text, name);
  } catch (const toml::parse_error& fault) {
    const auto& begin = fault.source().begin;
    throw InvalidInput({name, static_cast<int>(begin.line), static_cast<int>(begin.column)},
                       fmt::format("this is no TOML: {}", fault.description()));
  }
  TomlReader root(table, "the study", name);
  model::StudyDescription study;
  study.file = name;
  study.text = text;
  study.title = root.optional_text("title").value_or(std::filesystem::path(name).stem().string());
  study.parameters = read_parameters(root);
  study.model = read_model(root, folder);
  study.analyses = read_analyses(root);
  root.finish();
  return study;
}

model::StudyDescription read_study(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string text = read_text(path, name, {}, largest_study, "the study");
  return read_study_text(text, name, path.has_parent_path() ? path.parent_path() : std::filesystem::path("."));
}

}  // namespace rubato::io
