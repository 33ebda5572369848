#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace rubato::io {
namespace {

constexpr std::uintmax_t largest_list = 512u << 20;

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\"");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  const char separator = line.find(';') != std::string_view::npos ? ';' : ',';
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    fields.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return fields;
}

double to_number(std::string_view text, const std::string& name, const Location& here) {
  std::string_view digits = text;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (fault != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
    throw InvalidInput(here, fmt::format("{} must be a finite number, got \"{}\"", name, text.substr(0, 60)));
  return value;
}

void take_header(const std::vector<std::string_view>& fields, const Location& here,
                 model::CaseSweepDescription& cases) {
  for (const std::string_view field : fields) {
    double number = 0.0;
    const bool is_number =
        std::from_chars(field.data(), field.data() + field.size(), number).ptr == field.data() + field.size();
    if (field.empty() || is_number)
      throw InvalidInput(here, fmt::format("the first row must name the parameters of the columns, got \"{}\"", field));
    const std::string name(field);
    if (std::find(cases.names.begin(), cases.names.end(), name) != cases.names.end())
      throw InvalidInput(here, fmt::format("two columns are called \"{}\"", name));
    cases.names.push_back(name);
  }
}

}  // namespace

model::CaseSweepDescription read_cases(const std::string& file, const std::filesystem::path& folder,
                                       const Location& where) {
  std::string text = read_text(folder / file, file, where, largest_list, "the list of cases");
  const std::string place = file_in(folder, file);
  refuse_binary(text, place, "a list of cases is a text: a header with names of parameters, and rows of numbers");
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);  // spreadsheets write this mark
  model::CaseSweepDescription cases;
  cases.file = file;
  cases.where = where;
  int line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    const Location here{place, ++line_number, 0};
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    const auto fields = fields_of(line);
    if (cases.names.empty()) {
      take_header(fields, here, cases);
      continue;
    }
    if (fields.size() != cases.names.size())
      throw InvalidInput(here, fmt::format("{} numbers for {} parameters; each row gives all of them", fields.size(),
                                           cases.names.size()));
    for (std::size_t i = 0; i < fields.size(); ++i) cases.values.push_back(to_number(fields[i], cases.names[i], here));
  }
  if (cases.values.empty())
    throw InvalidInput({place, 0, 0}, "the list of cases has no rows; it needs a header and a row a case");
  return cases;
}

}  // namespace rubato::io
