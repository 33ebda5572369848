#include <rubato/report/curves_json.hpp>
#include <rubato/report/digest.hpp>
#include <rubato/report/json.hpp>
#include <rubato/report/table_json.hpp>
#include <rubato/report/table_pieces.hpp>

#include <cmath>

#include <fmt/format.h>

namespace rubato::report {
namespace {

/// Which rows of the curves are shown, and by how many buckets.
struct Shown {
  std::vector<CurveRows> curves;
  std::vector<std::size_t> ordinals;
  std::size_t buckets = 0;  ///< of a curve that has more than twice as many rows

  bool is_whole(const CurveRows& curve) const { return curve.rows <= 2 * buckets; }
  std::size_t points(const CurveRows& curve) const { return is_whole(curve) ? curve.rows : 2 * buckets; }
};

Shown choose(const std::vector<CurveRows>& curves, std::size_t rows, std::size_t columns, const CurveExtent& extent) {
  Shown shown;
  const bool is_whole = rows <= extent.whole_up_to;
  shown.ordinals = spread(curves.size(), is_whole ? curves.size() : extent.curves);
  for (const std::size_t ordinal : shown.ordinals) shown.curves.push_back(curves[ordinal]);
  const std::size_t points = std::max(extent.numbers / std::max<std::size_t>(columns, 1), extent.whole_up_to / 4);
  shown.buckets =
      is_whole ? rows : std::max(extent.least_buckets, points / 2 / std::max<std::size_t>(shown.curves.size(), 1));
  return shown;
}

/// The points of the shown curves of one variable, fed with its rows in their order.
class CurvePoints {
 public:
  CurvePoints(const Shown& shown, std::size_t labels) : shown_(shown), columns_(labels) {}

  void add(std::size_t row, std::span<const double> values) {
    if (curve_ == shown_.curves.size()) return;
    const CurveRows& curve = shown_.curves[curve_];
    if (row < curve.first_row) return;
    const bool is_whole = shown_.is_whole(curve);
    if (row == curve.first_row && !is_whole) envelopes_.assign(columns_.size(), Envelope(curve.rows, shown_.buckets));
    for (std::size_t label = 0; label < columns_.size(); ++label) {
      if (is_whole)
        columns_[label].push_back(values[label]);
      else
        envelopes_[label].add(values[label]);
    }
    if (row + 1 < curve.first_row + curve.rows) return;
    if (!is_whole)
      for (std::size_t label = 0; label < columns_.size(); ++label)
        columns_[label].insert(columns_[label].end(), envelopes_[label].points().begin(),
                               envelopes_[label].points().end());
    ++curve_;
  }

  const Columns& columns() const { return columns_; }

 private:
  const Shown& shown_;
  std::size_t curve_ = 0;
  std::vector<Envelope> envelopes_;
  Columns columns_;
};

/// The largest value of each label over some curves, and the row where it stands.
class CurvePeaks {
 public:
  CurvePeaks(std::vector<CurveRows> curves, std::size_t labels)
      : curves_(std::move(curves)),
        values_(labels, std::vector<double>(curves_.size(), NAN)),
        rows_(labels, std::vector<std::size_t>(curves_.size(), 0)) {}

  void add(std::size_t row, std::span<const double> values) {
    while (curve_ < curves_.size() && row >= curves_[curve_].first_row + curves_[curve_].rows) ++curve_;
    if (curve_ == curves_.size() || row < curves_[curve_].first_row) return;
    for (std::size_t label = 0; label < values_.size(); ++label) {
      double& largest = values_[label][curve_];
      if (values[label] > largest || (std::isnan(largest) && !std::isnan(values[label]))) {
        largest = values[label];
        rows_[label][curve_] = row;
      }
    }
  }

  /// @param read  the value of a variable without a dimension in a row
  template <class Read>
  std::string json(std::size_t variable, const CurveLayout& layout, Read read) const {
    Columns keys, abscissae;
    for (const std::size_t key : layout.keys) {
      keys.emplace_back();
      for (const CurveRows& curve : curves_) keys.back().push_back(read(key, curve.first_row));
    }
    for (std::size_t label = 0; label < values_.size(); ++label) {
      abscissae.emplace_back();
      for (std::size_t curve = 0; curve < curves_.size(); ++curve)
        abscissae.back().push_back(std::isnan(values_[label][curve]) ? NAN
                                                                     : read(layout.abscissa, rows_[label][curve]));
    }
    return fmt::format(R"({{"variable":{},"keys":{},"abscissa":{},"value":{}}})", variable,
                       columns_json(keys, coordinate_digits), columns_json(abscissae, coordinate_digits),
                       columns_json(values_, coordinate_digits));
  }

