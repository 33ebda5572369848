#include <rubato/report/digest.hpp>
#include <rubato/report/json.hpp>
#include <rubato/report/reactions.hpp>
#include <rubato/report/step_distribution.hpp>
#include <rubato/report/table_json.hpp>
#include <rubato/report/table_pieces.hpp>

#include <fmt/format.h>

namespace rubato::report {
namespace {

/// Calls use(row coordinate, values of the labels) for all rows, which it reads in pieces.
template <class Use>
void for_each_timed_row(const TableSource& table, std::size_t variable, const std::vector<std::size_t>& labels,
                        Use use) {
  if (labels.empty()) return;
  std::vector<double> coordinates(std::min(piece_rows, table.rows()));
  for_each_row(table, variable, 0, table.rows(), labels.back() + 1,
               [&](std::size_t row, std::span<const double> values) {
                 const std::size_t place = row % piece_rows;
                 if (place == 0) {
                   const std::size_t count = std::min(piece_rows, table.rows() - row);
                   table.read(0, row, count, 1, std::span(coordinates).first(count));
                 }
                 use(coordinates[place], values);
               });
}

double coordinate_of_row(const TableSource& table, std::size_t row) {
  double value = 0.0;
  table.read(0, row, 1, 1, {&value, 1});
  return value;
}

/// @param labels  places of the labels to read, rising
Columns read_columns(const TableSource& table, std::size_t variable, std::size_t first, std::size_t rows,
                     const std::vector<std::size_t>& labels) {
  Columns columns(labels.size());
  if (labels.empty()) return columns;
  for_each_row(table, variable, first, rows, labels.back() + 1, [&](std::size_t, std::span<const double> values) {
    for (std::size_t i = 0; i < labels.size(); ++i) columns[i].push_back(values[labels[i]]);
  });
  return columns;
}

/// Overview of one variable, and its key numbers where they are asked for.
struct Digest {
  Columns columns;
  std::string key_numbers = "null";
};

Digest digest(const TableSource& table, std::size_t variable, const std::vector<std::size_t>& places, bool is_timed,
              bool is_envelope, const Extent& extent) {
  const std::size_t rows = table.rows(), labels = places.size();
  const bool has_key_numbers = is_timed && !table.variables()[variable].dimension.empty();
  std::vector<Envelope> envelopes(is_envelope ? labels : 0, Envelope(rows, extent.buckets));
  std::vector<KeyNumbers> numbers;
  if (has_key_numbers) {
    numbers.assign(labels, KeyNumbers(coordinate_of_row(table, 0), coordinate_of_row(table, rows - 1)));
  }
  Columns columns(labels);
  for_each_timed_row(table, variable, places, [&](double coordinate, std::span<const double> values) {
    for (std::size_t label = 0; label < labels; ++label) {
      const double value = values[places[label]];
      if (is_envelope) {
        envelopes[label].add(value);
      } else {
        columns[label].push_back(value);
      }
      if (has_key_numbers) numbers[label].add(coordinate, value);
    }
  });
  for (std::size_t label = 0; label < envelopes.size(); ++label) columns[label] = envelopes[label].points();
  Digest out{std::move(columns)};
  if (has_key_numbers) {
    out.key_numbers = "[";
    for (const KeyNumbers& number : numbers) {
      const double values[] = {number.largest(), number.rms(), number.late_amplitude(), number.time_of_largest(),
                               number.last()};
      out.key_numbers += (out.key_numbers.size() > 1 ? "," : "") + json_numbers(values);
    }
    out.key_numbers += ']';
  }
  return out;
}

}  // namespace

std::string attributes_json(const Attributes& attributes, std::size_t longest) {
  std::string out = "{";
  for (const auto& [name, value] : attributes) {
    if (out.size() > 1) out += ',';
    const std::string shown = value.size() > longest ? value.substr(0, longest) + "..." : value;
    out += json_string(name) + ':' + json_string(shown);
  }
  return out + '}';
}

std::string table_json(const TableSource& table, const Extent& extent) {
  const std::size_t rows = table.rows();
  const bool is_envelope = rows > extent.whole_up_to;
  const bool is_timed = table.row_dimension() == "time" && rows > 0 && !table.variables().empty();
  const std::size_t window_rows = is_envelope ? std::min(extent.window_rows, rows) : 0;

  std::string variables = "[", overview = "[", window = "[", key_numbers = "[";
  for (std::size_t v = 0; v < table.variables().size(); ++v) {
    const Variable& variable = table.variables()[v];
    const std::vector<std::size_t> labels = shown_labels(variable, extent.labels);
    const int digits = v == 0 ? coordinate_digits : value_digits;
    Digest kept;
    if (v == 0 && is_envelope) {
      kept.columns.emplace_back();
      for (const std::size_t row : Envelope::rows_of_points(rows, extent.buckets)) {
        kept.columns.front().push_back(coordinate_of_row(table, row));
      }
    } else {
      kept = digest(table, v, labels, is_timed, is_envelope, extent);
    }
    const char* comma = v > 0 ? "," : "";
    variables += comma + variable_json(variable, labels);
    overview += comma + columns_json(kept.columns, digits);
    key_numbers += comma + kept.key_numbers;
    window += comma + columns_json(read_columns(table, v, rows - window_rows, window_rows, labels), digits);
  }
  return fmt::format(
      R"({{"name":{},"row_dimension":{},"rows":{},"attributes":{},"variables":{}],"overview":{}],"is_envelope":{},)"
      R"("window":{},"window_first_row":{},"key_numbers":{},"reactions":{},"distribution":{}}})",
      json_string(table.name()), json_string(table.row_dimension()), rows, attributes_json(table.attributes()),
      variables, overview, is_envelope, window_rows > 0 ? window + ']' : "null", rows - window_rows,
      is_timed ? key_numbers + ']' : "null", is_timed ? reactions_json(table) : "null", step_distribution_json(table));
}

}  // namespace rubato::report
