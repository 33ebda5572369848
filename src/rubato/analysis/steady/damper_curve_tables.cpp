#include <rubato/analysis/steady/damper_curve_tables.hpp>

#include <rubato/results/columns/block_columns.hpp>
#include <rubato/results/columns/law_columns.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::analysis {
namespace {

using Block = results::Block;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

Block scalar(const std::string& variable, const std::string& unit, const std::string& description) {
  return {variable, unit, description, "", {}};
}

Block words(const std::string& variable, const std::string& description, std::vector<std::string> values) {
  return {variable, "", description, "", {}, std::move(values)};
}

const std::vector<std::string>& places() {
  static const std::vector<std::string> names{"interior", "lower_end", "upper_end"};
  return names;
}

std::vector<std::string> kinds() {
  std::vector<std::string> names;
  for (const auto kind : {Optimum::Kind::smooth, Optimum::Kind::kink, Optimum::Kind::corner, Optimum::Kind::bound,
                          Optimum::Kind::flat, Optimum::Kind::uncertified})
    names.push_back(optimum_kind(kind));
  return names;
}

std::vector<Block> key_blocks(const DamperCurvePlan& plan) {
  std::vector<Block> blocks;
  for (const std::string& name : plan.sweep.names()) blocks.push_back(scalar(name, "", "swept parameter"));
  blocks.push_back(scalar(plan.parameter, "", "parameter of the curve"));
  return blocks;
}

void append(std::span<const double> values, std::vector<double>& rows) {
  rows.insert(rows.end(), values.begin(), values.end());
}

/// As many values as there should be, whatever the response has.
void append(const Vector& values, std::size_t count, std::vector<double>& rows) {
  for (std::size_t i = 0; i < count; ++i)
    rows.push_back(i < static_cast<std::size_t>(values.size()) ? values[static_cast<Index>(i)] : nothing);
}

}  // namespace

std::vector<std::string> damper_curve_columns() {
  std::vector<std::string> names = reserved_columns();
  names.insert(names.end(), {"objective",
                             "largest",
                             "place",
                             "peak_count",
                             "peaks",
                             "linear",
                             "optimum",
                             "bands",
                             "peak",
                             "value",
                             "limit",
                             "kind",
                             "derivative",
                             "slope",
                             "curvature",
                             "multiplier",
                             "other_angular_frequency",
                             "other_objective",
                             "other_largest",
                             "other_derivative",
                             "other_multiplier",
                             "percentile"});
  return names;
}

