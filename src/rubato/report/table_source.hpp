#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

// What the report needs to know of a table, whoever holds it.
namespace rubato::report {

using Attributes = std::vector<std::pair<std::string, std::string>>;

/// One variable of a table: a number a row, or one a row and a label.
struct Variable {
  std::string name;                     ///< "position"
  std::string unit;                     ///< "m"; "1" or empty for pure numbers
  std::string description;              ///< a few words
  std::string dimension;                ///< "coordinate", "slider", or empty
  std::vector<std::string> labels;      ///< names along the dimension; empty where `dimension` is
  std::vector<std::string> categories;  ///< where not empty, values are indices into these words

  std::size_t width() const { return dimension.empty() ? 1 : labels.size(); }
};

/// A table of labelled rows that can be read in pieces. The first variable is the coordinate of the rows.
class TableSource {
 public:
  virtual ~TableSource() = default;
  virtual const std::string& name() const = 0;           ///< empty for the main table; "energy"
  virtual const std::string& row_dimension() const = 0;  ///< "time"
  virtual const Attributes& attributes() const = 0;
  virtual const std::vector<Variable>& variables() const = 0;
  virtual std::size_t rows() const = 0;
  /// Rows [first_row, first_row + rows) of the first `labels` labels of a variable.
  /// @param values  [rows x labels], row by row; what was never written reads as NaN
  virtual void read(std::size_t variable, std::size_t first_row, std::size_t rows, std::size_t labels,
                    std::span<double> values) const = 0;
};

}  // namespace rubato::report
