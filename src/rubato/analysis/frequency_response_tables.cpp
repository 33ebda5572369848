#include <rubato/analysis/frequency_response_tables.hpp>
#include <rubato/analysis/observed_blocks.hpp>
#include <rubato/analysis/sweep_samples.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::analysis {
namespace {

using Block = results::Block;
using Attributes = std::vector<std::pair<std::string, std::string>>;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

Block scalar(const std::string& variable, const std::string& unit, const std::string& description) {
  return {variable, unit, description, "", {}};
}

/// Phases are in radians whatever moves.
void add_phases(const std::vector<Observed>& observed, const std::string& variable, const std::string& description,
                std::vector<Block>& blocks) {
  std::vector<std::string> labels;
  bool has_displacements = false, has_rotations = false;
  for (const Observed& one : observed) {
    labels.push_back(one.label);
    (one.is_rotation ? has_rotations : has_displacements) = true;
  }
  if (labels.empty()) return;
  const char* dimension = !has_rotations ? "coordinate" : !has_displacements ? "rotation" : "observed";
  blocks.push_back({variable, "rad", description, dimension, labels});
}

void add_parameters(const FrequencyResponsePlan& plan, const std::vector<bool>& wanted, std::vector<Block>& blocks) {
  for (std::size_t i = 0; i < plan.sweep.names().size(); ++i)
    if (wanted.empty() || wanted[i]) blocks.push_back(scalar(plan.sweep.names()[i], "", "swept parameter"));
}

Block direction() { return {"direction", "", "which way the frequency goes", "", {}, {"up", "down"}}; }

Block angular_frequency() { return scalar("angular_frequency", "rad/s", "angular frequency of the excitation"); }

std::string start_name(integrate::SteadyStart start) {
  if (start == integrate::SteadyStart::previous) return "previous";
  return start == integrate::SteadyStart::rest ? "rest" : "unloaded";
}

std::string sweep_name(Sweep::Kind kind) {
  switch (kind) {
    case Sweep::Kind::none:
      return "none";
    case Sweep::Kind::grid:
      return "grid";
    case Sweep::Kind::cases:
      return "cases";
    case Sweep::Kind::random:
      return "random";
  }
  return {};
}

Attributes attributes_of(const FrequencyResponsePlan& plan, const StudyInput& input) {
  Attributes attributes{
      {"type", "frequency_response"},
      {"solver", route_name(plan.route.kind)},
      {"start", start_name(plan.start)},
      {"excitation", (plan.excitation_factor == 1.0 ? "" : "2 pi ") + input.parameters[plan.excitation].first},
      {"sweep", sweep_name(plan.sweep.kind())},
      {"swept_parameters", fmt::format("{}", fmt::join(plan.sweep.names(), ", "))},
      {"frequencies", std::to_string(plan.frequencies.size())},
      {"lines", std::to_string(plan.sweep.lines())}};
  if (plan.route.kind == SteadyRoute::Kind::time_marching) attributes.emplace_back("method", plan.route.method.name);
  if (plan.route.tolerance > 0.0) attributes.emplace_back("tolerance", fmt::format("{}", plan.route.tolerance));
  return attributes;
}

void add_amplitudes(const std::vector<Observed>& observed, std::vector<Block>& blocks) {
  add_blocks(observed, {"amplitude", "m", "half peak to peak of the displacement"},
             {"angle_amplitude", "rad", "half peak to peak of the rotation"}, blocks);
}

/// In (-pi, pi]: the argument of -1 - 0i would be -pi.
double phase_of(const std::complex<double>& harmonic) {
  const double phase = std::arg(harmonic);
  return phase == -std::numbers::pi ? std::numbers::pi : phase;
}

void append(const Vector& values, std::vector<double>& rows) {
  rows.insert(rows.end(), values.data(), values.data() + values.size());
}

}  // namespace

std::vector<std::string> reserved_columns() {
  return {"point",
          "coordinate",
          "rotation",
          "observed",
          "slider",
          "rotational_slider",
          "direction",
          "angular_frequency",
          "fundamental",
          "amplitude",
          "angle_amplitude",
          "velocity_amplitude",
          "angular_velocity_amplitude",
          "acceleration_amplitude",
          "angular_acceleration_amplitude",
          "phase",
          "mean",
          "angle_mean",
          "rms",
          "angle_rms",
          "dissipated",
          "slip_share",
          "offset",
          "moment_offset",
          "viscous_work",
          "input_work",
          "transitions",
          "iterations",
          "residual",
          "error",
          "status",
          "time",
          "position",
          "angle",
          "force",
          "displacement",
          "moment",
          "relative_angle",
          "samples",
          "missing",
          "free_amplitude",
          "free_angle_amplitude",
          "free_phase",
          "stuck_amplitude",
          "stuck_angle_amplitude",
          "stuck_phase"};
}