 private:
  std::vector<CurveRows> curves_;
  Columns values_;
  std::vector<std::vector<std::size_t>> rows_;
  std::size_t curve_ = 0;
};

/// What became of the points: how many have each status, and where the first are that did not converge.
struct Statuses {
  std::size_t variable = 0;
  std::vector<double> counts;
  std::vector<std::size_t> flagged;
  Columns columns_of(const TableSource& table, std::size_t variable_read, std::size_t labels) const;
};

std::optional<Statuses> count_statuses(const TableSource& table, std::size_t most) {
  for (std::size_t v = 0; v < table.variables().size(); ++v) {
    const Variable& variable = table.variables()[v];
    if (variable.name != "status" || variable.categories.empty() || !variable.dimension.empty()) continue;
    Statuses out{v, std::vector<double>(variable.categories.size(), 0.0), {}};
    for_each_row(table, v, 0, table.rows(), 1, [&](std::size_t row, std::span<const double> value) {
      if (value[0] >= 0.0 && value[0] < static_cast<double>(out.counts.size()))
        ++out.counts[static_cast<std::size_t>(value[0])];
      if (value[0] != 0.0 && out.flagged.size() < most) out.flagged.push_back(row);
    });
    return out;
  }
  return std::nullopt;
}

Columns Statuses::columns_of(const TableSource& table, std::size_t variable_read, std::size_t labels) const {
  Columns columns(labels);
  std::vector<double> values(labels);
  for (const std::size_t row : flagged) {
    if (labels == 0) break;
    table.read(variable_read, row, 1, labels, values);
    for (std::size_t label = 0; label < labels; ++label) columns[label].push_back(values[label]);
  }
  return columns;
}

template <class Number>
std::string integers_json(const std::vector<Number>& values) {
  return fmt::format("[{}]", fmt::join(values, ","));
}

}  // namespace

std::string curves_json(const TableSource& table, const CurveLayout& asked, const CurveExtent& extent) {
  std::vector<CurveRows> curves;
  const CurveLayout layout = longest_curves(table, asked, curves);
  const auto& variables = table.variables();
  const std::size_t rows = table.rows();
  std::size_t width = 0;
  for (const Variable& variable : variables) width += std::min(variable.width(), extent.labels);
  const Shown shown = choose(curves, rows, width, extent);
  const std::optional<Statuses> statuses = count_statuses(table, extent.flagged);

  std::vector<CurveRows> peaked;
  for (const std::size_t ordinal : spread(curves.size(), extent.peaks)) peaked.push_back(curves[ordinal]);
  const auto read_one = [&](std::size_t variable, std::size_t row) {
    double value = 0.0;
    table.read(variable, row, 1, 1, {&value, 1});
    return value;
  };

  std::string variables_text = "[", overview = "[", maxima = "[", flagged = "[", peaks = "null";
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const std::size_t labels = std::min(variables[v].width(), extent.labels);
    const bool has_peaks = variables[v].name == "amplitude" && v != layout.abscissa;
    CurvePoints points(shown, labels);
    CurvePeaks largest(has_peaks ? peaked : std::vector<CurveRows>{}, labels);
    std::vector<double> maximum(labels, NAN);
    for_each_row(table, v, 0, rows, labels, [&](std::size_t row, std::span<const double> values) {
      points.add(row, values);
      if (has_peaks) largest.add(row, values);
      for (std::size_t label = 0; label < labels; ++label) maximum[label] = std::fmax(maximum[label], values[label]);
    });
    Columns columns = points.columns();
    if (v == layout.abscissa) {  // its extremes are not where those of the others stand: their rows are
      std::size_t at = 0;
      for (const CurveRows& curve : shown.curves) {
        if (!shown.is_whole(curve)) {
          const std::vector<std::size_t> of_points = Envelope::rows_of_points(curve.rows, shown.buckets);
          for (std::size_t i = 0; i < of_points.size(); ++i)
            columns[0][at + i] = read_one(v, curve.first_row + of_points[i]);
        }
        at += shown.points(curve);
      }
    }
    const bool is_coordinate =
        v == layout.abscissa || std::find(layout.keys.begin(), layout.keys.end(), v) != layout.keys.end();
    const char* comma = v > 0 ? "," : "";
    variables_text += comma + variable_json(variables[v], labels);
    const int digits = rows <= extent.exact_up_to ? exact_digits : is_coordinate ? coordinate_digits : value_digits;
    overview += comma + columns_json(columns, digits);
    maxima += comma + json_numbers(maximum);
    if (statuses) flagged += comma + columns_json(statuses->columns_of(table, v, labels), coordinate_digits);
    if (has_peaks) peaks = largest.json(v, layout, read_one);
  }
  std::vector<std::size_t> starts{0};
  bool is_whole = shown.curves.size() == curves.size();
  for (const CurveRows& curve : shown.curves) {
    starts.push_back(starts.back() + shown.points(curve));
    is_whole = is_whole && shown.is_whole(curve);
  }
  const std::string status_text =
      statuses ? fmt::format(R"({{"variable":{},"counts":{},"columns":{}]}})", statuses->variable,
                             json_numbers(statuses->counts, coordinate_digits), flagged)
               : "null";
  return fmt::format(
      R"({{"name":{},"row_dimension":{},"rows":{},"attributes":{},"variables":{}],"overview":{}],"is_envelope":{},)"
      R"("window":null,"window_first_row":{},"key_numbers":null,"curves":{{"abscissa":{},"keys":{},"count":{},)"
      R"("starts":{},"ordinals":{}}},"maxima":{}],"statuses":{},"peaks":{}}})",
      json_string(table.name()), json_string(table.row_dimension()), rows, attributes_json(table.attributes()),
      variables_text, overview, !is_whole, rows, layout.abscissa, integers_json(layout.keys), curves.size(),
      integers_json(starts), integers_json(shown.ordinals), maxima, status_text, peaks);
}

}  // namespace rubato::report
