#include <rubato/core/error.hpp>
#include <rubato/system/add_load.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::system {
namespace {

constexpr int most_harmonics = 64;
constexpr double same_frequency = 1e-10;  // relative: frequencies come from formulas such as 3 * speed

}  // namespace

int order_over(double frequency, double fundamental) {
  const double ratio = frequency / fundamental, whole = std::round(ratio);
  return whole >= 1.0 && whole <= most_harmonics && std::abs(ratio - whole) <= same_frequency * whole
             ? static_cast<int>(whole)
             : 0;
}

std::optional<double> common_fundamental(const std::vector<double>& frequencies) {
  // The smallest divided by 1, 2, 3, ...
  const double lowest = *std::min_element(frequencies.begin(), frequencies.end());
  for (int divisor = 1; divisor <= most_harmonics; ++divisor) {
    const double candidate = lowest / divisor;
    if (std::all_of(frequencies.begin(), frequencies.end(),
                    [&](double frequency) { return order_over(frequency, candidate) > 0; }))
      return candidate;
  }
  return std::nullopt;
}

double fundamental_of(const std::vector<double>& frequencies) {
  if (const auto found = common_fundamental(frequencies)) return *found;
  throw InvalidInput(fmt::format(
      "the forces have no common period: their angular frequencies ({:.6g} to {:.6g} rad/s) are no multiples of one "
      "fundamental up to its harmonic {}; choose commensurate frequencies, or a frequency_response with solver = "
      "\"time_marching\"",
      *std::min_element(frequencies.begin(), frequencies.end()),
      *std::max_element(frequencies.begin(), frequencies.end()), most_harmonics));
}

double Excitation::period() const { return 2.0 * std::numbers::pi / angular_frequency; }

bool Excitation::is_half_wave_symmetric() const {
  return (constant.size() == 0 || constant.cwiseAbs().maxCoeff() == 0.0) &&
         std::all_of(harmonics.begin(), harmonics.end(), [](const LoadHarmonic& h) { return h.order % 2 == 1; });
}

void add_load(const system::LoadTerm& where, const model::HarmonicLaw& law, int order, Excitation& out) {
  if (order == 0) {
    const double now = law.amplitude * std::cos(law.phase);
    for (std::size_t i = 0; i < where.rows.size(); ++i) out.constant[where.rows[i]] += where.weights[i] * now;
    return;
  }
  const double phase = law.angular_frequency > 0.0 ? law.phase : -law.phase;
  const std::complex<double> amplitude(law.amplitude * std::cos(phase), law.amplitude * std::sin(phase));
  auto place = std::lower_bound(out.harmonics.begin(), out.harmonics.end(), order,
                                [](const LoadHarmonic& h, int k) { return h.order < k; });
  if (place == out.harmonics.end() || place->order != order)
    place = out.harmonics.insert(place, {order, ComplexVector::Zero(out.constant.size())});
  for (std::size_t i = 0; i < where.rows.size(); ++i) place->amplitude[where.rows[i]] += where.weights[i] * amplitude;
}

Excitation excitation_of(const system::LocallyNonlinear& system) {
  const Index n = system.size();
  Excitation result;
  result.constant = Vector::Zero(n);
  result.limits.resize(system.slider_count());
  for (Index i = 0; i < system.slider_count(); ++i)
    result.limits[i] = system.sliders()[static_cast<std::size_t>(i)].limit;

  std::vector<double> frequencies;
  for (const auto& term : system.loads().terms()) {
    const auto* harmonic = std::get_if<model::HarmonicLaw>(&term.law);
    if (!harmonic)
      throw InvalidInput(
          "a periodic response needs harmonic loads (amplitude, angular_frequency, phase); a load is given as a "
          "formula of t or a table: write it as a sum of harmonic forces, or run a transient");
    if (harmonic->angular_frequency != 0.0) frequencies.push_back(std::abs(harmonic->angular_frequency));
  }
  if (frequencies.empty())
    throw InvalidInput(
        "a periodic response needs a harmonic load: add a [[force]] with amplitude and "
        "angular_frequency");
  result.angular_frequency = fundamental_of(frequencies);

  for (const auto& term : system.loads().terms()) {
    const auto& law = std::get<model::HarmonicLaw>(term.law);
    const double w = std::abs(law.angular_frequency);
    add_load(term, law, w > 0.0 ? order_over(w, result.angular_frequency) : 0, result);
  }
  return result;
}

}  // namespace rubato::system
