#include <rubato/core/excerpt.hpp>
#include <rubato/io/finite_elements/matrix_formats.hpp>
#include <rubato/io/finite_elements/text_scanner.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

// Nastran OUTPUT4, as text: dense columns, or columns of strings of neighbouring rows.
namespace rubato::io {
namespace {

/// A whole number in eight columns.
bool field8(std::string_view line, std::size_t place, std::int64_t& number) {
  if (line.size() <= place * 8) return false;
  const std::string_view field = trimmed_blanks(line.substr(place * 8, 8));
  const auto [end, fault] = std::from_chars(field.data(), field.data() + field.size(), number);
  return fault == std::errc() && end == field.data() + field.size();
}

struct Head {
  std::string name;
  std::int64_t columns = 0, rows = 0, form = 0, type = 0;
  bool is_big = false;  ///< strings have two words that say what they are
  std::size_t per_line = 0, width = 0;
};

class Op4Reader {
 public:
  explicit Op4Reader(const MatrixSource& source) : lines_(source.text, source.place) {}

  /// Goes to the matrix of a name and reads it.
  void read(const std::string& name, MatrixEntries& entries) {
    Head head;
    while (lines_.next(line_)) {
      if (!is_op4_head(line_)) continue;
      head = head_of();
      if (head.name == name) break;
    }
    check(head);
    entries.size = static_cast<int>(head.rows);
    entries.triangle = head.form == 1 ? Triangle::both : Triangle::undeclared;
    std::int64_t last = 0;
    while (true) {
      std::int64_t column = 0, row = 0, words = 0;
      next("a column");
      if (!field8(line_, 0, column) || !field8(line_, 1, row) || !field8(line_, 2, words) || words < 0)
        refuse("expected a column (its number, the first row, how many words follow)");
      if (column == head.columns + 1) return;
      if (column <= last || column > head.columns)
        refuse(fmt::format("column {} of {} follows column {}", column, head.columns, last));
      last = column;
      if (row > 0)
        take_values(head, entries, column, row, words);
      else
        take_strings(head, entries, column, words);
    }
  }

 private:
  Head head_of() const {
    Head head;
    (void)(field8(line_, 0, head.columns) && field8(line_, 1, head.rows) && field8(line_, 2, head.form) &&
           field8(line_, 3, head.type));
    head.is_big = head.rows < 0;
    head.rows = std::abs(head.rows);
    head.name = std::string(trimmed_blanks(line_.substr(32, 8)));
    std::transform(head.name.begin(), head.name.end(), head.name.begin(),
                   [](unsigned char c) { return std::toupper(c); });
    // "1P,3E23.16": three numbers a line, each in 23 columns.
    const std::string_view format = line_.size() > 40 ? line_.substr(40) : std::string_view();
    const std::size_t letter = format.find_first_of("EDed");
    if (letter == std::string_view::npos || letter == 0) return head;
    std::size_t begin = letter;
    while (begin > 0 && std::isdigit(static_cast<unsigned char>(format[begin - 1]))) --begin;
    (void)std::from_chars(format.data() + begin, format.data() + letter, head.per_line);
    (void)std::from_chars(format.data() + letter + 1, format.data() + format.size(), head.width);
    return head;
  }

  void check(const Head& head) const {
    if (head.columns != head.rows || head.rows < 1)
      refuse(fmt::format("the matrix must be square, it is {} x {}", head.rows, head.columns));
    if (head.form != 1 && head.form != 6)
      refuse(fmt::format("the matrix has the form {}; it must be 6 (symmetric) or 1 (square)", head.form));
    if (head.type != 1 && head.type != 2)
      refuse(fmt::format("the matrix has the type {}; it must be 1 or 2 (real)", head.type));
    if (head.per_line < 1 || head.per_line > 20 || head.width < 8 || head.width > 40)
      refuse("the format of the numbers is missing, such as 1P,3E23.16");
    if (head.rows > 2000000000) refuse("the matrix has too many rows");
  }

  void take_values(const Head& head, MatrixEntries& entries, std::int64_t column, std::int64_t row,
                   std::int64_t count) {
    if (row < 1 || row > head.rows || count > head.rows - row + 1)
      refuse(fmt::format("rows {} to {} of column {} lie outside the matrix of {} rows", row, row + count - 1, column,
                         head.rows));
    for (std::int64_t i = 0; i < count; ++i) {
      const std::size_t place = static_cast<std::size_t>(i) % head.per_line;
      if (place == 0) next("numbers");
      double value = 0.0;
      const std::size_t begin = place * head.width;
      if (begin >= line_.size() || line_.size() < begin + std::min<std::size_t>(head.width, 8) ||
          !fortran_number(line_.substr(begin, head.width), value))
        refuse(fmt::format("expected {} numbers of {} columns each (is the file cut off?)", head.per_line, head.width));
      entries.add(static_cast<int>(row + i - 1), static_cast<int>(column - 1), value, lines_.number());
    }
  }

  void take_strings(const Head& head, MatrixEntries& entries, std::int64_t column, std::int64_t words) {
    const std::int64_t per_value = head.type;  // words of a number: single or double
    while (words > 0) {
      std::int64_t length = 0, row = 0;
      next("a string of rows");
      if (head.is_big) {
        if (!field8(line_, 0, length) || !field8(line_, 1, row))
          refuse("expected the length and first row of a string");
        --length;
        words -= 2;
      } else {
        const std::string_view text = trimmed_blanks(line_);
        std::int64_t both = 0;
        const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), both);
        if (fault != std::errc() || end != text.data() + text.size()) refuse("expected the head of a string");
        length = both / 65536 - 1;
        row = both % 65536;
        words -= 1;
      }
      if (length < 1 || length % per_value != 0 || length > words)
        refuse(fmt::format("a string of {} words does not fit the {} words of its column", length, words));
      words -= length;
      take_values(head, entries, column, row, length / per_value);
    }
  }

  void next(const char* what) {
    if (!lines_.next(line_))
      throw InvalidInput(lines_.here(), fmt::format("the file ends where {} should follow: it is cut off", what));
  }
  [[noreturn]] void refuse(const std::string& why) const {
    throw InvalidInput(lines_.here(), fmt::format("{}; got \"{}\"", why, excerpt(line_)));
  }

  LineScanner lines_;
  std::string_view line_;
};

}  // namespace

bool is_op4_head(std::string_view line) {
  std::int64_t number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (!field8(line, i, number)) return false;
  return line.size() > 32 && std::isalpha(static_cast<unsigned char>(line[32])) != 0;
}

void read_op4(const MatrixSource& source, MatrixEntries& entries) {
  std::vector<std::string> names;
  LineScanner lines(source.text, source.place);
  std::string_view line;
  while (lines.next(line)) {
    if (!is_op4_head(line)) continue;
    std::string name(trimmed_blanks(line.substr(32, 8)));
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
    names.push_back(name);
  }
  if (names.empty()) throw InvalidInput({source.place, 1, 0}, "the file does not begin with the head of a matrix");
  Op4Reader(source).read(chosen_matrix(source, names), entries);
}

}  // namespace rubato::io
