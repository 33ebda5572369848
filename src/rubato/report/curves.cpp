#include <rubato/report/curves.hpp>
#include <rubato/report/table_pieces.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace rubato::report {
namespace {

std::string attribute(const Attributes& attributes, std::string_view name) {
  for (const auto& [key, value] : attributes)
    if (key == name) return value;
  return {};
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t from = 0; (from = text.find_first_not_of(", ", from)) != std::string::npos;) {
    const std::size_t to = std::min(text.find_first_of(", ", from), text.size());
    words.push_back(text.substr(from, to - from));
    from = to;
  }
  return words;
}

bool is_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// A column of a variable without a dimension, read along with others.
struct Reader {
  const TableSource& table;
  std::size_t variable;
  std::vector<double> piece = {};

  void read(std::size_t first, std::size_t rows) {
    piece.resize(rows);
    table.read(variable, first, rows, 1, piece);
  }
};

/// Of a damper curve.
bool is_over_the_parameter(std::string_view table) {
  return table.empty() || table == "peaks" || table == "linear" || table == "bands";
}

}  // namespace

std::optional<CurveLayout> curve_layout(const TableSource& table, const Attributes& analysis) {
  const std::string type = attribute(analysis, "type");
  const bool has_histories = type == "swept_transient" && table.name() == "histories";
  if (type != "frequency_response" && type != "damper_curve" && !has_histories) return std::nullopt;
  const auto& variables = table.variables();
  const auto index_of = [&](std::string_view name) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < variables.size(); ++i)
      if (variables[i].name == name && variables[i].dimension.empty()) return i;
    return std::nullopt;
  };
  const std::string parameter = attribute(analysis, "parameter");
  std::optional<std::size_t> abscissa = index_of("time");
  if (!abscissa && type == "damper_curve" && is_over_the_parameter(table.name())) {
    abscissa = index_of(parameter);
    if (!abscissa && !variables.empty() && variables[0].dimension.empty()) abscissa = 0;
  }
  if (!abscissa) abscissa = index_of("angular_frequency");
  if (!abscissa) return std::nullopt;

  std::vector<std::string> names = words_of(attribute(analysis, "swept_parameters"));
  if (!parameter.empty()) names.push_back(parameter);
  for (const char* kind : {"direction", "peak"}) names.emplace_back(kind);
  if (variables[*abscissa].name == "time") names.emplace_back("angular_frequency");
  CurveLayout layout{*abscissa, {}};
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const bool is_key = std::find(names.begin(), names.end(), variables[i].name) != names.end();
    if (is_key && i != *abscissa && variables[i].dimension.empty()) layout.keys.push_back(i);
  }
  return layout;
}

std::vector<CurveRows> find_curves(const TableSource& table, const CurveLayout& layout) {
  std::vector<CurveRows> curves;
  Reader abscissa{table, layout.abscissa};
  std::vector<Reader> keys;
  for (const std::size_t key : layout.keys) keys.push_back({table, key});
  std::vector<double> current(keys.size());
  double last = NAN;
  int direction = 0;
  const std::size_t rows = table.rows();
  for (std::size_t done = 0; done < rows;) {
    const std::size_t count = std::min(piece_rows, rows - done);
    abscissa.read(done, count);
    for (Reader& key : keys) key.read(done, count);
    for (std::size_t i = 0; i < count; ++i) {
      const double x = abscissa.piece[i];
      const int step = x > last ? 1 : x < last ? -1 : 0;
      bool is_new = curves.empty() || step * direction < 0;
      for (std::size_t k = 0; k < keys.size(); ++k) {
        is_new = is_new || !is_same(keys[k].piece[i], current[k]);
        current[k] = keys[k].piece[i];
      }
      if (is_new) {
        curves.push_back({done + i, 1});
        direction = 0;
      } else {
        ++curves.back().rows;
        if (step != 0) direction = step;
      }
      last = x;
    }
    done += count;
  }
  return curves;
}

CurveLayout longest_curves(const TableSource& table, CurveLayout layout, std::vector<CurveRows>& curves) {
  curves = find_curves(table, layout);
  if (2 * curves.size() <= table.rows()) return layout;
  for (std::size_t k = layout.keys.size(); k-- > 0;) {
    CurveLayout other = layout;
    std::swap(other.abscissa, other.keys[k]);
    std::vector<CurveRows> found = find_curves(table, other);
    if (found.size() < curves.size() / 2) {
      curves = std::move(found);
      return other;
    }
  }
  return layout;
}

std::vector<std::size_t> spread(std::size_t total, std::size_t count) {
  std::vector<std::size_t> chosen(std::min(total, count));
  for (std::size_t i = 0; i < chosen.size(); ++i)
    chosen[i] = total <= count ? i : count == 1 ? 0 : i * (total - 1) / (count - 1);
  return chosen;
}

}  // namespace rubato::report
