#include <rubato/analysis/extremes.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rubato::analysis {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// A column of numbers.
struct Column {
  std::size_t unit, place;
};

}  // namespace

void Extremes::take(std::span<const double> row) {
  if (last.empty())
    for (auto* values : {&least, &time_of_least, &largest, &time_of_largest}) values->assign(row.size(), nothing);
  last.assign(row.begin(), row.end());
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (std::isnan(row[i])) continue;
    if (!(least[i] <= row[i])) {
      least[i] = row[i];
      time_of_least[i] = row[0];
    }
    if (!(largest[i] >= row[i])) {
      largest[i] = row[i];
      time_of_largest[i] = row[0];
    }
  }
}

void write_extremes(const results::TableLayout& of, const Extremes& extremes, results::Sink& sink) {
  if (extremes.last.empty()) return;
  std::vector<Column> columns;
  std::vector<std::string> names, units;
  std::size_t place = 0;
  for (std::size_t i = 0; i < of.blocks.size(); ++i) {
    const results::Block& block = of.blocks[i];
    const std::size_t from = place;
    place += block.width();
    if (i == 0 || !block.categories.empty()) continue;
    const auto known = std::find(units.begin(), units.end(), block.unit);
    const auto unit = static_cast<std::size_t>(known - units.begin());
    if (known == units.end()) units.push_back(block.unit);
    for (std::size_t c = 0; c < block.width(); ++c) {
      names.push_back(block.dimension.empty() ? block.variable : block.labels[c] + "." + block.variable);
      columns.push_back({unit, from + c});
    }
  }
  if (columns.empty()) return;
  const auto rows = sink.open({of.analysis,
                               "extremes",
                               "column",
                               {{"column", "1", "a column of the analysis", "", {}, names},
                                {"unit", "1", "of its values", "", {}, units},
                                {"least", "1", "its least value, over all steps", "", {}},
                                {"time_of_least", "s", "when it is least", "", {}},
                                {"largest", "1", "its largest value, over all steps", "", {}},
                                {"time_of_largest", "s", "when it is largest", "", {}}},
                               {{"type", "extremes"}}});
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t at = columns[c].place;
    const std::array<double, 6> row{static_cast<double>(c), static_cast<double>(columns[c].unit),
                                    extremes.least[at],     extremes.time_of_least[at],
                                    extremes.largest[at],   extremes.time_of_largest[at]};
    rows->append(row);
  }
}

}  // namespace rubato::analysis
