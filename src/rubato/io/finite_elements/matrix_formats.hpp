#pragma once

#include <rubato/io/finite_elements/matrix_entries.hpp>

#include <span>
#include <string>
#include <string_view>

// Private to io. Formats of matrices, each in a file of its own.
namespace rubato::io {

/// A file of matrices, and which of them is wanted.
struct MatrixSource {
  std::string_view text;
  std::string place;           ///< the file, for messages
  std::string kind;            ///< "stiffness", "mass" or "damping"
  std::string matrix = "";     ///< its name within the file, where the study gives one
  Location matrix_where = {};  ///< of that name in the study
};

struct MatrixFormat {
  const char* word;   ///< of the key `format`
  const char* title;  ///< "CalculiX"
  /// Whether a text looks like it.
  bool (*looks_so)(std::string_view text);
  /// Throws InvalidInput, with the line.
  void (*read)(const MatrixSource& source, MatrixEntries& entries);
};

/// In the order in which they are tried.
std::span<const MatrixFormat> matrix_formats();

void read_matrix_market(const MatrixSource& source, MatrixEntries& entries);
void read_coordinates(const MatrixSource& source, MatrixEntries& entries);
void read_abaqus_input(const MatrixSource& source, MatrixEntries& entries);
void read_abaqus_substructure(const MatrixSource& source, MatrixEntries& entries);
void read_dmig(const MatrixSource& source, MatrixEntries& entries);
void read_op4(const MatrixSource& source, MatrixEntries& entries);

/// The one of several matrices of a file that a study means: the one that it names; else the only one, or the only one
/// whose name begins as the kind does (K, M, B; K4 is structural damping). Throws InvalidInput.
std::string chosen_matrix(const MatrixSource& source, const std::vector<std::string>& names);

/// Whether a line is the head of a matrix in OP4 format.
bool is_op4_head(std::string_view line);

}  // namespace rubato::io
