#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <string_view>

namespace rubato::io {
namespace {

constexpr std::uintmax_t largest_table = 512u << 20;

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

bool to_number(std::string_view text, double& value) {
  text = trimmed(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  return fault == std::errc() && end == text.data() + text.size();
}

// A first row with a slip in its time must not pass for a header.
bool begins_like_a_number(std::string_view line) {
  return std::string_view("0123456789+-.").find(line.front()) != std::string_view::npos;
}

/// "N*m", "N·m" and "Nm" alike; m/s^2 and m/s² as m/s2.
std::string plain_unit(std::string_view unit) {
  std::string plain;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    if (unit.substr(i, 2) == "\xc2\xb7") {
      ++i;
    } else if (unit.substr(i, 2) == "\xc2\xb2") {
      plain += '2';
      ++i;
    } else if (std::string_view(" *.^").find(unit[i]) == std::string_view::npos) {
      plain += unit[i];
    }
  }
  return plain;
}

void require_unit(std::string_view head, const std::string& column, const std::vector<std::string>& units,
                  const Location& here) {
  const auto open = head.find('['), close = head.find(']', open == std::string_view::npos ? 0 : open);
  if (open == std::string_view::npos || close == std::string_view::npos) return;
  const std::string_view given = head.substr(open + 1, close - open - 1);
  for (const std::string& unit : units)
    if (plain_unit(given) == plain_unit(unit)) return;
  throw InvalidInput(here, fmt::format("the header says that the {} is in [{}], and it is read in [{}]; convert the "
                                       "column, and write [{}]",
                                       column, given, fmt::join(units, "] or ["), units.front()));
}

}  // namespace

model::TableDescription read_table(const std::string& file, const StudyFolder& folder, const Location& where,
                                   const std::vector<std::string>& units, const TableOver& over) {
  std::string text = folder.read(file, where, largest_table, "the table");
  const std::string place = folder.place_of(file);
  refuse_binary(text, place, fmt::format("a table is a text of two columns, {} and value", over.name));
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);  // spreadsheets write this mark
  model::TableDescription table;
  table.file = file;
  table.where = where;
  int line_number = 0;
  bool header_allowed = true;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = trimmed(std::string_view(text).substr(begin, end - begin));
    begin = end + 1;
    ++line_number;
    const Location here{place, line_number, 0};
    if (line.empty() || line.front() == '#') continue;
    const auto separator = line.find_first_of(",;\t");
    double time = 0.0, value = 0.0;
    const bool is_pair = separator != std::string_view::npos && to_number(line.substr(0, separator), time) &&
                         to_number(line.substr(separator + 1), value);
    const bool is_header = header_allowed && !is_pair && !begins_like_a_number(line);
    header_allowed = false;
    if (is_header) {
      require_unit(line.substr(0, separator), over.name, {over.unit}, here);
      if (separator != std::string_view::npos) require_unit(line.substr(separator + 1), "value", units, here);
      continue;
    }
    if (!is_pair)
      throw InvalidInput(here, fmt::format("a row must be two numbers, {} and value, with a comma between them; got "
                                           "\"{}\"",
                                           over.name, line.substr(0, 60)));
    if (!std::isfinite(time) || !std::isfinite(value))
      throw InvalidInput(here, fmt::format("a number is not finite: \"{}\"", line.substr(0, 60)));
    if (!table.times.empty() && time < table.times.back())
      throw InvalidInput(here, fmt::format("{}s must not fall: {} after {}", over.name, time, table.times.back()));
    if (table.times.size() > 1 && time == table.times.back() && time == table.times[table.times.size() - 2])
      throw InvalidInput(here, fmt::format("more than two rows at the {} {}; two are a jump", over.name, time));
    table.times.push_back(time);
    table.values.push_back(value);
  }
  if (table.times.size() < 2)
    throw InvalidInput({place, 0, 0},
                       fmt::format("the table has {} row(s) of numbers; it needs two or more", table.times.size()));
  return table;
}

}  // namespace rubato::io
