#include <rubato/core/excerpt.hpp>
#include <rubato/io/finite_elements/matrix_formats.hpp>
#include <rubato/io/finite_elements/text_scanner.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace rubato::io {
namespace {

bool begins_with(std::string_view line, std::string_view word) {
  return line.size() >= word.size() && std::equal(word.begin(), word.end(), line.begin(), [](char a, char b) {
           return a == std::toupper(static_cast<unsigned char>(b));
         });
}

/// The first line with something in it.
std::string_view first_line(std::string_view text) {
  LineScanner lines(text, "");
  std::string_view line;
  while (lines.next(line))
    if (!trimmed_blanks(line).empty()) return line;
  return {};
}

bool is_matrix_market(std::string_view text) { return begins_with(first_line(text), "%%MATRIXMARKET"); }

/// Titles and comments may stand before the first matrix.
bool is_dmig(std::string_view text) {
  constexpr int most_lines = 10000;
  LineScanner lines(text, "");
  std::string_view line;
  while (lines.number() < most_lines && lines.next(line))
    if (begins_with(line, "DMIG")) return true;
  return false;
}

bool is_substructure(std::string_view text) { return begins_with(trimmed_blanks(first_line(text)), "*"); }

bool is_op4(std::string_view text) { return is_op4_head(first_line(text)); }

bool is_abaqus_input(std::string_view text) {
  NumberScanner numbers(first_line(text));
  std::int64_t number = 0;
  for (int i = 0; i < 4; ++i) {
    if (!numbers.next(number)) return false;
    numbers.skip_comma();
  }
  double value = 0.0;
  return numbers.next(value) && numbers.is_at_end();
}

bool is_coordinates(std::string_view text) {
  NumberScanner numbers(first_line(text));
  std::int64_t number = 0;
  double value = 0.0;
  return numbers.next(number) && numbers.next(number) && numbers.next(value) && numbers.is_at_end();
}

constexpr std::array formats{
    MatrixFormat{"matrix_market", "Matrix Market", is_matrix_market, read_matrix_market},
    MatrixFormat{"op4", "Nastran OP4", is_op4, read_op4},
    MatrixFormat{"abaqus_substructure", "Abaqus substructure", is_substructure, read_abaqus_substructure},
    MatrixFormat{"abaqus", "Abaqus MATRIX INPUT", is_abaqus_input, read_abaqus_input},
    MatrixFormat{"coordinate", "CalculiX or Abaqus COORDINATE", is_coordinates, read_coordinates},
    MatrixFormat{"dmig", "Nastran DMIG", is_dmig, read_dmig},
};

}  // namespace

std::span<const MatrixFormat> matrix_formats() { return formats; }

std::string chosen_matrix(const MatrixSource& source, const std::vector<std::string>& names) {
  std::vector<std::string> fitting;
  const char initial = source.kind == "stiffness" ? 'K' : source.kind == "mass" ? 'M' : 'B';
  for (const std::string& name : names)
    if (name.front() == initial && !name.starts_with("K4")) fitting.push_back(name);
  const auto contradicts = [&](const std::string& name) {
    return (source.kind == "stiffness" && name.front() == 'M') || (source.kind == "mass" && name.front() == 'K');
  };
  if (!source.matrix.empty()) {
    if (std::find(names.begin(), names.end(), source.matrix) == names.end())
      throw InvalidInput(source.matrix_where, fmt::format("\"{}\" holds no matrix \"{}\"{}", source.place,
                                                          source.matrix, suggestion(source.matrix, names)));
    if (contradicts(source.matrix) && !fitting.empty())
      throw InvalidInput(
          source.matrix_where,
          fmt::format("{}_name is \"{}\", which is the name of a {} matrix, and the file has \"{}\"; "
                      "are the names exchanged?",
                      source.kind, source.matrix, initial == 'K' ? "mass" : "stiffness", fitting.front()));
    return source.matrix;
  }
  if (names.size() == 1) {
    if (contradicts(names.front()))
      throw InvalidInput(
          {source.place, 0, 0},
          fmt::format("the only matrix of the file is \"{}\", the name of a {} matrix, and [model] takes "
                      "it as the {}; name the other file, or, if it is that, give {}_name = \"{}\"",
                      names.front(), initial == 'K' ? "mass" : "stiffness", source.kind, source.kind, names.front()));
    return names.front();
  }
  if (fitting.size() == 1) return fitting.front();
  throw InvalidInput({source.place, 0, 0},
                     fmt::format("the file holds {} matrices, and which is the {} is not clear; give [model] "
                                 "{}_name = \"{}\"{}",
                                 names.size(), source.kind, source.kind, names.front(), suggestion("", names)));
}

}  // namespace rubato::io
