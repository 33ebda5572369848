#include <rubato/io/finite_elements/matrix_formats.hpp>
#include <rubato/io/finite_elements/read_inp_mesh.hpp>
#include <rubato/io/finite_elements/read_rows.hpp>
#include <rubato/io/finite_elements/text_scanner.hpp>
#include <rubato/io/read_parts.hpp>

#include <rubato/core/excerpt.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace rubato::io {
namespace {

using model::FiniteElementFileDescription;

constexpr std::uintmax_t largest_matrix = std::uintmax_t{8} << 30;

const MatrixFormat& format_of(std::string_view text, const std::string& word, const std::string& place) {
  std::vector<std::string> titles;
  for (const MatrixFormat& format : matrix_formats()) {
    if (word.empty() ? format.looks_so(text) : format.word == word) return format;
    titles.emplace_back(format.title);
  }
  LineScanner lines(text, place);
  std::string_view line;
  while (lines.next(line) && trimmed_blanks(line).empty()) {
  }
  if (trimmed_blanks(line).empty()) throw InvalidInput({place, 0, 0}, "the file is empty");
  const bool is_harwell_boeing = text.substr(0, 400).find("RSA") != std::string_view::npos;
  throw InvalidInput(
      lines.here(),
      fmt::format("this is none of the formats of matrices that are read ({}){}; the file begins \"{}\"",
                  fmt::join(titles, ", "),
                  is_harwell_boeing ? ", and looks like Harwell-Boeing: export it as MMF, Matrix Market" : "",
                  excerpt(trimmed_blanks(line))));
}

model::FiniteElementMatrix read_matrix(const FiniteElementFileDescription::MatrixFile& file, const std::string& kind,
                                       const std::string& format, const StudyFolder& folder, Index empty_rows = 0) {
  const std::string text = folder.read(file.file, file.where, largest_matrix, fmt::format("the {} matrix", kind));
  const MatrixSource source{text, folder.place_of(file.file), kind, file.matrix, file.matrix_where};
  refuse_binary(text, source.place,
                "matrices are read from text: Matrix Market, CalculiX, Abaqus .mtx, Nastran DMIG or OP4 (not .full, "
                ".op2, .sim); export them so");
  const MatrixFormat& chosen = format_of(text, format, source.place);
  MatrixEntries entries(source.place);
  entries.empty_rows = static_cast<int>(empty_rows);
  const auto read = [&] { chosen.read(source, entries); };
  read();
  model::FiniteElementMatrix matrix = entries.matrix(read);
  matrix.file = file.file;
  matrix.where = file.where;
  matrix.format = chosen.title;
  return matrix;
}

}  // namespace

void read_mesh(const FiniteElementFileDescription& files, const StudyFolder& folder,
               std::shared_ptr<const model::FiniteElements>& to) {
  model::FiniteElementFiles parts;
  parts.where = files.where;
  if (!files.mesh.empty()) parts.mesh = read_inp_mesh(files.mesh, folder, files.mesh_where);
  if (!files.rows.empty()) {
    const std::string text = folder.read(files.rows, files.rows_where, largest_matrix, "the table of rows");
    const std::string place = folder.place_of(files.rows);
    refuse_binary(text, place, "a table of rows is text");
    parts.rows = read_rows(text, place);
    parts.rows->file = files.rows;
    parts.rows->where = files.rows_where;
  }
  parts.stiffness = read_matrix(files.stiffness, "stiffness", files.format, folder);
  parts.mass = read_matrix(files.mass, "mass", files.format, folder);
  if (!files.damping.file.empty())
    parts.damping = read_matrix(files.damping, "damping", files.format, folder, parts.stiffness.values.rows());
  to = std::make_shared<const model::FiniteElements>(model::join_finite_elements(std::move(parts)));
}

}  // namespace rubato::io
