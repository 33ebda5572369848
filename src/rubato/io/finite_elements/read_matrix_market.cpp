#include <rubato/core/excerpt.hpp>
#include <rubato/io/finite_elements/matrix_formats.hpp>
#include <rubato/io/finite_elements/text_scanner.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <sstream>

namespace rubato::io {
namespace {

bool next_line(LineScanner& lines, std::string_view& line) {
  while (lines.next(line))
    if (!trimmed_blanks(line).empty() && line.front() != '%') return true;
  return false;
}

struct Head {
  bool is_array = false, is_symmetric = false;
  int rows = 0;
  std::int64_t count = 0;
};

Head read_head(LineScanner& lines, const std::string& place) {
  std::string_view line;
  if (!lines.next(line)) throw InvalidInput({place, 0, 0}, "the file is empty");
  std::string words(line);
  std::transform(words.begin(), words.end(), words.begin(), [](unsigned char c) { return std::tolower(c); });
  std::istringstream stream(words);
  std::string banner, object, format, field, symmetry;
  stream >> banner >> object >> format >> field >> symmetry;
  if (object != "matrix" || (format != "coordinate" && format != "array") ||
      (field != "real" && field != "integer" && field != "double") ||
      (symmetry != "general" && symmetry != "symmetric"))
    throw InvalidInput(lines.here(), fmt::format("the first line must be \"%%MatrixMarket matrix coordinate real "
                                                 "symmetric\" (or general, integer, array), got \"{}\"",
                                                 excerpt(line)));
  Head head;
  head.is_array = format == "array";
  head.is_symmetric = symmetry == "symmetric";
  if (!next_line(lines, line)) throw InvalidInput(lines.here(), "the line of sizes is missing: the file is cut off");
  NumberScanner numbers(line);
  int columns = 0;
  const bool is_whole = numbers.next(head.rows) && numbers.next(columns) &&
                        (head.is_array || numbers.next(head.count)) && numbers.is_at_end();
  if (!is_whole || head.rows < 1 || head.count < 0)
    throw InvalidInput(lines.here(),
                       fmt::format("the line of sizes must be {}, got \"{}\"",
                                   head.is_array ? "ROWS COLUMNS" : "ROWS COLUMNS ENTRIES", excerpt(line)));
  if (columns != head.rows)
    throw InvalidInput(lines.here(), fmt::format("the matrix must be square, it is {} x {}", head.rows, columns));
  const std::int64_t n = head.rows;
  if (head.is_array) head.count = head.is_symmetric ? n * (n + 1) / 2 : n * n;
  return head;
}

}  // namespace

void read_matrix_market(const MatrixSource& source, MatrixEntries& entries) {
  LineScanner lines(source.text, source.place);
  const Head head = read_head(lines, source.place);
  entries.size = head.rows;
  entries.triangle = head.is_symmetric ? Triangle::one : Triangle::both;
  entries.remedy = head.is_symmetric ? "" : "; a general file holds both triangles, a symmetric one holds one";
  std::string_view line;
  std::int64_t read = 0;
  int row = 1, column = 1;
  while (next_line(lines, line)) {
    NumberScanner numbers(line);
    double value = 0.0;
    if (head.is_array ? !numbers.next(value) || !numbers.is_at_end()
                      : !numbers.next(row) || !numbers.is_at_gap() || !numbers.next(column) || !numbers.is_at_gap() ||
                            !numbers.next(value) || !numbers.is_at_end())
      throw InvalidInput(lines.here(), fmt::format("an entry must be {}, got \"{}\"",
                                                   head.is_array ? "one number" : "ROW COLUMN VALUE", excerpt(line)));
    if (row < 1 || row > head.rows || column < 1 || column > head.rows)
      throw InvalidInput(lines.here(), fmt::format("entry ({}, {}) lies outside the {} x {} matrix", row, column,
                                                   head.rows, head.rows));
    if (++read > head.count)
      throw InvalidInput(lines.here(), fmt::format("more than the {} entries announced", head.count));
    entries.add(row - 1, column - 1, value, lines.number());
    if (head.is_array && ++row > head.rows) row = head.is_symmetric ? ++column : (++column, 1);
  }
  if (read < head.count)
    throw InvalidInput(lines.here(),
                       fmt::format("the file ends after {} of {} entries: it is cut off", read, head.count));
}

}  // namespace rubato::io
