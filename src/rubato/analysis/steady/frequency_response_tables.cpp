#include <rubato/analysis/steady/frequency_response_columns.hpp>
#include <rubato/analysis/steady/frequency_response_tables.hpp>
#include <rubato/results/columns/block_columns.hpp>
#include <rubato/results/columns/contact_columns.hpp>
#include <rubato/results/columns/law_columns.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>

namespace rubato::analysis {
namespace {

using Attributes = std::vector<std::pair<std::string, std::string>>;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

std::string start_name(steady::SteadyStart start) {
  if (start == steady::SteadyStart::previous) return "previous";
  return start == steady::SteadyStart::rest ? "rest" : "unloaded";
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
      {"solver", steady::route_name(plan.route.kind)},
      {"start", start_name(plan.start)},
      {"excitation", (plan.excitation_factor == 1.0 ? "" : "2 pi ") + input.parameters[plan.excitation].first},
      {"sweep", sweep_name(plan.sweep.kind())},
      {"swept_parameters", fmt::format("{}", fmt::join(plan.sweep.names(), ", "))},
      {"frequencies", std::to_string(plan.frequencies.size())},
      {"lines", std::to_string(plan.sweep.lines())}};
  if (plan.route.kind == steady::SteadyRoute::Kind::time_marching)
    attributes.emplace_back("method", plan.route.method.name);
  if (plan.is_in_hertz) attributes.emplace_back("frequency_unit", "Hz");
  if (plan.route.tolerance > 0.0) attributes.emplace_back("tolerance", fmt::format("{}", plan.route.tolerance));
  return attributes;
}

void add_amplitudes(const std::vector<Observed>& observed, std::vector<results::Block>& blocks) {
  add_blocks(observed, {"amplitude", "m", "half peak to peak of the displacement"},
             {"angle_amplitude", "rad", "half peak to peak of the rotation"}, blocks);
}

}  // namespace

std::vector<std::string> reserved_columns() {
  return {"point",
          "linear",
          "waveforms",
          "bands",
          "sample",
          "coordinate",
          "rotation",
          "observed",
          "slider",
          "rotational_slider",
          "law",
          "rotational_law",
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
          "first_real",
          "first_imaginary",
          "first_angle_real",
          "first_angle_imaginary",
          "free_amplitude",
          "free_angle_amplitude",
          "free_phase",
          "stuck_amplitude",
          "stuck_angle_amplitude",
          "stuck_phase"};
}

ResponseTable::ResponseTable(const std::string& name, const FrequencyResponsePlan& plan, const StudyInput& input)
    : layout_{name, "", "point", {}, attributes_of(plan, input)},
      sliders_(results::SliderColumns(plan.system(input)).order()),
      has_direction_(plan.has_both_directions),
      has_fundamental_(plan.has_other_fundamental),
      shows_first_parts_(plan.shows_first_parts) {
  auto& blocks = layout_.blocks;
  add_parameters(plan, {}, blocks);
  if (has_direction_) blocks.push_back(direction());
  blocks.push_back(angular_frequency());
  if (has_fundamental_) blocks.push_back(scalar("fundamental", "rad/s", "common fundamental of the loads"));
  amplitudes_ = blocks.size();
  const auto observe = [&](const results::ColumnNames& of_displacements, const results::ColumnNames& of_rotations) {
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
    if (order == 1 && plan.shows_first_parts)
      for (const char* part : {"real", "imaginary"})
        observe(
            {fmt::format("first_{}", part), "m", fmt::format("{} part of X, x contains Re(X exp(i omega t))", part)},
            {fmt::format("first_angle_{}", part), "rad",
             fmt::format("{} part of X, x contains Re(X exp(i omega t))", part)});
    add_phases(plan.observed, order == 1 ? "phase" : fmt::format("harmonic{}_phase", order),
               fmt::format("phase of harmonic {}, A cos({} omega t + phase)", order, order), blocks);
  }
  observe({"mean", "m", "mean over a period"}, {"angle_mean", "rad", "mean over a period"});
  observe({"rms", "m", "root of the mean square over a period"},
          {"angle_rms", "rad", "root of the mean square over a period"});
  const results::SliderColumns sliders(plan.system(input));
  sliders.add({"dissipated", "J", "friction work over a period"}, blocks);
  sliders.add({"slip_share", "1", "share of the period in which it slips"}, blocks);
  sliders.add({"offset", "N", "force at rest of a slider that never slips, fc - kT u"},
              {"moment_offset", "N m", "moment at rest of a slider that never slips, fc - kT u"}, blocks);
  const results::LawColumns laws(plan.system(input), false);
  laws.add({"dissipated", "J", "by a law over a period"}, blocks);
  laws_ = laws.order();
  const results::BlockColumns contacts(plan.system(input), false);
  contacts.add({"dissipated", "J", "by a contact over a period"}, blocks);
  for (Index b = 0; b < plan.system(input).block_count(); ++b) laws_.push_back(plan.system(input).law_count() + b);
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

void ResponseTable::add(const RowPlace& place, double fundamental, const steady::SteadyResponse& response,
                        std::vector<double>& rows) const {
  add_place(place, rows);
  if (has_fundamental_) rows.push_back(fundamental);
  append(response.amplitude, rows);
  append(response.velocity_amplitude, rows);
  append(response.acceleration_amplitude, rows);
  for (Index k = 0; k < response.harmonics.cols(); ++k) {
    if (k > 0)
      for (Index i = 0; i < response.harmonics.rows(); ++i) rows.push_back(std::abs(response.harmonics(i, k)));
    if (k == 0 && shows_first_parts_) {
      append(response.harmonics.col(0).real(), rows);
      append(response.harmonics.col(0).imag(), rows);
    }
    for (Index i = 0; i < response.harmonics.rows(); ++i) rows.push_back(phase_of(response.harmonics(i, k)));
  }
  append(response.mean, rows);
  append(response.rms, rows);
  for (const Vector* values : {&response.dissipated, &response.slip_share, &response.offset})
    for (const Index i : sliders_) rows.push_back((*values)[i]);
  for (const Index j : laws_) rows.push_back(response.law_dissipated[j]);
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

}  // namespace rubato::analysis
