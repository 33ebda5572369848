#include <rubato/analysis/packed_numbers.hpp>
#include <rubato/analysis/samples/sample_tables.hpp>
#include <rubato/analysis/sweep_samples.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rubato::analysis {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

results::Block scalar(const std::string& variable, const std::string& unit, const std::string& description) {
  return {variable, unit, description, "", {}};
}

/// The number of the sample and the swept parameters, which every row of every table begins with.
std::vector<results::Block> heads(const SamplesPlan& plan) {
  std::vector<results::Block> blocks{scalar("sample", "1", "number of the sample, from 1")};
  for (std::size_t i = 0; i < plan.sweep.names().size(); ++i) {
    const bool is_speed = plan.campbell && plan.campbell->speed == i;
    blocks.push_back(scalar(plan.sweep.names()[i], "",
                            is_speed ? "swept parameter, the speed [" + plan.campbell->unit + "]" : "swept parameter"));
  }
  return blocks;
}

std::vector<double> head_of(const Sweep& sweep, long number) {
  std::vector<double> row(1 + sweep.names().size());
  row[0] = static_cast<double>(number + 1);
  sweep.values(number, std::span(row).subspan(1));
  return row;
}

const char* type_of(const model::AnalysisDescription& sample) {
  if (std::holds_alternative<model::TransientDescription>(sample.task)) return "swept_transient";
  return std::holds_alternative<model::ModesDescription>(sample.task) ? "swept_modes" : "swept_static";
}

std::string sweep_name(Sweep::Kind kind) {
  return kind == Sweep::Kind::random ? "random" : kind == Sweep::Kind::cases ? "cases" : "grid";
}

std::vector<std::pair<std::string, std::string>> attributes_of(const SamplesPlan& plan) {
  std::vector<std::pair<std::string, std::string>> attributes{
      {"type", type_of(plan.sample)},
      {"sweep", sweep_name(plan.sweep.kind())},
      {"swept_parameters", fmt::format("{}", fmt::join(plan.sweep.names(), ", "))},
      {"samples", std::to_string(plan.sweep.lines())}};
  if (!plan.campbell) return attributes;
  attributes.emplace_back("speed", plan.sweep.names()[plan.campbell->speed]);
  attributes.emplace_back("speed_unit", plan.campbell->unit);
  attributes.emplace_back("speed_factor", fmt::format("{:.17g}", plan.campbell->factor));
  attributes.emplace_back("engine_orders", fmt::format("{}", fmt::join(plan.campbell->orders, ", ")));
  return attributes;
}

/// "mode2.frequency", "steps"
std::string column_name(const results::Block& block, std::size_t label) {
  return block.dimension.empty() ? block.variable : block.labels[label] + "." + block.variable;
}

}  // namespace

LaidColumns::LaidColumns(std::vector<results::Block> blocks) : blocks_(std::move(blocks)) {
  for (const results::Block& block : blocks_)
    for (std::size_t label = 0; label < block.width(); ++label) places_.emplace(column_name(block, label), width_++);
}

std::vector<double> LaidColumns::laid(const std::vector<results::Block>& from, const std::vector<double>& rows,
                                      std::string& left_out) const {
  std::vector<std::size_t> places;  // `width_`: nowhere
  for (const results::Block& block : from)
    for (std::size_t label = 0; label < block.width(); ++label) {
      const auto found = places_.find(column_name(block, label));
      places.push_back(found == places_.end() ? width_ : found->second);
      if (found == places_.end() && left_out.empty()) left_out = column_name(block, label);
    }
  if (places.empty()) return {};
  const std::size_t count = rows.size() / places.size();
  std::vector<double> all(count * width_, nothing);
  for (std::size_t row = 0; row < count; ++row)
    for (std::size_t i = 0; i < places.size(); ++i)
      if (places[i] < width_) all[row * width_ + places[i]] = rows[row * places.size() + i];
  return all;
}

SampleTables::SampleTables(const std::string& name, const SamplesPlan& plan, results::Sink& sink)
    : name_(name), plan_(plan), sink_(sink) {
  if (plan.campbell) campbell_.emplace(*plan.campbell, plan.sweep);
}

void SampleTables::lay(const SampleResult& sample) {
  columns_ = LaidColumns(sample.numbers.blocks);
  row_columns_ = LaidColumns(sample.row_blocks);
  has_columns_ = true;
  for (const auto* columns : {&columns_, &row_columns_})
    for (const results::Block& block : columns->blocks())
      for (std::size_t i = 0; i < plan_.sweep.names().size(); ++i)
        if (plan_.sweep.names()[i] == block.variable || plan_.sweep.names()[i] == block.dimension)
          throw InvalidInput(
              plan_.sweep.where()[i],
              fmt::format("analysis \"{}\": the swept parameter \"{}\" would head a column of results that "
                          "has another meaning; rename it",
                          name_, plan_.sweep.names()[i]));
  for (const results::Block& block : columns_.blocks())
    if (block.dimension == "mode" && block.variable == "frequency") modes_ = block.labels;
  if (plan_.sweep.kind() == Sweep::Kind::random) samples_.resize(columns_.width());
}