DamperCurveTables::DamperCurveTables(const std::string& name, const DamperCurvePlan& plan, const StudyInput& input)
    : is_amplitude_(plan.objective == DamperCurvePlan::Objective::amplitude),
      observed_(plan.observed.size()),
      sliders_(static_cast<std::size_t>(plan.system(input).slider_count())) {
  const std::string objective = is_amplitude_ ? "amplitude" : "dissipated";
  const bool turns = !plan.observed.empty() && plan.observed.front().is_rotation;
  const std::string amplitude_unit = turns ? "rad" : "m", unit = is_amplitude_ ? amplitude_unit : "J";
  std::vector<std::string> labels, sliders;
  for (const Observed& one : plan.observed) labels.push_back(one.label);
  for (const auto& slider : plan.system(input).sliders()) sliders.push_back(slider.name);
  const std::vector<Block> keys = key_blocks(plan);
  const Block frequency = scalar("angular_frequency", "rad/s", "where over frequency the objective is largest");
  const Block largest = words("largest", "which amplitude is largest", labels);

  std::vector<Block> blocks = keys;
  blocks.push_back(frequency);
  if (!labels.empty())
    blocks.push_back(
        {"amplitude", amplitude_unit, "half peak to peak there", turns ? "rotation" : "coordinate", labels});
  objective_ = blocks.size() - (labels.empty() ? 0 : 1) + labels.size();
  blocks.push_back(scalar("objective", unit, "largest over frequency: " + objective));
  if (is_amplitude_) blocks.push_back(largest);
  std::vector<Block> rest;
  if (sliders_ > 0) {
    rest.push_back({"dissipated", "J", "friction work over a period", "slider", sliders});
    rest.push_back({"slip_share", "1", "share of the period in which it slips", "slider", sliders});
  }
  const results::LawColumns laws(plan.system(input), false);
  laws.add({"dissipated", "J", "by a law over a period"}, rest);
  laws_ = laws.order();
  const results::BlockColumns contacts(plan.system(input), false);
  contacts.add({"dissipated", "J", "by a contact over a period"}, rest);
  for (Index b = 0; b < plan.system(input).block_count(); ++b) laws_.push_back(plan.system(input).law_count() + b);
  rest.push_back(scalar("residual", "1", "of the equations solved, relative to the response"));
  rest.push_back(scalar("error", "1", "estimated error of the amplitudes, relative to the largest"));

  std::vector<Block> main = blocks;
  main.insert(main.end(), rest.begin(), rest.end());
  main.push_back(words("place", "of the largest: within the frequencies, or at an end of them", places()));
  main.push_back(scalar("peak_count", "1", "how many peaks there are"));
  main.push_back(words("status", "what became of the largest", status_words()));
  main_ = {name,
           "",
           "value",
           main,
           {{"type", "damper_curve"},
            {"solver", steady::route_name(plan.route.kind)},
            {"parameter", plan.parameter},
            {"objective", objective},
            {"excitation", (plan.excitation_factor == 1.0 ? "" : "2 pi ") + input.parameters[plan.excitation].first},
            {"swept_parameters", fmt::format("{}", fmt::join(plan.sweep.names(), ", "))},
            {"lines", std::to_string(plan.sweep.lines())}}};
  if (plan.is_in_hertz) main_.attributes.emplace_back("frequency_unit", "Hz");

  std::vector<Block> linear = keys;
  for (const auto& [limit, description] :
       {std::pair<std::string, std::string>{"free", "without sliders"}, {"stuck", "with all sliders stuck"}}) {
    linear.push_back(scalar(limit + "_angular_frequency", "rad/s", "where the amplitude is largest " + description));
    linear.push_back(scalar(limit + "_objective", amplitude_unit, "largest amplitude over frequency " + description));
  }
  linear_ = {name, "linear", "value", linear, {}};

  std::vector<Block> peak = keys;
  peak.push_back(scalar("peak", "1", "a number that follows the peak along the parameter"));
  peak.push_back(frequency);
  peak.push_back(scalar("objective", unit, "value of the peak"));
  if (is_amplitude_) peak.push_back(words("largest", "whose amplitude it is", labels));
  peak.push_back(words("place", "within the frequencies, or at an end of them", places()));
  peak.push_back(scalar("error", "1", "estimated error of the amplitudes, relative to the largest"));
  peak.push_back(words("status", "what became of the peak", status_words()));
  peaks_ = {name, "peaks", "peak_of_value", peak, {}};

  std::vector<Block> optimum = blocks;
  optimum.insert(optimum.end(), rest.begin(), rest.end());
  optimum.push_back(words("place", "of the largest: within the frequencies, or at an end of them", places()));
  optimum.push_back(words("status", "what became of the largest", status_words()));
  optimum.push_back(words("kind", "of its certificate", kinds()));
  optimum.push_back(scalar("derivative", "", "of the objective by the parameter, of the peak"));
  optimum.push_back(scalar("slope", "", "of the objective by the angular frequency, at the peak"));
  optimum.push_back(scalar("curvature", "", "second derivative by the parameter, where the first vanishes"));
  optimum.push_back(scalar("multiplier", "1", "weight of the peak at a kink"));
  optimum.push_back(scalar("other_angular_frequency", "rad/s", "of the second peak at a kink"));
  optimum.push_back(scalar("other_objective", unit, "of the second peak"));
  if (is_amplitude_) optimum.push_back(words("other_largest", "whose amplitude the second peak is", labels));
  optimum.push_back(scalar("other_derivative", "", "of the second peak, by the parameter"));
  optimum.push_back(scalar("other_multiplier", "1", "weight of the second peak"));
  optimum_ = {name, "optimum", "line", optimum, {}};

  std::vector<Block> bands{scalar(plan.parameter, "", "parameter of the curve")};
  for (const int percent : band_percents)
    bands.push_back(scalar(fmt::format("objective_p{:02}", percent), unit,
                           fmt::format("objective below which {} % of the samples lie", percent)));
  bands.push_back(scalar("missing", "1", "samples without an objective"));
  bands_ = {name, "bands", "value", bands, {{"samples", std::to_string(plan.sweep.lines())}}};
}