ResponseTable::ResponseTable(const std::string& name, const FrequencyResponsePlan& plan, const StudyInput& input)
    : layout_{name, "", "point", {}, attributes_of(plan, input)},
      sliders_(SliderBlocks(input.system).order()),
      has_direction_(plan.has_both_directions),
      has_fundamental_(plan.has_other_fundamental) {
  auto& blocks = layout_.blocks;
  add_parameters(plan, {}, blocks);
  if (has_direction_) blocks.push_back(direction());
  blocks.push_back(angular_frequency());
  if (has_fundamental_) blocks.push_back(scalar("fundamental", "rad/s", "common fundamental of the loads"));
  amplitudes_ = blocks.size();
  const auto observe = [&](const ColumnNames& of_displacements, const ColumnNames& of_rotations) {
    add_blocks(plan.observed, of_displacements, of_rotations, blocks);
  };
  add_amplitudes(plan.observed, blocks);
  observe({"velocity_amplitude", "m/s", "half peak to peak of the velocity"},
          {"angular_velocity_amplitude", "rad/s", "half peak to peak of the angular velocity"});
  observe({"acceleration_amplitude", "m/s2", "half peak to peak of the acceleration"},
          {"angular_acceleration_amplitude", "rad/s2", "half peak to peak of the angular acceleration"});
  for (const int order : plan.request.harmonics) {
    const std::string description = fmt::format("amplitude of harmonic {}", order);
    if (order > 1)
      observe({fmt::format("harmonic{}_amplitude", order), "m", description},
              {fmt::format("harmonic{}_angle_amplitude", order), "rad", description});
    add_phases(plan.observed, order == 1 ? "phase" : fmt::format("harmonic{}_phase", order),
               fmt::format("phase of harmonic {}, A cos({} omega t + phase)", order, order), blocks);
  }
  observe({"mean", "m", "mean over a period"}, {"angle_mean", "rad", "mean over a period"});
  observe({"rms", "m", "root of the mean square over a period"},
          {"angle_rms", "rad", "root of the mean square over a period"});
  const SliderBlocks sliders(input.system);
  sliders.add({"dissipated", "J", "friction work over a period"}, blocks);
  sliders.add({"slip_share", "1", "share of the period in which it slips"}, blocks);
  sliders.add({"offset", "N", "force at rest of a slider that never slips, fc - kT u"},
              {"moment_offset", "N m", "moment at rest of a slider that never slips, fc - kT u"}, blocks);
  blocks.push_back(scalar("viscous_work", "J", "dissipated by the dampers over a period"));
  blocks.push_back(scalar("input_work", "J", "work of the loads over a period"));
  blocks.push_back(scalar("transitions", "1", "from stick to slip and back, in a period"));
  blocks.push_back(scalar("iterations", "1", "of the solver, or periods marched"));
  blocks.push_back(scalar("residual", "1", "of the equations solved, relative to the response"));
  blocks.push_back(scalar("error", "1", "estimated error of the amplitudes, relative to the largest"));
  blocks.push_back({"status", "", "what became of the point", "", {}, status_words()});
  width_ = layout_.row_width();
}

void ResponseTable::add_place(const RowPlace& place, std::vector<double>& rows) const {
  rows.insert(rows.end(), place.line.begin(), place.line.end());
  if (has_direction_) rows.push_back(place.is_downwards ? 1.0 : 0.0);
  rows.push_back(place.angular_frequency);
}

void ResponseTable::add(const RowPlace& place, double fundamental, const integrate::SteadyResponse& response,
                        std::vector<double>& rows) const {
  add_place(place, rows);
  if (has_fundamental_) rows.push_back(fundamental);
  append(response.amplitude, rows);
  append(response.velocity_amplitude, rows);
  append(response.acceleration_amplitude, rows);
  for (Index k = 0; k < response.harmonics.cols(); ++k) {
    if (k > 0)
      for (Index i = 0; i < response.harmonics.rows(); ++i) rows.push_back(std::abs(response.harmonics(i, k)));
    for (Index i = 0; i < response.harmonics.rows(); ++i) rows.push_back(phase_of(response.harmonics(i, k)));
  }
  append(response.mean, rows);
  append(response.rms, rows);
  for (const Vector* values : {&response.dissipated, &response.slip_share, &response.offset})
    for (const Index i : sliders_) rows.push_back((*values)[i]);
  rows.push_back(response.viscous_work);
  rows.push_back(response.input_work);
  rows.push_back(static_cast<double>(response.transitions));
  rows.push_back(response.iterations);
  rows.push_back(response.residual);
  rows.push_back(response.error);
  rows.push_back(static_cast<double>(point_status(response.status)));
}

void ResponseTable::add_impossible(const RowPlace& place, std::vector<double>& rows) const {
  const std::size_t end = rows.size() + width_;
  add_place(place, rows);
  rows.resize(end - 1, nothing);
  rows.push_back(static_cast<double>(PointStatus::impossible));
}

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

void LinearTable::add(const RowPlace& place, const integrate::SteadyResponse& free,
                      const integrate::SteadyResponse& stuck, std::vector<double>& rows) const {
  for (std::size_t i = 0; i < place.line.size(); ++i)
    if (is_linear_[i]) rows.push_back(place.line[i]);
  rows.push_back(place.angular_frequency);
  for (const integrate::SteadyResponse* limit : {&free, &stuck}) {
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
      sliders_(SliderBlocks(input.system).order()),
      has_direction_(plan.has_both_directions) {
  auto& blocks = layout_.blocks;
  add_parameters(plan, {}, blocks);
  if (has_direction_) blocks.push_back(direction());
  blocks.push_back(angular_frequency());
  blocks.push_back(scalar("time", "s", "time since the begin of a period"));
  add_blocks(plan.observed, {"position", "m", "displacement"}, {"angle", "rad", "rotation"}, blocks);
  const SliderBlocks sliders(input.system);
  sliders.add({"force", "N", "slider force; -force acts on the first coordinate"},
              {"moment", "N m", "slider moment; -moment acts on the first coordinate"}, blocks);
  sliders.add({"displacement", "m", "relative displacement of its ends"},
              {"relative_angle", "rad", "relative rotation of its ends"}, blocks);
  width_ = layout_.row_width();
}

void WaveformTable::add(const RowPlace& place, const integrate::Waveform& waveform, std::vector<double>& rows) const {
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