/// And writes what came before its columns were known.
void SampleTables::open_main() {
  if (main_) return;
  results::TableLayout layout{name_, "", "sample", heads(plan_), attributes_of(plan_)};
  for (const results::Block& block : columns_.blocks()) layout.blocks.push_back(block);
  layout.blocks.push_back(scalar("warnings", "1", "how many the sample gave"));
  layout.blocks.push_back({"status", "", "what became of the sample", "", {}, sample_statuses});
  main_ = sink_.open(layout);
  if (plan_.keeps_samples && row_columns_.width() > 0) {
    const bool are_modes = std::holds_alternative<model::ModesDescription>(plan_.sample.task);
    results::TableLayout rows{name_, are_modes ? "modes" : "histories", "row", heads(plan_), {{"type", "samples"}}};
    for (const results::Block& block : row_columns_.blocks()) rows.blocks.push_back(block);
    rows_ = sink_.open(rows);
  }
  for (const SampleResult& sample : pending_) write_row(sample);
  pending_.clear();
}

void SampleTables::write_row(const SampleResult& sample) {
  const std::vector<double> head = head_of(plan_.sweep, sample.number);
  std::vector<double> row = head;
  if (sample.status == SampleStatus::done)
    row.insert(row.end(), sample.numbers.values.begin(), sample.numbers.values.end());
  row.resize(head.size() + columns_.width(), nothing);
  row.push_back(sample.warning_count);
  row.push_back(static_cast<double>(sample.status));
  main_->append(row);
  const std::size_t width = row_columns_.width();
  for (std::size_t at = 0; rows_ && at + width <= sample.rows.size(); at += width) {
    row = head;
    row.insert(row.end(), sample.rows.begin() + static_cast<std::ptrdiff_t>(at),
               sample.rows.begin() + static_cast<std::ptrdiff_t>(at + width));
    rows_->append(row);
  }
}

/// Sets the numbers of a sample that is done in the order of the columns.
void SampleTables::order(SampleResult& sample) {
  if (!sample.numbers.blocks.empty()) {
    if (!has_columns_) lay(sample);
    std::string left_out;
    sample.numbers.values = columns_.laid(sample.numbers.blocks, sample.numbers.values, left_out);
    sample.numbers.blocks.clear();
    sample.rows = row_columns_.laid(sample.row_blocks, sample.rows, left_out);
    sample.row_blocks.clear();
    if (!left_out.empty() && left_out_of_++ == 0) left_out_ = left_out;
  }
  // A sample may have nothing to tell: no modes where the joints leave no motion.
  if (sample.numbers.values.empty()) sample.numbers.values.assign(columns_.width(), nothing);
  const std::size_t width = row_columns_.width();
  if (sample.numbers.values.size() != columns_.width() ||
      (width > 0 ? sample.rows.size() % width != 0 : !sample.rows.empty()))
    PackedNumbers::refuse();
}

/// Keeps what is told at the end.
void SampleTables::note(const SampleResult& sample) {
  counts_[static_cast<std::size_t>(sample.status)] += 1.0;
  constexpr std::size_t most_texts = 5;
  for (const std::string& text : sample.warnings) {
    const bool is_new = !told_.contains(text);
    if (is_new && texts_.size() >= most_texts) {
      untold_ += 1.0;
      continue;
    }
    if (is_new) texts_.push_back(text);
    told_.try_emplace(text, Told{sample.number}).first->second.count += 1.0;
  }
  if (sample.status != SampleStatus::done) {
    failures_.push_back({sample.number, sample.status, sample.reason});
    return;
  }
  const auto& values = sample.numbers.values;
  for (std::size_t i = 0; i < samples_.size(); ++i)
    if (!std::isnan(values[i])) samples_[i].push_back(values[i]);
  if (!campbell_ || modes_.empty()) return;
  std::size_t place = 0;
  std::span<const double> frequencies, ratios;
  for (const results::Block& block : columns_.blocks()) {
    if (block.variable == "frequency") frequencies = std::span(values).subspan(place, block.width());
    if (block.variable == "damping_ratio") ratios = std::span(values).subspan(place, block.width());
    place += block.width();
  }
  campbell_->take(sample.number, frequencies, ratios);
}

