#include <rubato/analysis/modes_table.hpp>
#include <rubato/results/columns/observed_columns.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::analysis {
namespace {

bool has_complex(const std::vector<integrate::FreeMotions>& limits) {
  for (const auto& motions : limits)
    for (const auto& mode : motions.found.modes)
      if (mode.is_complex) return true;
  return false;
}

results::TableLayout layout_of(const std::string& name, const std::vector<std::string>& names,
                               const std::vector<Observed>& observed, bool is_complex) {
  const auto scalar = [](const std::string& variable, const std::string& unit, const std::string& description) {
    return results::Block{variable, unit, description, "", {}};
  };
  results::Block limit = scalar(
      "limit", "1",
      names == mode_limits ? "free: sliders removed; stuck: sliders as springs" : "what contacts and sliders do");
  limit.categories = names;
  results::TableLayout layout{
      name,
      "",
      "row",
      {limit, scalar("mode", "1", "number within the limit, by rising frequency"),
       scalar("angular_frequency", "rad/s", "natural, |eigenvalue|"), scalar("frequency", "Hz", "natural"),
       scalar("damping_ratio", "1", "-Re(eigenvalue) / |eigenvalue|; beyond 1 it does not oscillate"),
       scalar("eigenvalue_real", "1/s", "the free motion is Re(shape exp(eigenvalue t))"),
       scalar("eigenvalue_imaginary", "rad/s", "angular frequency of the damped motion")},
      {{"type", "modes"}, {"normalisation", "conj(shape)^T M shape = 1; the largest entry is real and positive"}}};
  // With q = shape * (modal coordinate): the latter in m sqrt(kg), for displacements and rotations alike.
  add_blocks(observed, {"shape", "1/sqrt(kg)", "shape, with a modal mass of 1"},
             {"angle_shape", "rad/(m sqrt(kg))", "shape of the rotations, on the scale of the displacements"},
             layout.blocks);
  if (is_complex)
    add_blocks(observed, {"shape_imaginary", "1/sqrt(kg)", "imaginary part: a quarter of a period ahead"},
               {"angle_shape_imaginary", "rad/(m sqrt(kg))", "imaginary part of the shape of the rotations"},
               layout.blocks);
  return layout;
}

constexpr double negligible = 1e-3;  // of the lowest frequency that is not zero, or of a mode's own: not worth a word

double in_hertz(double angular_frequency) { return angular_frequency / (2.0 * std::numbers::pi); }

/// "mode 3", "modes 1 to 3" (they follow one another but for rare exceptions)
std::string numbers_of(const std::vector<std::size_t>& modes) {
  return modes.size() == 1 ? fmt::format("mode {}", modes.front() + 1)
                           : fmt::format("modes {} to {}", modes.front() + 1, modes.back() + 1);
}

}  // namespace

std::string cause_of_poor_modes(const numerics::DampedModes& found) {
  constexpr double poor = 1e-4;  // as numerics::lowest_damped_modes has it
  if (!std::isfinite(found.defect))
    return "some motion has no mass beside that of the others, or a stiffness over its mass that is beyond the largest "
           "number; give it a mass, or take stiffness and masses that are less far apart";
  if (found.defect > poor)
    return fmt::format(
        "the worst shape is wrong by {:.1e} of itself; ask for fewer, and where light or stiff parts are to be rigid "
        "take ratios of their stiffness and mass to those of the others that are less far from one, or joints",
        found.defect);
  return "the iteration for those that dampers couple, or that lie close together, did not come to an end; ask for a "
         "few more or fewer";
}

void tell_round_off(const std::string& title, const numerics::DampedModes& found, RunReport& report) {
  std::vector<std::size_t> rigid, poor;
  double hidden = 0.0, lowest = std::numeric_limits<double>::infinity(), worst = 0.0;
  for (std::size_t i = 0; i < found.modes.size(); ++i) {
    const numerics::DampedMode& mode = found.modes[i];
    const double omega = mode.angular_frequency;
    if (omega == 0.0) {
      rigid.push_back(i);
      hidden = std::max(hidden, std::sqrt(mode.round_off));
      continue;
    }
    lowest = std::min(lowest, omega);
    // omega^2 changes by twice as much as omega.
    const double share = 0.5 * mode.round_off / (omega * omega);
    if (share > negligible) poor.push_back(i);
    worst = std::max(worst, share);
  }
  if (!rigid.empty()) {
    const bool is_one = rigid.size() == 1;
    const std::string told = fmt::format("{}{} {} at 0 Hz: ", title, numbers_of(rigid), is_one ? "is" : "are");
    if (hidden <= negligible * lowest && std::isfinite(lowest))
      report.findings.push_back(told + (is_one ? "a rigid motion" : "rigid motions"));
    else if (!std::isfinite(lowest))
      report.findings.push_back(fmt::format("{}{}, or below the round-off of the stiffness, {:.2g} Hz", told,
                                            is_one ? "a rigid motion" : "rigid motions", in_hertz(hidden)));
    else
      report.warnings.push_back(fmt::format(
          "{}below the round-off of the stiffness; {} rigid, or anywhere up to {:.2g} Hz: very stiff parts move along, "
          "whose rounding hides what holds them; take them less stiff",
          told, is_one ? "it is" : "they are", in_hertz(hidden)));
  }
  if (!poor.empty())
    report.warnings.push_back(fmt::format(
        "{}{} {} known to {:.2g} % only, at worst: very stiff parts move along, and the rounding of their stiffness is "
        "felt beside what holds them; take them less stiff",
        title, numbers_of(poor), poor.size() == 1 ? "is" : "are", 100.0 * worst));
}

void write_modes(const std::string& name, const std::vector<std::string>& names, const std::vector<Observed>& observed,
                 const std::vector<integrate::FreeMotions>& limits, results::Sink& sink,
                 const std::vector<Index>& diameters) {
  const bool is_complex = has_complex(limits);
  results::TableLayout layout = layout_of(name, names, observed, is_complex);
  const std::size_t each = std::max<std::size_t>(diameters.size(), 1);
  if (!diameters.empty())
    layout.blocks.insert(
        layout.blocks.begin() + 1,
        results::Block{"nodal_diameter", "1", "k: sector j+1 moves as sector j, exp(i k 2 pi/N) times", "", {}});
  const auto rows = sink.open(layout);
  for (std::size_t limit = 0; limit < limits.size(); ++limit) {
    double number = 0.0;
    for (const auto& mode : limits[limit].found.modes) {
      std::vector<double> row{static_cast<double>(limit / each)};
      if (!diameters.empty()) row.push_back(static_cast<double>(diameters[limit % each]));
      row.insert(row.end(), {++number, mode.angular_frequency, mode.angular_frequency / (2.0 * std::numbers::pi),
                             mode.damping_ratio, mode.eigenvalue.real(), mode.eigenvalue.imag()});
      const Vector real = mode.shape.real(), imaginary = mode.shape.imag();
      for (const auto& one : observed) row.push_back(one.of(real));
      if (is_complex)
        for (const auto& one : observed) row.push_back(one.of(imaginary));
      rows->append(row);
    }
  }
}

}  // namespace rubato::analysis
