#include <rubato/io/compare_results.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace rubato::io {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double same_place = 1e-9;  // of the span of times, or of a key: rows of the same place
constexpr double round_off = 1e-13;  // of the largest of a quantity: a column below it is zero but for rounding

using Rows = std::vector<std::pair<std::size_t, std::size_t>>;

/// "position [m]" of "mass.position [m]"
std::string quantity_of(const std::string& name) {
  const std::size_t unit = name.find(" ["), dot = name.rfind('.', unit);
  return dot == std::string::npos ? name : name.substr(dot + 1);
}

double largest_of(const ResultColumn& column) {
  double largest = 0.0;
  for (const double value : column.numbers)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest;
}

/// How a run chose its steps is no result: two runs of other tolerances differ in it however well they agree. So do the
/// times of extremes, where two are nearly equal; what they are of is compared row by row.
std::string why_not_counted(const std::filesystem::path& table) {
  const auto kind = table.stem().extension();
  if (kind == ".steps") return "how the runs chose their steps";
  return kind == ".extremes" ? "of equal extremes either time may be the first" : "";
}

bool is_history(const ResultTable& table) {
  if (table.rows < 2 || table.columns.empty() || table.columns.front().name != "time [s]") return false;
  for (const ResultColumn& column : table.columns)
    if (column.is_text()) return false;
  const auto& times = table.columns.front().numbers;
  return std::is_sorted(times.begin(), times.end()) && times.front() < times.back();
}

bool has_same_times(const ResultTable& a, const ResultTable& b) {
  const auto &first = a.columns.front().numbers, &second = b.columns.front().numbers;
  const double span = std::max(first.back() - first.front(), second.back() - second.front());
  return std::equal(first.begin(), first.end(), second.begin(), second.end(),
                    [&](double one, double other) { return std::abs(one - other) <= same_place * span; });
}

/// Straight lines through a column of a history; at a jump, a time that stands twice, the value behind it.
double interpolated(const std::vector<double>& times, const std::vector<double>& values, double t) {
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  if (after == times.begin()) return values.front();
  const auto i = static_cast<std::size_t>(after - times.begin());
  if (i == times.size()) return values.back();
  const double share = (t - times[i - 1]) / (times[i] - times[i - 1]);
  return share == 0.0 ? values[i - 1] : values[i - 1] + share * (values[i] - values[i - 1]);
}

/// About the largest error of those lines: a quarter of what a line over two intervals misses between them.
double line_error(const std::vector<double>& times, const std::vector<double>& values) {
  double largest = 0.0;
  for (std::size_t i = 1; i + 1 < times.size(); ++i) {
    if (!(times[i - 1] < times[i] && times[i] < times[i + 1])) continue;
    const double share = (times[i] - times[i - 1]) / (times[i + 1] - times[i - 1]);
    const double missed = values[i] - values[i - 1] - share * (values[i + 1] - values[i - 1]);
    if (std::isfinite(missed)) largest = std::max(largest, 0.25 * std::abs(missed));
  }
  return largest;
}

double distance(double a, double b, bool is_phase) {
  if (std::isnan(a) && std::isnan(b)) return 0.0;
  if (a == b) return 0.0;
  const double d = std::abs(a - b);
  return is_phase && std::isfinite(d) ? std::abs(std::remainder(d, 2.0 * std::numbers::pi)) : d;
}

std::string text_at(const ResultColumn& column, std::size_t row) {
  if (column.is_text()) return column.words[row].empty() ? "nothing" : column.words[row];
  return std::isnan(column.numbers[row]) ? "nothing" : fmt::format("{}", column.numbers[row]);
}

/// Words, and numbers that one of them lacks: those that differ are counted.
void count_differing(const ResultColumn& a, const ResultColumn& b, const Rows& rows, ColumnDifference& difference) {
  std::size_t count = 0, first = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto [one, other] = rows[i];
    const bool is_different = a.is_text() || b.is_text() ? text_at(a, one) != text_at(b, other)
                                                         : std::isnan(a.numbers[one]) != std::isnan(b.numbers[other]);
    if (is_different && count++ == 0) first = i;
  }
  if (count == 0) return;
  difference.relative = difference.largest = infinity;
  difference.at = static_cast<double>(rows[first].first + 1);
  difference.told = fmt::format("{} of {} rows differ, the first: {} and {}", count, rows.size(),
                                text_at(a, rows[first].first), text_at(b, rows[first].second));
}

class Comparison {
 public:
  Comparison(const ResultTable& a, const ResultTable& b, TableComparison& result) : a_(a), b_(b), result_(result) {
    for (const ResultTable* table : {&a, &b})
      for (const ResultColumn& column : table->columns) {
        double& largest = of_quantity_[quantity_of(column.name)];
        largest = std::max(largest, largest_of(column));
      }
    find_missing_columns();
    result.is_history = is_history(a) && is_history(b);
    if (result.is_history && !has_same_times(a, b))
      compare_histories();
    else
      compare_rows(matched_rows());
  }

