#include <rubato/report/json.hpp>
#include <rubato/report/step_distribution.hpp>
#include <rubato/report/table_pieces.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::report {
namespace {

constexpr double bins_a_decade = 8.0;
constexpr std::size_t least_bins = 4, most_bins = 64;

std::size_t place_of(const TableSource& table, const std::string& name) {
  const auto& variables = table.variables();
  const auto found =
      std::find_if(variables.begin(), variables.end(), [&](const Variable& v) { return v.name == name; });
  return static_cast<std::size_t>(found - variables.begin());
}

bool is_of_steps(const TableSource& table) {
  const auto& attributes = table.attributes();
  return std::find(attributes.begin(), attributes.end(), std::pair<std::string, std::string>("type", "steps")) !=
         attributes.end();
}

/// Calls use(length) for every step that was accepted.
template <class Use>
void for_each_step(const TableSource& table, std::size_t step, std::size_t accepted, Use use) {
  std::vector<double> lengths, verdicts;
  for (std::size_t done = 0; done < table.rows();) {
    const std::size_t count = std::min(piece_rows, table.rows() - done);
    lengths.resize(count);
    verdicts.resize(count);
    table.read(step, done, count, 1, lengths);
    table.read(accepted, done, count, 1, verdicts);
    for (std::size_t i = 0; i < count; ++i)
      if (verdicts[i] == 1.0 && lengths[i] > 0.0) use(lengths[i]);
    done += count;
  }
}

}  // namespace

std::string step_distribution_json(const TableSource& table) {
  const std::size_t step = place_of(table, "step"), accepted = place_of(table, "accepted");
  if (!is_of_steps(table) || std::max(step, accepted) >= table.variables().size()) return "null";
  double shortest = HUGE_VAL, longest = 0.0;
  for_each_step(table, step, accepted, [&](double length) {
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
  });
  if (!(longest > 0.0)) return "null";
  // Equal steps have a bin around them.
  const double low = std::log10(shortest) - 1e-3, range = std::log10(longest) + 1e-3 - low;
  const auto bins = std::clamp(static_cast<std::size_t>(std::ceil(range * bins_a_decade)), least_bins, most_bins);
  std::vector<double> edges(bins + 1), counts(bins, 0.0);
  for (std::size_t i = 0; i <= bins; ++i)
    edges[i] = std::pow(10.0, low + range * static_cast<double>(i) / static_cast<double>(bins));
  for_each_step(table, step, accepted, [&](double length) {
    const double place = (std::log10(length) - low) / range * static_cast<double>(bins);
    counts[std::min(static_cast<std::size_t>(std::max(place, 0.0)), bins - 1)] += 1.0;
  });
  return fmt::format(R"({{"edges":{},"counts":{}}})", json_numbers(edges), json_numbers(counts));
}

}  // namespace rubato::report
