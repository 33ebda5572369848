#include <rubato/core/excerpt.hpp>
#include <rubato/io/finite_elements/matrix_formats.hpp>
#include <rubato/io/finite_elements/text_scanner.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

// Direct matrix input at grid points, in fixed fields: what Nastran, OptiStruct and Ansys punch.
namespace rubato::io {
namespace {

/// The fields of a line behind the first eight columns.
struct Card {
  std::string_view head;  ///< the first eight columns, without blanks
  std::array<std::string_view, 8> fields{};
  std::size_t count = 0;  ///< 4 of sixteen columns, or 8 of eight

  Card(std::string_view line, bool is_wide) {
    head = trimmed_blanks(line.substr(0, 8));
    const std::size_t width = is_wide ? 16 : 8;
    count = is_wide ? 4 : 8;
    for (std::size_t i = 0; i < count && 8 + i * width < line.size(); ++i)
      fields[i] = trimmed_blanks(line.substr(8 + i * width, width));
  }
};

bool is_dmig_line(std::string_view line) {
  return line.size() > 4 && (line[0] == 'D' || line[0] == 'd') && (line[1] == 'M' || line[1] == 'm') &&
         (line[2] == 'I' || line[2] == 'i') && (line[3] == 'G' || line[3] == 'g') && (line[4] == ' ' || line[4] == '*');
}
bool is_continuation(std::string_view line) {
  return !line.empty() && (line.front() == '*' || line.front() == '+' || line.front() == ' ');
}

bool is_wide(std::string_view line) { return line.substr(0, 8).find('*') != std::string_view::npos; }

std::string upper(std::string_view text) {
  std::string word(text);
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::toupper(c); });
  return word;
}

void require_fixed_fields(const LineScanner& lines, std::string_view line) {
  if (line.find(',') != std::string_view::npos)
    throw InvalidInput(lines.here(),
                       "the fields of DMIG are separated by commas here; only fields of fixed width (8 or "
                       "16 columns, as programs punch them) are read");
  if (line.find('\t') != std::string_view::npos)
    throw InvalidInput(lines.here(), "the line holds a tab, and fields of DMIG have fixed columns; write blanks");
}

/// A whole number in a field; an empty one is 0.
std::int64_t whole(const LineScanner& lines, std::string_view field, const char* what) {
  std::int64_t number = 0;
  if (field.empty()) return 0;
  const auto [end, fault] = std::from_chars(field.data(), field.data() + field.size(), number);
  if (fault != std::errc() || end != field.data() + field.size())
    throw InvalidInput(lines.here(), fmt::format("{} must be a whole number, got \"{}\"", what, excerpt(field)));
  return number;
}

model::RowLabel label_of(const LineScanner& lines, std::string_view node, std::string_view direction) {
  model::RowLabel label{whole(lines, node, "a grid point"), static_cast<int>(whole(lines, direction, "a component"))};
  if (label.node < 1) throw InvalidInput(lines.here(), "a grid point must be a whole number from 1 on");
  if (label.direction < 0 || label.direction > 6)
    throw InvalidInput(lines.here(), fmt::format("component {} of grid point {} is none of 1 to 6, or 0 of a scalar "
                                                 "point",
                                                 label.direction, label.node));
  return label;
}

/// The heads of matrices have the grid point 0.
bool is_head(const LineScanner& lines, const Card& card) { return whole(lines, card.fields[1], "a grid point") == 0; }

std::vector<std::string> names_in(const MatrixSource& source) {
  std::vector<std::string> names;
  LineScanner lines(source.text, source.place);
  std::string_view line;
  while (lines.next(line)) {
    if (!is_dmig_line(line)) continue;
    const Card card(line, is_wide(line));
    if (!is_head(lines, card)) continue;
    const std::string name = upper(card.fields[0]);
    if (name.empty()) throw InvalidInput(lines.here(), "the matrix has no name in columns 9 to 16");
    if (std::find(names.begin(), names.end(), name) != names.end())
      throw InvalidInput(lines.here(), fmt::format("two matrices of the file are called \"{}\"", name));
    names.push_back(name);
  }
  return names;
}

void take_head(const LineScanner& lines, const Card& card, MatrixEntries& entries) {
  const auto form = whole(lines, card.fields[2], "the form of the matrix");
  const auto type = whole(lines, card.fields[3], "the type of the matrix");
  if (form != 1 && form != 6)
    throw InvalidInput(lines.here(),
                       fmt::format("the matrix has the form {}; it must be 6 (symmetric) or 1 (square)", form));
  if (type != 1 && type != 2)
    throw InvalidInput(lines.here(), fmt::format("the matrix has the type {}; it must be 1 or 2 (real)", type));
  entries.triangle = form == 1 ? Triangle::both : Triangle::undeclared;
}

/// Grid point, component, real part and, unused, imaginary part: four fields of a card.
void take_term(const LineScanner& lines, const Card& card, std::size_t first, const model::RowLabel& column,
               MatrixEntries& entries) {
  const auto field = [&](std::size_t i) { return card.fields[first + i]; };
  if (field(0).empty() && field(1).empty() && field(2).empty()) return;
  double value = 0.0;
  if (!fortran_number(field(2), value))
    throw InvalidInput(lines.here(), fmt::format("an entry must be a number, got \"{}\"", excerpt(field(2))));
  entries.add(label_of(lines, field(0), field(1)), column, value, lines.number());
}

}  // namespace

void read_dmig(const MatrixSource& source, MatrixEntries& entries) {
  const std::vector<std::string> names = names_in(source);
  if (names.empty())
    throw InvalidInput({source.place, 0, 0}, "the file has no head of a matrix: DMIG, NAME, 0, form, type");
  const std::string wanted = chosen_matrix(source, names);
  LineScanner lines(source.text, source.place);
  std::string_view line;
  bool is_in_card = false, is_wanted = false, has_head = false;
  model::RowLabel column;
  entries.digits = 5;
  while (lines.next(line)) {
    if (line.empty() || line.front() == '$') continue;
    const bool begins = is_dmig_line(line);
    if (!begins && !(is_in_card && is_continuation(line))) {
      if (line.size() > 4 && upper(line.substr(0, 5)) == "DMIG,") require_fixed_fields(lines, line);
      is_in_card = false;
      continue;
    }
    const Card card(line, is_wide(line));
    if (begins) {
      is_in_card = true;
      is_wanted = upper(card.fields[0]) == wanted;
      if (!is_wanted) continue;
      require_fixed_fields(lines, line);
      if (is_head(lines, card)) {
        take_head(lines, card, entries);
        has_head = true;
        is_wanted = false;  // what continues a head is not looked at
        continue;
      }
      if (!has_head) throw InvalidInput(lines.here(), fmt::format("matrix \"{}\" begins without its head", wanted));
      column = label_of(lines, card.fields[1], card.fields[2]);
      entries.place_of(column);
    }
    if (!is_wanted) continue;
    if (card.count == 4) entries.digits = 10;
    for (std::size_t first = begins ? 4 : 0; first < card.count; first += 4)
      take_term(lines, card, first, column, entries);
  }
  if (lines.ends_within_a_line() && is_wanted)
    throw InvalidInput(lines.here(),
                       "the file ends within this line: it was cut off, and a number may have lost digits; write or "
                       "copy it again (or, if it is whole, end its last line)");
}

}  // namespace rubato::io