 private:
  void find_missing_columns() {
    for (const auto& [table, other, which] : {std::tuple{&a_, &b_, "second"}, std::tuple{&b_, &a_, "first"}})
      for (const ResultColumn& column : table->columns)
        if (!other->find(column.name))
          result_.gaps.push_back(fmt::format("the {} has no column \"{}\"", which, column.name));
  }

  double scale_of(const ResultColumn& a, const ResultColumn& b) const {
    const double scale = std::max({largest_of(a), largest_of(b), round_off * of_quantity_.at(quantity_of(a.name))});
    return a.name == "residue [J]" ? std::max(scale, largest_energy()) : scale;
  }

  /// Of an energy ledger. Its residue is an error: two good runs have two that have nothing in common but their size.
  double largest_energy() const {
    double largest = 0.0;
    for (const auto& [quantity, value] : of_quantity_)
      if (quantity.size() > 4 && quantity.compare(quantity.size() - 4, 4, " [J]") == 0)
        largest = std::max(largest, value);
    return largest;
  }

  void compare_rows(const Rows& rows) {
    for (const ResultColumn& a : a_.columns) {
      const ResultColumn* b = b_.find(a.name);
      if (!b) continue;
      ColumnDifference difference{a.name};
      count_differing(a, *b, rows, difference);
      if (difference.told.empty() && !a.is_text() && !b->is_text()) {
        const double scale = scale_of(a, *b);
        const bool is_phase = quantity_of(a.name) == "phase [rad]";
        for (const auto& [one, other] : rows) {
          const double d = distance(a.numbers[one], b->numbers[other], is_phase);
          if (!(d > difference.largest)) continue;
          difference.largest = d;
          difference.at = result_.is_history ? a_.columns.front().numbers[one] : static_cast<double>(one + 1);
        }
        difference.relative = difference.largest > 0.0 ? difference.largest / scale : 0.0;
      }
      result_.columns.push_back(std::move(difference));
    }
  }

  void compare_histories() {
    const bool a_is_shorter = a_.rows <= b_.rows;
    const ResultTable &shorter = a_is_shorter ? a_ : b_, &longer = a_is_shorter ? b_ : a_;
    const auto &times = shorter.columns.front().numbers, &other_times = longer.columns.front().numbers;
    const double from = std::max(times.front(), other_times.front()), to = std::min(times.back(), other_times.back());
    const auto &first = a_.columns.front().numbers, &second = b_.columns.front().numbers;
    result_.notes.push_back(fmt::format(
        "the times differ ({} and {} rows): compared at those of the {}, the other one interpolated by straight lines",
        a_.rows, b_.rows, a_is_shorter ? "first" : "second"));
    const double span = std::max(first.back() - first.front(), second.back() - second.front());
    if (std::abs(first.front() - second.front()) > same_place * span ||
        std::abs(first.back() - second.back()) > same_place * span)
      result_.gaps.push_back(fmt::format("the first goes from {} s to {} s, the second from {} s to {} s",
                                         first.front(), first.back(), second.front(), second.back()));
    for (std::size_t i = 1; i < shorter.columns.size(); ++i) {
      const ResultColumn& column = shorter.columns[i];
      const ResultColumn* other = longer.find(column.name);
      if (!other) continue;
      ColumnDifference difference{column.name};
      for (std::size_t row = 0; row < times.size(); ++row) {
        const double t = times[row];
        if (t < from || t > to) continue;
        double d = distance(column.numbers[row], interpolated(other_times, other->numbers, t), false);
        if (std::isnan(d)) d = infinity;  // a number beside nothing
        if (!(d > difference.largest)) continue;
        difference.largest = d;
        difference.at = t;
      }
      const double scale = scale_of(column, *other);
      difference.relative = difference.largest > 0.0 ? difference.largest / scale : 0.0;
      difference.interpolation = scale > 0.0 ? line_error(other_times, other->numbers) / scale : 0.0;
      result_.columns.push_back(std::move(difference));
    }
  }

  Rows matched_rows() {
    Rows rows;
    if (a_.rows == b_.rows) {
      for (std::size_t i = 0; i < a_.rows; ++i) rows.emplace_back(i, i);
      return rows;
    }
    const std::vector<const ResultColumn*> first = key_columns();
    std::vector<const ResultColumn*> second;
    for (const ResultColumn* column : first) second.push_back(b_.find(column->name));
    // By the words of the keys, which are mostly the same; then what is left by the values nearby of the last.
    std::unordered_map<std::string, std::vector<std::size_t>> by_words;
    std::vector<std::size_t> partners(a_.rows, b_.rows), left;
    if (!first.empty())
      for (std::size_t j = b_.rows; j-- > 0;) by_words[words_of(second, j)].push_back(j);
    for (std::size_t i = 0; i < a_.rows && !first.empty(); ++i) {
      const auto found = by_words.find(words_of(first, i));
      if (found == by_words.end() || found->second.empty()) continue;
      partners[i] = found->second.back();
      found->second.pop_back();
    }
    for (const auto& [words, places] : by_words) left.insert(left.end(), places.begin(), places.end());
    if (!first.empty() && !first.back()->is_text() && !second.back()->is_text())
      match_nearby(first, second, std::move(left), partners);
    for (std::size_t i = 0; i < a_.rows; ++i)
      if (partners[i] < b_.rows) rows.emplace_back(i, partners[i]);
    result_.gaps.push_back(fmt::format("{} and {} rows, of which {} are of the same {}", a_.rows, b_.rows, rows.size(),
                                       first.empty() ? "place" : "\"" + first.back()->name + "\""));
    return rows;
  }

