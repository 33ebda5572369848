#pragma once

#include <rubato/report/table_source.hpp>

#include <optional>

// Tables that hold many curves one under another: the responses of a sweep.
namespace rubato::report {

/// What a table is drawn over, and what tells its curves apart: indices of variables without a dimension.
struct CurveLayout {
  std::size_t abscissa;
  std::vector<std::size_t> keys;  ///< in the order of the file
};

/// A curve: consecutive rows of equal keys over which the abscissa goes one way.
struct CurveRows {
  std::size_t first_row, rows;
};

/// The layout of a table of a frequency response, of a damper curve or of the histories of a swept transient, nothing
/// for other tables.
///
/// The abscissa is `time` where there is one, else `angular_frequency`; of the main table of a damper curve it is its
/// parameter. Keys are the swept parameters, what names the kind of a row (`direction`, `peak`) and, under a time,
/// `angular_frequency`.
/// @param analysis  attributes of the table's analysis: `type`, `swept_parameters` (names apart by commas), `parameter`
std::optional<CurveLayout> curve_layout(const TableSource& table, const Attributes& analysis);

/// The curves of a table in their order. Reads the keys and the abscissa once, in pieces.
std::vector<CurveRows> find_curves(const TableSource& table, const CurveLayout& layout);

/// The layout in which curves are longest: where nearly every row would be a curve (a sweep at one frequency) the
/// abscissa changes places with the last key that makes longer ones. `curves` is replaced with it.
CurveLayout longest_curves(const TableSource& table, CurveLayout layout, std::vector<CurveRows>& curves);

/// `count` of `total` things, evenly spread, the first and the last among them; all where there are not more.
std::vector<std::size_t> spread(std::size_t total, std::size_t count);

}  // namespace rubato::report
