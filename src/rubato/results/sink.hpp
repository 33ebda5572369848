#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Labelled rows on their way to files, without knowing files. io implements the sinks for netCDF and CSV.
namespace rubato::results {

/// One quantity for several things: `position [m]` of each coordinate. In netCDF a variable (row, `dimension`); in CSV
/// a column `LABEL.VARIABLE [UNIT]` a label. With an empty `dimension`, one value a row: the CSV column is `VARIABLE
/// [UNIT]` (` [UNIT]` only where the unit is not empty).
struct Block {
  std::string variable;             ///< "position"
  std::string unit;                 ///< "m"; "1" is written as no unit
  std::string description;          ///< long_name of netCDF
  std::string dimension;            ///< "coordinate", "slider", or empty
  std::vector<std::string> labels;  ///< names along the dimension, [width]; empty where `dimension` is
  /// Where not empty the values are indices (0, 1, ...) into these words: CSV writes the word, netCDF the number with
  /// flag_values and flag_meanings.
  std::vector<std::string> categories = {};

  std::size_t width() const { return dimension.empty() ? 1 : labels.size(); }
};

/// A table that grows by rows. A row is the values of its blocks one after another; the first block is the row's
/// coordinate variable (time, frequency), with no dimension.
struct TableLayout {
  std::string analysis;       ///< the analysis's name: netCDF group, and CSV file `ANALYSIS.csv`
  std::string table;          ///< empty for the main table; "energy": `ANALYSIS.energy.csv`, netCDF subgroup "energy"
  std::string row_dimension;  ///< "time"
  std::vector<Block> blocks;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< for people and programs: method, step, ...

  std::size_t row_width() const {
    std::size_t width = 0;
    for (const Block& block : blocks) width += block.width();
    return width;
  }
};

/// Takes rows of one table. Destroying it closes the table; what was appended stays.
class RowWriter {
 public:
  virtual ~RowWriter() = default;
  /// @param row  [row_width]; throws OutputError when it cannot be written (full disk)
  virtual void append(std::span<const double> row) = 0;
  /// Makes everything appended so far readable on disk.
  virtual void flush() = 0;
};

/// Where results go.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual std::unique_ptr<RowWriter> open(const TableLayout& layout) = 0;
  /// Notes what became of an analysis: `status` is "done", "failed" or "interrupted"; attributes are statistics.
  virtual void conclude(const std::string& analysis, const std::string& status, const std::string& message,
                        const std::vector<std::pair<std::string, std::string>>& attributes) = 0;
};

}  // namespace rubato::results