void SampleTables::write(SampleResult& sample) {
  has_gap_ = has_gap_ || !sample.is_whole;
  if (has_gap_) return;
  if (sample.status == SampleStatus::done) order(sample);
  ++written_;
  note(sample);
  if (!has_columns_) {
    pending_.push_back(sample);
    return;
  }
  open_main();
  write_row(sample);
}

void SampleTables::write_failures() {
  // Texts differ by the times that they tell: each distinct one is a word of the column, up to so many.
  constexpr std::size_t most_reasons = 1000;
  if (failures_.empty()) return;
  std::vector<std::string> words;
  std::map<std::string, std::size_t> places;
  for (const Failure& failure : failures_)
    if (words.size() < most_reasons && places.try_emplace(failure.reason, words.size()).second)
      words.push_back(failure.reason);
  if (words.size() == most_reasons) words.emplace_back("another reason");
  results::TableLayout layout{name_, "failures", "failure", heads(plan_), {{"type", "failures"}}};
  layout.blocks.push_back({"status", "", "what became of the sample", "", {}, sample_statuses});
  layout.blocks.push_back({"reason", "", "why", "", {}, words});
  const auto rows = sink_.open(layout);
  for (const Failure& failure : failures_) {
    const auto found = places.find(failure.reason);
    std::vector<double> row = head_of(plan_.sweep, failure.number);
    row.push_back(static_cast<double>(failure.status));
    row.push_back(static_cast<double>(found == places.end() ? most_reasons : found->second));
    rows->append(row);
  }
}

void SampleTables::write_statistics() {
  if (samples_.empty() || !has_columns_) return;
  static const std::vector<std::string> words{"mean", "deviation", "min", "p05", "p25",
                                              "p50",  "p75",       "p95", "max", "count"};
  results::TableLayout layout{name_, "statistics", "statistic", {}, {{"type", "statistics"}}};
  layout.blocks.push_back(
      {"statistic", "", "of the samples that have the number; pNN: below it NN % of them lie", "", {}, words});
  for (const results::Block& block : columns_.blocks()) layout.blocks.push_back(block);
  const auto rows = sink_.open(layout);
  for (std::size_t word = 0; word < words.size(); ++word) {
    std::vector<double> row{static_cast<double>(word)};
    for (std::vector<double>& values : samples_) {
      const auto count = static_cast<double>(values.size());
      const double mean = values.empty() ? nothing : std::accumulate(values.begin(), values.end(), 0.0) / count;
      const std::string& what = words[word];
      if (what == "count") {
        row.push_back(count);
      } else if (values.empty()) {
        row.push_back(nothing);
      } else if (what == "mean") {
        row.push_back(mean);
      } else if (what == "deviation") {
        double sum = 0.0;
        for (const double value : values) sum += (value - mean) * (value - mean);
        row.push_back(values.size() > 1 ? std::sqrt(sum / (count - 1.0)) : nothing);
      } else {
        const double share = what == "min" ? 0.0 : what == "max" ? 1.0 : std::stod(what.substr(1)) / 100.0;
        row.push_back(percentile(values, share));
      }
    }
    rows->append(row);
  }
}

void SampleTables::finish() {
  open_main();
  write_statistics();
  if (campbell_ && !modes_.empty()) campbell_->write(name_, modes_, sink_);
  write_failures();
}

std::string SampleTables::first_reason() const {
  if (failures_.empty()) return {};
  return fmt::format("at {}: {}", place_text(plan_.sweep, failures_.front().number), failures_.front().reason);
}

std::vector<std::string> SampleTables::warnings() const {
  std::vector<std::string> lines = plan_.warnings;
  const auto samples = [&](double count) { return fmt::format("{:.0f} of {} samples", count, plan_.sweep.lines()); };
  for (const std::string& text : texts_) {
    const Told& told = told_.at(text);
    lines.push_back(fmt::format("at {}: {} ({})", place_text(plan_.sweep, told.first), text, samples(told.count)));
  }
  if (untold_ > 0.0)
    lines.push_back(fmt::format("samples gave {:.0f} further warnings; the column \"warnings\" counts them", untold_));
  if (!failures_.empty() && count_of(SampleStatus::done) > 0.0)
    lines.push_back(fmt::format("{} have no result; the first, {}; the table \"failures\" has all",
                                samples(static_cast<double>(failures_.size())), first_reason()));
  if (left_out_of_ > 0)
    lines.push_back(
        fmt::format("{} have columns that the first lacks, such as \"{}\", which are left out; make the "
                    "parameters of the first sample those that have most",
                    samples(static_cast<double>(left_out_of_)), left_out_));
  return lines;
}

std::vector<std::string> SampleTables::findings() const {
  if (!campbell_ || modes_.empty()) return {};
  return campbell_->findings(modes_);
}

}  // namespace rubato::analysis
