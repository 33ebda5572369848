#include <rubato/core/excerpt.hpp>
#include <rubato/io/csv_rows.hpp>
#include <rubato/io/finite_elements/read_rows.hpp>
#include <rubato/io/finite_elements/text_scanner.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <unordered_map>

namespace rubato::io {
namespace {

using model::RowLabel;

std::string lower(std::string_view text) {
  std::string word(text);
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word;
}

bool whole(std::string_view text, std::int64_t& number) {
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  return fault == std::errc() && end == text.data() + text.size();
}

/// A whole number as tables write it, also as 10.0 or 1.0e+01.
bool integral(std::string_view text, std::int64_t& number) {
  if (whole(text, number)) return true;
  constexpr double largest = 9e15;
  double value = 0.0;
  if (text.find_first_of(".eEdD") == std::string_view::npos || !fortran_number(text, value) ||
      !(std::abs(value) < largest) || value != std::floor(value))
    return false;
  number = static_cast<std::int64_t>(value);
  return true;
}

/// A direction as a number, as in the study (x, rx) or as Ansys has it (UX, ROTX); -1: none of them.
int direction_of(std::string_view text) {
  std::int64_t number = 0;
  if (integral(text, number)) return number >= 0 && number <= 6 ? static_cast<int>(number) : -1;
  static constexpr std::array<std::array<const char*, 2>, 6> words{
      {{"x", "ux"}, {"y", "uy"}, {"z", "uz"}, {"rx", "rotx"}, {"ry", "roty"}, {"rz", "rotz"}}};
  const std::string word = lower(text);
  for (std::size_t i = 0; i < words.size(); ++i)
    if (word == words[i][0] || word == words[i][1]) return static_cast<int>(i) + 1;
  return -1;
}

void require_row(const RowLabel& label, const Location& here, std::string_view node, std::string_view direction) {
  if (label.node < 1)
    throw InvalidInput(here, fmt::format("a node must be a whole number from 1 on, got \"{}\"", excerpt(node)));
  if (label.direction < 0)
    throw InvalidInput(here, fmt::format("a direction must be 1 to 6 (x, y, z, rx, ry, rz), or 0 of a generalized "
                                         "coordinate; got \"{}\"",
                                         excerpt(direction)));
}

/// Refuses a direction of a node that has a row already.
class RowNames {
 public:
  void add(const RowLabel& label, std::size_t row, const Location& here) {
    const auto [found, is_new] =
        rows_.emplace(static_cast<std::uint64_t>(label.node) * 8 + static_cast<std::uint64_t>(label.direction), row);
    if (!is_new)
      throw InvalidInput(here, fmt::format("row {} is {}, and so is row {}: each direction of a node has one row", row,
                                           model::name_of(label), found->second));
  }

 private:
  std::unordered_map<std::uint64_t, std::size_t> rows_;
};

/// NODE.DIRECTION a line: 12.1 and 12.10 would be the same number, so it is split at the point.
model::RowTable read_dof(std::string_view text, const std::string& place) {
  model::RowTable table;
  RowNames names;
  LineScanner lines(text, place);
  std::string_view line;
  while (lines.next(line)) {
    const std::string_view word = trimmed_blanks(line);
    if (word.empty()) continue;
    const std::size_t point = word.find('.');
    RowLabel label{0, -1};
    std::int64_t direction = 0;
    if (point == std::string_view::npos || !whole(word.substr(0, point), label.node) ||
        !whole(word.substr(point + 1), direction))
      throw InvalidInput(lines.here(),
                         fmt::format("a row must be NODE.DIRECTION, such as 305.1, got \"{}\"", excerpt(word)));
    label.direction = direction >= 1 && direction <= 6 ? static_cast<int>(direction) : -1;
    require_row(label, lines.here(), word.substr(0, point), word.substr(point + 1));
    table.labels.push_back(label);
    names.add(label, table.labels.size(), lines.here());
  }
  return table;
}

/// Rows in any order, each with its number.
class NumberedRows {
 public:
  void add(std::int64_t row, const RowLabel& label, const Location& here) {
    if (row < 1 || row > 2000000000) throw InvalidInput(here, fmt::format("rows count from 1, got {}", row));
    rows_.push_back({row, label, {}, here});
  }
  void place_at(const std::array<double, 3>& position) {
    rows_.back().position = position;
    has_positions_ = true;
  }
  model::RowTable table() {
    std::stable_sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) { return a.row < b.row; });
    model::RowTable table;
    RowNames names;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const auto wanted = static_cast<std::int64_t>(i) + 1;
      if (rows_[i].row < wanted) throw InvalidInput(rows_[i].here, fmt::format("row {} is given twice", rows_[i].row));
      if (rows_[i].row > wanted)
        throw InvalidInput(rows_[i].here,
                           fmt::format("row {} is missing: the table goes on with row {}", wanted, rows_[i].row));
      names.add(rows_[i].label, i + 1, rows_[i].here);
      table.labels.push_back(rows_[i].label);
      if (has_positions_) table.positions.push_back(rows_[i].position);
    }
    return table;
  }

 private:
  struct Row {
    std::int64_t row;
    RowLabel label;
    std::array<double, 3> position;
    Location here;
  };
  std::vector<Row> rows_;
  bool has_positions_ = false;
};

