#include <rubato/core/excerpt.hpp>
#include <rubato/io/finite_elements/matrix_formats.hpp>
#include <rubato/io/finite_elements/text_scanner.hpp>

#include <fmt/format.h>

// Headerless lists of entries: CalculiX (.sti, .mas) and Abaqus.
namespace rubato::io {
namespace {

/// A file without a head does not say how long it is, but its last line ends.
void require_whole_line(const LineScanner& lines) {
  if (lines.ends_within_a_line())
    throw InvalidInput(lines.here(),
                       "the file ends within this line: it was cut off, and a number may have lost digits; write or "
                       "copy it again (or, if it is whole, end its last line)");
}

[[noreturn]] void refuse_line(const LineScanner& lines, std::string_view line, const char* expected) {
  throw InvalidInput(lines.here(), fmt::format("an entry must be {}, got \"{}\"", expected, excerpt(line)));
}

}  // namespace

void read_coordinates(const MatrixSource& source, MatrixEntries& entries) {
  LineScanner lines(source.text, source.place);
  std::string_view line;
  while (lines.next(line)) {
    NumberScanner numbers(line);
    int row = 0, column = 0;
    double value = 0.0;
    if (!numbers.next(row) || !numbers.is_at_gap() || !numbers.next(column) || !numbers.is_at_gap() ||
        !numbers.next(value) || !numbers.is_at_end()) {
      if (trimmed_blanks(line).empty()) continue;
      require_whole_line(lines);
      refuse_line(lines, line, "ROW COLUMN VALUE");
    }
    if (row < 1 || column < 1)
      throw InvalidInput(lines.here(), fmt::format("entry ({}, {}): rows and columns count from 1", row, column));
    entries.add(row - 1, column - 1, value, lines.number());
  }
  require_whole_line(lines);
}

void read_abaqus_input(const MatrixSource& source, MatrixEntries& entries) {
  entries.remedy = "; export a symmetric matrix (*STEP, UNSYMM=NO)";
  LineScanner lines(source.text, source.place);
  std::string_view line;
  while (lines.next(line)) {
    NumberScanner numbers(line);
    model::RowLabel row, column;
    double value = 0.0;
    const auto next = [&](auto& number) {
      const bool is_there = numbers.next(number) && numbers.is_at_gap();
      numbers.skip_comma();
      return is_there;
    };
    if (!next(row.node) || !next(row.direction) || !next(column.node) || !next(column.direction) || !next(value) ||
        !numbers.is_at_end()) {
      if (trimmed_blanks(line).empty() || trimmed_blanks(line).starts_with("**")) continue;
      require_whole_line(lines);
      refuse_line(lines, line, "NODE, DIRECTION, NODE, DIRECTION, VALUE");
    }
    for (const model::RowLabel& label : {row, column}) {
      if (label.node < 1)
        throw InvalidInput(lines.here(),
                           fmt::format("node {} is one that Abaqus made for itself (multipliers of constraints, "
                                       "connectors, hybrid elements), without a place or a mass; replace these "
                                       "constraints and elements before the export",
                                       label.node));
      if (label.direction < 1 || label.direction > 6)
        throw InvalidInput(lines.here(), fmt::format("degree of freedom {} of node {} is no displacement (1 to 3) and "
                                                     "no rotation (4 to 6); leave it out of the export",
                                                     label.direction, label.node));
    }
    entries.add(row, column, value, lines.number());
  }
  require_whole_line(lines);
}

}  // namespace rubato::io
