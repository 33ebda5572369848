#pragma once

#include <rubato/report/table_source.hpp>

#include <algorithm>

// How tables are read and their columns written: in pieces of bounded size.
namespace rubato::report {

/// Rows read at once: 32 labels of them are 2 MB. Of more labels fewer rows, so that a piece stays below 16 MB.
inline constexpr std::size_t piece_rows = 8192, piece_numbers = 1u << 21;

/// Digits in the page: a column of the row coordinate resolves steps of 1e-7 of its range; the others are for the eye.
/// Short tables, an optimum among them, are there to be read off.
inline constexpr int coordinate_digits = 10, value_digits = 7, exact_digits = 12;

using Columns = std::vector<std::vector<double>>;  ///< [labels][rows]

/// Calls use(row, values of the first `labels` labels) for the rows [first, first + rows), which it reads in pieces.
template <class Use>
void for_each_row(const TableSource& table, std::size_t variable, std::size_t first, std::size_t rows,
                  std::size_t labels, Use use) {
  if (labels == 0) return;
  const std::size_t most = std::clamp<std::size_t>(piece_numbers / labels, 1, piece_rows);
  std::vector<double> piece(std::min(most, rows) * labels);
  for (std::size_t done = 0; done < rows;) {
    const std::size_t count = std::min(most, rows - done);
    const std::span<double> values(piece.data(), count * labels);
    table.read(variable, first + done, count, labels, values);
    for (std::size_t i = 0; i < count; ++i) use(first + done + i, values.subspan(i * labels, labels));
    done += count;
  }
}

/// [[1,2],[3,4]]
std::string columns_json(const Columns& columns, int digits);

/// {"name", "unit", "description", "dimension", "labels", "label_count", "categories"}, with the first so many labels.
std::string variable_json(const Variable& variable, std::size_t labels);
/// Likewise with these labels, by their places.
std::string variable_json(const Variable& variable, std::span<const std::size_t> labels);

/// Places of at most so many labels, in their order: of more those of coordinates and joints come before degrees of
/// freedom of nodes ("NODE.x"), and these before those of the nodes within beams ("BEAM:1.x"). One place without
/// labels.
std::vector<std::size_t> shown_labels(const Variable& variable, std::size_t most);

}  // namespace rubato::report
