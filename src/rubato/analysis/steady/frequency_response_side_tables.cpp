#include <rubato/analysis/steady/frequency_response_columns.hpp>
#include <rubato/analysis/steady/frequency_response_tables.hpp>
#include <rubato/analysis/sweep_samples.hpp>
#include <rubato/results/columns/contact_columns.hpp>

#include <fmt/format.h>

#include <cmath>

// The tables beside the main one: linear limits, waveforms, percentile bands.
namespace rubato::analysis {

LinearTable::LinearTable(const std::string& name, const FrequencyResponsePlan& plan)
    : layout_{name, "linear", "point", {}, {{"type", "frequency_response_linear"}}}, is_linear_(plan.is_linear) {
  auto& blocks = layout_.blocks;
  add_parameters(plan, is_linear_, blocks);
  blocks.push_back(angular_frequency());
  for (const auto& [limit, description] :
       {std::pair<std::string, std::string>{"free", "without sliders"}, {"stuck", "with all sliders stuck"}}) {
    add_blocks(plan.observed, {limit + "_amplitude", "m", "half peak to peak of the displacement " + description},
               {limit + "_angle_amplitude", "rad", "half peak to peak of the rotation " + description}, blocks);
    add_phases(plan.observed, limit + "_phase", "phase of harmonic 1 " + description + ", A cos(omega t + phase)",
               blocks);
  }
  width_ = layout_.row_width();
}

void LinearTable::add(const RowPlace& place, const steady::SteadyResponse& free, const steady::SteadyResponse& stuck,
                      std::vector<double>& rows) const {
  for (std::size_t i = 0; i < place.line.size(); ++i)
    if (is_linear_[i]) rows.push_back(place.line[i]);
  rows.push_back(place.angular_frequency);
  for (const steady::SteadyResponse* limit : {&free, &stuck}) {
    append(limit->amplitude, rows);
    for (Index i = 0; i < limit->harmonics.rows(); ++i) rows.push_back(phase_of(limit->harmonics(i, 0)));
  }
}

WaveformTable::WaveformTable(const std::string& name, const FrequencyResponsePlan& plan, const StudyInput& input)
    : layout_{name,
              "waveforms",
              "sample",
              {},
              {{"type", "frequency_response_waveforms"}, {"points", std::to_string(plan.waveform_points)}}},
      observed_(plan.observed),
      sliders_(results::SliderColumns(plan.system(input)).order()),
      has_direction_(plan.has_both_directions) {
  auto& blocks = layout_.blocks;
  add_parameters(plan, {}, blocks);
  if (has_direction_) blocks.push_back(direction());
  blocks.push_back(angular_frequency());
  blocks.push_back(scalar("time", "s", "time since the begin of a period"));
  add_blocks(plan.observed, {"position", "m", "displacement"}, {"angle", "rad", "rotation"}, blocks);
  const results::SliderColumns sliders(plan.system(input));
  sliders.add({"force", "N", "slider force; -force acts on the first coordinate"},
              {"moment", "N m", "slider moment; -moment acts on the first coordinate"}, blocks);
  sliders.add({"displacement", "m", "relative displacement of its ends"},
              {"relative_angle", "rad", "relative rotation of its ends"}, blocks);
  width_ = layout_.row_width();
}

void WaveformTable::add(const RowPlace& place, const steady::Waveform& waveform, std::vector<double>& rows) const {
  for (Index p = 0; p < waveform.time.size(); ++p) {
    rows.insert(rows.end(), place.line.begin(), place.line.end());
    if (has_direction_) rows.push_back(place.is_downwards ? 1.0 : 0.0);
    rows.push_back(place.angular_frequency);
    rows.push_back(waveform.time[p]);
    for (const Observed& one : observed_)
      rows.push_back(waveform.position(one.first, p) - (one.second == ground ? 0.0 : waveform.position(one.second, p)));
    for (const Index i : sliders_) rows.push_back(waveform.slider_force(i, p));
    for (const Index i : sliders_) rows.push_back(waveform.displacement(i, p));
  }
}

BandTable::BandTable(const std::string& name, const FrequencyResponsePlan& plan)
    : layout_{name,
              "bands",
              "frequency",
              {},
              {{"type", "frequency_response_bands"}, {"samples", std::to_string(plan.sweep.lines())}}},
      plan_(plan),
      values_(plan.steps.size() * plan.observed.size()),
      missing_(plan.steps.size()) {
  auto& blocks = layout_.blocks;
  if (plan.has_both_directions) blocks.push_back(direction());
  blocks.push_back(angular_frequency());
  for (const int percent : band_percents) {
    const std::string description = fmt::format("amplitude below which {} % of the samples lie", percent);
    add_blocks(plan.observed, {fmt::format("amplitude_p{:02}", percent), "m", description},
               {fmt::format("angle_amplitude_p{:02}", percent), "rad", description}, blocks);
  }
  blocks.push_back(scalar("missing", "1", "samples without an amplitude here"));
}

void BandTable::take(std::size_t step, std::span<const double> amplitudes) {
  bool is_missing = false;
  for (std::size_t i = 0; i < amplitudes.size(); ++i) {
    if (std::isnan(amplitudes[i]))
      is_missing = true;
    else
      values_[step * amplitudes.size() + i].push_back(amplitudes[i]);
  }
  if (is_missing) missing_[step] += 1.0;
}

void BandTable::write(results::RowWriter& writer) {
  const std::size_t width = plan_.observed.size();
  std::vector<double> row;
  for (std::size_t step = 0; step < plan_.steps.size(); ++step) {
    row.clear();
    if (plan_.has_both_directions) row.push_back(plan_.steps[step].is_downwards ? 1.0 : 0.0);
    row.push_back(plan_.frequencies[plan_.steps[step].frequency]);
    for (const int percent : band_percents)
      for (std::size_t i = 0; i < width; ++i) row.push_back(percentile(values_[step * width + i], percent / 100.0));
    row.push_back(missing_[step]);
    writer.append(row);
  }
}

}  // namespace rubato::analysis
