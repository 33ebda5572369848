#include <rubato/steady/harmonic_balance/harmonic_balance_parts.hpp>

#include <algorithm>
#include <cmath>

// Points that share one discretisation, for differences between them.
namespace rubato::steady {

// Balances the orders that are held, and says what they err. From nothing they are reached step by step.
bool HarmonicBalanceSolver::Implementation::attempt_held(const system::Excitation& excitation, Effort effort,
                                                         SteadyResponse& response) {
  auto& eq = equations.front();
  const Index m = stiffness.size();
  const bool is_symmetric = excitation.is_half_wave_symmetric() && offsets.isZero(0.0) && laws_are_odd;
  const int stride = is_symmetric ? 2 : 1;
  int order = held_to->order;
  for (const system::LoadHarmonic& h : excitation.harmonics) order = std::max(order, h.order);
  const int whole = (order - 1 + stride - 1) / stride + 1;
  const bool is_compared = held_with_error && (!std::isinf(held_to->firmness) || !eq.groups().empty());

  int count = whole;
  if (!predict(excitation.angular_frequency, {stride, whole}, !is_symmetric))
    count = std::min(whole, eq.groups().empty() ? 1 : fewest_for_groups);
  else if (is_compared)
    count = fewer(whole);
  has_answer = false;
  bool has_solution = false;
  Motion solution;
  ComplexMatrix observed_before;
  for (;; count = std::min(whole, more(count))) {
    const Orders orders{stride, count};
    const bool is_whole = count == whole;
    const int probes = is_whole && held_with_error ? orders_to_probe(excitation, orders) : 0;
    samples_used = held_to->samples > 0 ? held_to->samples : samples_for(orders, 0);
    eq.set_samples(samples_used);
    can_condense = condense(excitation, stride, count + probes, !is_symmetric);
    if (!can_condense) {
      has_answer = false;
      return false;
    }
    bool has_start = has_solution;
    if (has_solution) {
      guess = solution;
      guess.resize(orders, !is_symmetric, m);
    } else {
      has_start = predict(excitation.angular_frequency, orders, !is_symmetric);
    }
    series.resize(orders, !is_symmetric, m);
    firmness = held_to->firmness;
    if (!newton(excitation, has_start, has_solution, effort, response) || firmness_used != held_to->firmness ||
        !are_slider_forces_resolved(system, excitation, series.mean)) {
      has_answer = false;  // that of fewer orders is none of those that are held
      return false;
    }
    recover();
    if (has_laws() && held_with_error && is_whole) (void)sampling_error(probes);
    if (stride == 2 && has_laws() && !laws_act_oddly()) {
      laws_are_odd = false;
      return attempt_held(excitation, effort, response);
    }
    has_solution = has_answer = true;
    if (!is_whole) {
      observed_before = observed;
      eq.displacement_and_force(series, solution.displacement, solution.force);
      continue;
    }
    response.error = held_with_error ? truncation_error(probes) : 0.0;
    if (is_compared && observed_before.size() > 0)
      response.error = std::max(response.error, caution * change_since(observed_before));
    return laws_close();
  }
}

SteadyDiscretisation HarmonicBalanceSolver::discretisation() const {
  const Implementation& s = *implementation_;
  if (s.shot || !s.has_answer) return {};
  return {s.series.orders.highest(), s.has_laws() ? s.samples_used : 0, s.firmness_used};
}

void HarmonicBalanceSolver::hold(const std::optional<SteadyDiscretisation>& held, bool with_error) {
  Implementation& s = *implementation_;
  s.held_to = held;
  s.held_with_error = with_error;
}

}  // namespace rubato::steady