  /// Those by which rows of tables with unequal numbers of them are matched: what was asked for, not what was found.
  /// Frequencies are found in tables of modes (`mode` numbers them) and of damper curves (with an `objective [m]`).
  std::vector<const ResultColumn*> key_columns() const {
    const auto both_have = [&](const char* name) { return a_.find(name) && b_.find(name); };
    const char* const frequency = "angular_frequency [rad/s]";
    const bool is_curve = std::any_of(a_.columns.begin(), a_.columns.end(),
                                      [](const ResultColumn& one) { return one.name.rfind("objective", 0) == 0; });
    const std::string last = both_have("mode") ? "mode" : both_have("peak") ? "peak" : frequency;
    const bool has_last = both_have(last.c_str());
    std::vector<const ResultColumn*> keys;
    for (const ResultColumn& column : a_.columns) {
      if (!b_.find(column.name) || (is_curve && column.name == frequency)) break;
      keys.push_back(&column);
      if (!has_last || column.name == last) break;
    }
    return keys;
  }

  static std::string words_of(const std::vector<const ResultColumn*>& keys, std::size_t row) {
    std::string words;
    for (const ResultColumn* column : keys) words += text_at(*column, row) + '\n';
    return words;
  }

  /// Partners of the rows of the first table that have none, among those of the second that are left.
  static void match_nearby(const std::vector<const ResultColumn*>& first,
                           const std::vector<const ResultColumn*>& second, std::vector<std::size_t> left,
                           std::vector<std::size_t>& partners) {
    const std::size_t none = second.back()->numbers.size();
    const auto& values = second.back()->numbers;
    left.erase(std::remove_if(left.begin(), left.end(), [&](std::size_t j) { return std::isnan(values[j]); }),
               left.end());
    std::sort(left.begin(), left.end(),
              [&](std::size_t i, std::size_t j) { return std::pair(values[i], i) < std::pair(values[j], j); });
    for (std::size_t i = 0; i < partners.size() && !left.empty(); ++i) {
      const double value = first.back()->numbers[i];
      if (partners[i] < none || std::isnan(value)) continue;
      const double reach = 2.0 * same_place * std::abs(value);
      auto near = std::lower_bound(left.begin(), left.end(), value - reach,
                                   [&](std::size_t j, double least) { return values[j] < least; });
      while (near != left.end() && values[*near] <= value + reach && !has_same_key(first, i, second, *near)) ++near;
      if (near == left.end() || values[*near] > value + reach) continue;
      partners[i] = *near;
      left.erase(near);
    }
  }

  static bool has_same_key(const std::vector<const ResultColumn*>& a, std::size_t i,
                           const std::vector<const ResultColumn*>& b, std::size_t j) {
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (a[k]->is_text() || b[k]->is_text()) {
        if (text_at(*a[k], i) != text_at(*b[k], j)) return false;
        continue;
      }
      const double one = a[k]->numbers[i], other = b[k]->numbers[j];
      if (!(std::abs(one - other) <= same_place * std::max(std::abs(one), std::abs(other)))) return false;
    }
    return true;
  }

  const ResultTable &a_, &b_;
  TableComparison& result_;
  std::map<std::string, double> of_quantity_;
};

}  // namespace

TableComparison compare_tables(const std::string& name, const ResultTable& a, const ResultTable& b) {
  TableComparison result;
  result.table = name;
  Comparison(a, b, result);
  return result;
}

std::vector<TableComparison> compare_results(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto first = result_tables(a), second = result_tables(b);
  std::set<std::filesystem::path> all(first.begin(), first.end());
  all.insert(second.begin(), second.end());
  std::vector<TableComparison> result;
  for (const auto& table : all) {
    if (table.extension() == ".partial") {
      TableComparison unfinished;
      unfinished.table = table.string();
      for (const auto& [tables, which] : {std::pair{&first, "first"}, std::pair{&second, "second"}})
        if (std::binary_search(tables->begin(), tables->end(), table))
          unfinished.gaps.push_back(fmt::format("a run of the {} ended before this table was whole", which));
      result.push_back(std::move(unfinished));
      continue;
    }
    const bool in_first = std::binary_search(first.begin(), first.end(), table);
    if (in_first && std::binary_search(second.begin(), second.end(), table)) {
      result.push_back(compare_tables(table.string(), read_result_table(a / table), read_result_table(b / table)));
      result.back().not_counted = why_not_counted(table);
      continue;
    }
    TableComparison missing;
    missing.table = table.string();
    missing.gaps.push_back(fmt::format("only the {} has this table", in_first ? "first" : "second"));
    missing.not_counted = why_not_counted(table);
    result.push_back(std::move(missing));
  }
  return result;
}

}  // namespace rubato::io
