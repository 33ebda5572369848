#include <rubato/steady/marching/time_marching_parts.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

// The error of the step, from marches with other numbers of steps.
namespace rubato::steady {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
// Transitions fall anywhere between the samples, and two numbers of steps may err alike by chance: the estimate is
// raised, more for methods that are so accurate without transitions that chance is most of their error, and falls
// slowly from point to point. Measured on two maps of 1,800 points of the damper model with exponential: so 3 points of
// 3,600 err by more than is said, by up to a half; with 4/3 and 0.75 for all, 213.
constexpr double caution = 4.0 / 3.0, caution_with_chance = 2.0, slowest_fall = 0.9;

// Largest difference of two answers, relative to the largest amplitude.
double difference(const SteadyResponse& a, const SteadyResponse& b) {
  const double size = a.amplitude.size() > 0 ? a.amplitude.maxCoeff() : 0.0;
  if (size == 0.0) return 0.0;
  const double of_amplitude = (a.amplitude - b.amplitude).cwiseAbs().maxCoeff();
  // About the mean, which may be anywhere where a slider sticks.
  const auto swing = [](const SteadyResponse& r) {
    return (r.rms.array().square() - r.mean.array().square()).max(0.0).sqrt().eval();
  };
  const double of_rms = std::numbers::sqrt2 * (swing(a) - swing(b)).abs().maxCoeff();
  const double of_drift = a.drift.size() > 0 && b.drift.size() > 0 ? (a.drift - b.drift).cwiseAbs().maxCoeff() : 0.0;
  return std::max({of_amplitude, of_rms, of_drift}) / size;
}

}  // namespace

bool TimeMarchingSolver::compare(Engine& engine, std::span<const system::Excitation> excitations, SteadyStart start,
                                 int steps, int other_steps, const LaneArray& states,
                                 std::span<const SteadyResponse> responses, std::span<double> errors) const {
  if (!engine.map->prepare(excitations, other_steps)) return false;
  // The other march starts where this one ended, and keeps its offsets.
  std::vector<SteadyResponse> others(responses.size());
  LaneArray other_states = states;
  find(engine, excitations, start == SteadyStart::rest ? start : SteadyStart::previous, other_steps, false,
       other_states, others);
  engine.map->prepare(excitations, steps);
  const double power = std::pow(static_cast<double>(steps), order_),
               ratio = power / std::pow(static_cast<double>(other_steps), order_);
  bool is_telling = true;
  for (std::size_t l = 0; l < responses.size(); ++l) {
    if (!is_repeating(responses[l].status)) continue;
    const double factor = transitions_rule_ || engine.places[l].step_error < 0.0 ? caution_with_chance : caution;
    if (others[l].status == responses[l].status)
      errors[l] = std::max(errors[l], factor * power * difference(responses[l], others[l]) / std::abs(ratio - 1.0));
    else
      is_telling = false;
  }
  return is_telling;
}

// Errors of the step: those of `responses` become complete.
void TimeMarchingSolver::estimate(Engine& engine, std::span<const system::Excitation> excitations, SteadyStart start,
                                  int steps, const LaneArray& states, std::span<SteadyResponse> responses,
                                  std::span<double> step_errors) const {
  const int least = least_steps(excitations[0].angular_frequency);
  const double power = std::pow(static_cast<double>(steps), order_);
  std::fill(step_errors.begin(), step_errors.end(), -1.0);
  std::vector<double> ringing(responses.size(), 0.0);
  bool is_new = false, has_transitions = false, repeats = false;
  for (std::size_t l = 0; l < responses.size(); ++l) {
    if (!is_repeating(responses[l].status)) continue;
    repeats = true;
    is_new = is_new || engine.places[l].step_error < 0.0;
    has_transitions = has_transitions || responses[l].transitions > 0;
    const double size = responses[l].amplitude.size() > 0 ? responses[l].amplitude.maxCoeff() : 0.0;
    if (size > 0.0 && responses[l].periods == 1) ringing[l] = unresolved_ringing(engine.records[l]).maxCoeff() / size;
  }
  if (!repeats) return;
  // Fewer steps cost less than more; but where they are too few to march, or to find the same, more must do.
  int wanted = is_new ? 3 : has_transitions && transitions_rule_ ? 2 : 1;
  const auto compare_with = [&](double ratio) {
    const int other_steps = static_cast<int>(std::ceil(ratio * steps));
    if (wanted > 0 && other_steps >= least &&
        compare(engine, excitations, start, steps, other_steps, states, responses, step_errors))
      --wanted;
  };
  const auto worst = [&] { return *std::max_element(step_errors.begin(), step_errors.end()) / power; };
  compare_with(0.5);
  compare_with(0.75);
  // The answer with twice the steps seldom shares the chance of those with fewer. Not asked where it would not matter.
  if (worst() < options_.tolerance) compare_with(2.0);
  if (wanted > 2) compare_with(1.5);
  for (std::size_t l = 0; l < responses.size(); ++l) {
    if (step_errors[l] < 0.0) {
      responses[l].error = not_a_number;
      continue;
    }
    if (responses[l].transitions > 0)
      step_errors[l] = std::max(step_errors[l], slowest_fall * engine.places[l].step_error);
    responses[l].error += step_errors[l] / power + ringing[l];
  }
}

}  // namespace rubato::steady