void DamperCurveTables::add_response(const std::optional<Peak>& top, const steady::SteadyResponse& response,
                                     std::vector<double>& rows) const {
  rows.push_back(top ? top->at : nothing);
  append(response.amplitude, observed_, rows);
  rows.push_back(top ? top->value : nothing);
  if (is_amplitude_) rows.push_back(top ? static_cast<double>(top->curve) : nothing);
  if (sliders_ > 0) {
    append(response.dissipated, sliders_, rows);
    append(response.slip_share, sliders_, rows);
  }
  for (const Index law : laws_)
    rows.push_back(law < response.law_dissipated.size() ? response.law_dissipated[law] : nothing);
  rows.push_back(top ? response.residual : nothing);
  rows.push_back(top ? response.error : nothing);
}

void DamperCurveTables::add(std::span<const double> line, double parameter, const std::optional<Peak>& top,
                            std::size_t peaks, const steady::SteadyResponse& response, PointStatus status,
                            std::vector<double>& rows) const {
  append(line, rows);
  rows.push_back(parameter);
  add_response(top, response, rows);
  rows.push_back(top ? static_cast<double>(top->kind) : nothing);
  rows.push_back(static_cast<double>(peaks));
  rows.push_back(static_cast<double>(status));
}

void DamperCurveTables::add_limits(std::span<const double> line, double parameter, const std::optional<Peak>& free,
                                   const std::optional<Peak>& stuck, std::vector<double>& rows) const {
  append(line, rows);
  rows.push_back(parameter);
  for (const auto* peak : {&free, &stuck}) {
    rows.push_back(*peak ? (*peak)->at : nothing);
    rows.push_back(*peak ? (*peak)->value : nothing);
  }
}

void DamperCurveTables::add_peak(std::span<const double> line, double parameter, long number, const Peak& peak,
                                 double error, PointStatus status, std::vector<double>& rows) const {
  append(line, rows);
  rows.insert(rows.end(), {parameter, static_cast<double>(number), peak.at, peak.value});
  if (is_amplitude_) rows.push_back(static_cast<double>(peak.curve));
  rows.push_back(static_cast<double>(peak.kind));
  rows.insert(rows.end(), {error, static_cast<double>(status)});
}

void DamperCurveTables::add_optimum(std::span<const double> line, const Optimum& optimum,
                                    const steady::SteadyResponse& response, std::vector<double>& rows) const {
  append(line, rows);
  rows.push_back(optimum.parameter);
  add_response(optimum.active.front(), response, rows);
  const bool is_kink = optimum.active.size() == 2;
  rows.push_back(static_cast<double>(optimum.active.front().kind));
  rows.push_back(static_cast<double>(point_status(response.status)));
  rows.insert(rows.end(), {static_cast<double>(optimum.kind), optimum.derivative[0], optimum.active.front().slope,
                           optimum.kind == Optimum::Kind::smooth ? optimum.curvature : nothing, optimum.multiplier[0]});
  const Peak& other = optimum.active.back();
  rows.push_back(is_kink ? other.at : nothing);
  rows.push_back(is_kink ? other.value : nothing);
  if (is_amplitude_) rows.push_back(is_kink ? static_cast<double>(other.curve) : nothing);
  rows.push_back(is_kink ? optimum.derivative[1] : nothing);
  rows.push_back(is_kink ? optimum.multiplier[1] : nothing);
}

}  // namespace rubato::analysis
