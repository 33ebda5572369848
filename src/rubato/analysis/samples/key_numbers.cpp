#include <rubato/analysis/samples/key_numbers.hpp>
#include <rubato/integrate/events.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>

namespace rubato::analysis {
namespace {

using integrate::Change;
using Family = integrate::NonlinearPart::Family;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

std::span<const double> slice(const std::vector<double>& values, std::size_t from, std::size_t count) {
  return std::span(values).subspan(from, count);
}

KeyNumbers of_static(const KeptTable& main) {
  KeyNumbers numbers;
  std::size_t place = 0;
  for (std::size_t i = 0; i < main.layout.blocks.size(); ++i) {
    const results::Block& block = main.layout.blocks[i];
    if (i > 0) numbers.add(block, slice(main.rows, place, block.width()));
    place += block.width();
  }
  return numbers;
}

/// The place of a column that is one of a row; the layout has it.
std::size_t place_of(const results::TableLayout& layout, const std::string& variable) {
  std::size_t place = 0;
  for (const results::Block& block : layout.blocks) {
    if (block.variable == variable) break;
    place += block.width();
  }
  return place;
}

KeyNumbers of_modes(const KeptTable& main, bool has_limits) {
  const std::size_t width = main.layout.row_width();
  const std::size_t limit = place_of(main.layout, "limit"), mode = place_of(main.layout, "mode"),
                    frequency = place_of(main.layout, "frequency"), ratio = place_of(main.layout, "damping_ratio");
  std::vector<std::string> labels;
  std::vector<double> frequencies, ratios;
  for (std::size_t row = 0; row + width <= main.rows.size(); row += width) {
    const double* values = main.rows.data() + row;
    const std::string number = fmt::format("mode{:.0f}", values[mode]);
    const auto& words = main.layout.blocks.front().categories;
    labels.push_back(has_limits ? words.at(static_cast<std::size_t>(values[limit])) + "." + number : number);
    frequencies.push_back(values[frequency]);
    ratios.push_back(values[ratio]);
  }
  KeyNumbers numbers;
  if (labels.empty()) return numbers;
  numbers.add({"frequency", "Hz", "natural", "mode", labels}, frequencies);
  numbers.add({"damping_ratio", "1", "-Re(eigenvalue) / |eigenvalue|", "mode", labels}, ratios);
  return numbers;
}

void add_extremes(const KeptTable& table, KeyNumbers& numbers) {
  const Extremes& extremes = table.extremes;
  if (extremes.last.empty()) return;
  std::size_t place = 0;
  for (std::size_t i = 0; i < table.layout.blocks.size(); ++i) {
    const results::Block& of = table.layout.blocks[i];
    const std::size_t width = of.width(), from = place;
    place += width;
    if (i == 0 || !of.categories.empty()) continue;
    const auto add = [&](const char* suffix, const std::string& unit, const std::string& what,
                         const std::vector<double>& values) {
      results::Block block = of;
      block.variable += suffix;
      block.unit = unit;
      block.description = what + (of.description.empty() ? of.variable : of.description);
      numbers.add(block, slice(values, from, width));
    };
    add("_min", of.unit, "least: ", extremes.least);
    add("_min_time", "s", "when it is least: ", extremes.time_of_least);
    add("_max", of.unit, "largest: ", extremes.largest);
    add("_max_time", "s", "when it is largest: ", extremes.time_of_largest);
    add("_end", of.unit, "at the end: ", extremes.last);
  }
}

void add_energy(const KeptTable& table, KeyNumbers& numbers) {
  for (std::size_t i = 1; i < table.layout.blocks.size() && i < table.rows.size(); ++i) {
    results::Block block = table.layout.blocks[i];
    block.variable = "energy_" + block.variable + "_end";
    block.description = "at the end: " + block.description;
    numbers.add(block, slice(table.rows, i, 1));
  }
}

struct ChangeColumns {
  Change change;
  const char* word;
  std::set<Family> families;
};

/// Which parts can do what.
const std::array<ChangeColumns, 6>& changes() {
  static const std::set<Family> rubbing{Family::slider, Family::pressed_slider, Family::contact,
                                        Family::joint_friction},
      touching{Family::stop, Family::contact};
  static const std::array<ChangeColumns, 6> all{{{Change::locks, "locks", {Family::lock}},
                                                 {Change::lets_go, "lets_go", {Family::lock}},
                                                 {Change::closes, "closes", touching},
                                                 {Change::opens, "opens", touching},
                                                 {Change::slips, "slips", rubbing},
                                                 {Change::sticks, "sticks", rubbing}}};
  return all;
}

/// How often each part did something, and when first. What holds at the start counts: it is a row of the table.
void add_events(const KeptTable* table, const integrate::SystemKind& kind, KeyNumbers& numbers) {
  const auto parts = kind.nonlinear_parts();
  const std::size_t width = table ? table->layout.row_width() : 0;  // time, part, change and more
  for (const ChangeColumns& columns : changes()) {
    std::vector<std::string> labels;
    for (const auto& part : parts)
      if (columns.families.contains(part.family) && std::find(labels.begin(), labels.end(), part.name) == labels.end())
        labels.push_back(part.name);
    if (labels.empty()) continue;
    std::vector<double> counts(labels.size(), 0.0), firsts(labels.size(), nothing);
    for (std::size_t row = 0; table && row + width <= table->rows.size(); row += width) {
      const double* values = table->rows.data() + row;
      if (static_cast<Change>(values[2]) != columns.change) continue;
      const auto& name = table->layout.blocks[1].categories.at(static_cast<std::size_t>(values[1]));
      const auto found = std::find(labels.begin(), labels.end(), name);
      if (found == labels.end()) continue;
      const auto i = static_cast<std::size_t>(found - labels.begin());
      if (counts[i] == 0.0) firsts[i] = values[0];
      counts[i] += 1.0;
    }
    const std::string word = columns.word, dimension = "part_that_" + word;
    numbers.add({word + "_count", "1", "how often it " + word, dimension, labels}, counts);
    numbers.add({word + "_first", "s", "when it first " + word, dimension, labels}, firsts);
  }
}

}  // namespace

void KeyNumbers::add(const results::Block& block, std::span<const double> of_block) {
  blocks.push_back(block);
  values.insert(values.end(), of_block.begin(), of_block.end());
}

std::map<std::string, Kept> kept_for_key_numbers(const model::AnalysisDescription& sample, bool all) {
  if (!std::holds_alternative<model::TransientDescription>(sample.task)) return {{"", Kept::rows}};
  // Where rows are those of times that are asked for, every step is shown besides.
  return {{"", all ? Kept::extremes_and_rows : Kept::extremes},
          {"every_step", Kept::extremes},
          {"energy", Kept::last_row},
          {"events", Kept::rows}};
}

KeyNumbers key_numbers_of(const model::AnalysisDescription& sample, const SampleSink& tables,
                          const integrate::SystemKind& kind) {
  const KeptTable* main = tables.find("");
  if (!main) return {};
  if (std::holds_alternative<model::StaticDescription>(sample.task)) return of_static(*main);
  if (const auto* modes = std::get_if<model::ModesDescription>(&sample.task))
    return of_modes(*main, modes->contacts || kind.limit_count() > 1);
  KeyNumbers numbers;
  // The method exact takes no steps to show.
  const KeptTable* every_step = tables.find("every_step");
  add_extremes(every_step && !every_step->extremes.last.empty() ? *every_step : *main, numbers);
  if (const KeptTable* energy = tables.find("energy")) add_energy(*energy, numbers);
  add_events(tables.find("events"), kind, numbers);
  return numbers;
}

}  // namespace rubato::analysis
