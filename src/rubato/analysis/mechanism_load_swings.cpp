#include <rubato/analysis/mechanism_load_swings.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::analysis {
namespace {

constexpr int swing_samples = 4096;

/// The shortest time between two turns of a law, of more than a thousandth of its range, as samples see it.
double shortest_swing(const model::TimeLaw& law, double duration, int samples = swing_samples) {
  constexpr double small = 1e-3;
  std::vector<double> values(static_cast<std::size_t>(samples) + 1);
  for (int i = 0; i <= samples; ++i)
    values[static_cast<std::size_t>(i)] = model::value(law, duration * i / samples, model::Side::right);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double least = small * (*high - *low);
  double shortest = HUGE_VAL, turned_at = -1.0, extreme = values[0], direction = 0.0, extreme_at = 0.0;
  for (int i = 1; i <= samples; ++i) {
    const double value = values[static_cast<std::size_t>(i)], t = duration * i / samples;
    if (direction == 0.0 && std::abs(value - extreme) > least) direction = value > extreme ? 1.0 : -1.0;
    if (direction * (value - extreme) > 0.0) {
      extreme = value;
      extreme_at = t;
    } else if (direction != 0.0 && direction * (extreme - value) > least) {
      if (turned_at >= 0.0) shortest = std::min(shortest, extreme_at - turned_at);
      turned_at = extreme_at;
      direction = -direction;
      extreme = value;
      extreme_at = t;
    }
  }
  return shortest;
}

/// While dry joints or rigid stops hold a mechanism nothing but its loads tells what may let them go.
bool may_rest(const model::Mechanism& model) {
  return !model.frictions.empty() ||
         std::any_of(model.locks.begin(), model.locks.end(), [](const model::Lock& lock) { return lock.is_rigid(); });
}

}  // namespace

// Samples tell of a swing where two of them lie on it. One that is faster may look slow, though hardly in several
// samplings whose numbers have no common divisor.
void warn_of_fast_swings(const model::Mechanism& mechanism, double duration, std::vector<std::string>& warnings) {
  constexpr int least = 2;
  if (!may_rest(mechanism)) return;
  const auto look = [&](const model::TimeLaw& law) {
    const auto* formula = std::get_if<model::FormulaLaw>(&law);
    if (!formula) return;
    for (const int samples : {swing_samples, 5003, 6007, 7001})
      if (shortest_swing(law, duration, samples) * samples < least * duration) {
        warnings.push_back(fmt::format(
            "the load \"{}\" swings faster than {} samples of the run tell: steps may pass what it does to locks and "
            "friction that hold; give step = {{ largest = ... }}, a sixth of its period or less",
            formula->formula.text(), swing_samples));
        return;
      }
  };
  for (const auto& force : mechanism.forces) look(force.law);
  for (const auto& law : mechanism.following_laws) look(law);
}

double period_limit(const model::Mechanism& mechanism, double duration) {
  const bool follows_formulas = may_rest(mechanism);
  double fastest = 0.0;
  const auto take = [&](const model::TimeLaw& law) {
    if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&law))
      fastest = std::max(fastest, std::abs(harmonic->angular_frequency));
    else if (follows_formulas && std::holds_alternative<model::FormulaLaw>(law))
      fastest = std::max(fastest, std::numbers::pi / shortest_swing(law, duration));
  };
  for (const auto& force : mechanism.forces) take(force.law);
  for (const auto& law : mechanism.following_laws) take(law);
  return fastest > 0.0 ? 2.0 * std::numbers::pi / fastest / 6.0 : HUGE_VAL;
}

}  // namespace rubato::analysis
