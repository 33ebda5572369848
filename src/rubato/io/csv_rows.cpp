#include <rubato/io/csv_rows.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace rubato::io {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\"");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

void split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  const char separator = line.find(';') != std::string_view::npos ? ';' : ',';
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    fields.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
}

}  // namespace

void for_each_csv_row(
    std::string_view text, const std::string& place,
    const std::function<void(const std::vector<std::string_view>& fields, const Location& here)>& take) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // spreadsheets write this mark
  std::vector<std::string_view> fields;
  Location here{place, 0, 0};
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    ++here.line;
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    split(line, fields);
    take(fields, here);
  }
}

double csv_number(std::string_view field, const std::string& name, const Location& here) {
  std::string_view digits = field;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (fault != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
    throw InvalidInput(here, fmt::format("{} must be a finite number, got \"{}\"", name, field.substr(0, 60)));
  return value;
}

}  // namespace rubato::io