model::RowTable read_table(std::string_view text, const std::string& place) {
  static const std::vector<std::string> known{"row", "node", "direction", "x", "y", "z"};
  std::vector<std::size_t> columns;  // what each column of the file is
  NumberedRows rows;
  for_each_csv_row(text, place, [&](const std::vector<std::string_view>& fields, const Location& here) {
    if (columns.empty()) {
      for (const std::string_view field : fields) {
        const auto found = std::find(known.begin(), known.end(), lower(field));
        if (found == known.end())
          throw InvalidInput(here, fmt::format("the first line names the columns, and \"{}\" is none of them{}",
                                               excerpt(field), suggestion(std::string(field), known)));
        const auto column = static_cast<std::size_t>(found - known.begin());
        if (std::find(columns.begin(), columns.end(), column) != columns.end())
          throw InvalidInput(here, fmt::format("two columns are called \"{}\"", *found));
        columns.push_back(column);
      }
      for (std::size_t i = 0; i < 3; ++i)
        if (std::find(columns.begin(), columns.end(), i) == columns.end())
          throw InvalidInput(here, fmt::format("the column \"{}\" is missing", known[i]));
      if (columns.size() != 3 && columns.size() != 6) throw InvalidInput(here, "positions take three columns: x, y, z");
      return;
    }
    if (fields.size() != columns.size())
      throw InvalidInput(here, fmt::format("{} fields for {} columns", fields.size(), columns.size()));
    const auto field = [&](std::size_t column) {
      return fields[static_cast<std::size_t>(std::find(columns.begin(), columns.end(), column) - columns.begin())];
    };
    std::int64_t row = 0;
    if (!integral(field(0), row))
      throw InvalidInput(here, fmt::format("a row must be a whole number, got \"{}\"", excerpt(field(0))));
    RowLabel label{0, direction_of(field(2))};
    if (!integral(field(1), label.node)) label.node = 0;
    require_row(label, here, field(1), field(2));
    rows.add(row, label, here);
    if (columns.size() == 6)
      rows.place_at(
          {csv_number(field(3), "x", here), csv_number(field(4), "y", here), csv_number(field(5), "z", here)});
  });
  return rows.table();
}

/// Equation, node and degree of freedom, separated by blanks; lines of words alone are titles.
model::RowTable read_mapping(std::string_view text, const std::string& place) {
  NumberedRows rows;
  LineScanner lines(text, place);
  std::string_view line;
  bool has_begun = false;
  while (lines.next(line)) {
    std::vector<std::string_view> words;
    for (std::string_view rest = trimmed_blanks(line); !rest.empty(); rest = trimmed_blanks(rest)) {
      const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
      words.push_back(rest.substr(0, end));
      rest.remove_prefix(end);
    }
    if (words.empty()) continue;
    std::int64_t row = 0;
    RowLabel label;
    if (words.size() != 3 || !whole(words[0], row) || !whole(words[1], label.node)) {
      if (!has_begun && std::isalpha(static_cast<unsigned char>(words[0].front()))) continue;
      throw InvalidInput(lines.here(), fmt::format("a row must be EQUATION NODE DIRECTION, got \"{}\"", excerpt(line)));
    }
    has_begun = true;
    label.direction = direction_of(words[2]);
    require_row(label, lines.here(), words[1], words[2]);
    rows.add(row, label, lines.here());
  }
  return rows.table();
}

}  // namespace

model::RowTable read_rows(std::string_view text, const std::string& place) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  LineScanner lines(text, place);
  std::string_view line;
  while (lines.next(line) && trimmed_blanks(line).empty()) {
  }
  line = trimmed_blanks(line);
  if (line.starts_with("%%MatrixMarket"))
    throw InvalidInput(
        lines.here(),
        "this is a vector or matrix, not a table of rows. Matrices from Ansys are in the order of its "
        "solver, which a nodal mapping vector (BACK, FORWARD) alone does not tell: give the mapping file "
        "that HBMAT writes, or a table with the columns row, node, direction");
  const bool has_letters =
      std::any_of(line.begin(), line.end(), [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; });
  model::RowTable table =
      line.find_first_of(",;") != std::string_view::npos || line.front() == '#' ? read_table(text, place)
      : has_letters || line.find_first_of(" \t") != std::string_view::npos      ? read_mapping(text, place)
                                                                                : read_dof(text, place);
  if (table.labels.empty())
    throw InvalidInput({place, 0, 0},
                       "the file has no rows; it needs NODE.DIRECTION a line, or a table with the columns "
                       "row, node, direction");
  return table;
}

}  // namespace rubato::io
