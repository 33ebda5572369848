#include <rubato/core/error.hpp>
#include <rubato/steady/free_motions.hpp>
#include <rubato/steady/marching/lane_map.hpp>
#include <rubato/steady/marching/stepper_map.hpp>
#include <rubato/steady/marching/time_marching_parts.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::steady {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
// Steps in a period of a mode from which on the error of an implicit method falls as the square of the step.
constexpr double steps_in_ringing = 8.0;
constexpr int most_retries = 2;  // with twice the steps, of a march that does not repeat
// Steps are chosen for this part of the tolerance, so that the next point seldom needs a second round.
constexpr double aim = 0.7;

// The place of a structure that drifts says nothing.
void leave_out_means(SteadyResponse& response) {
  for (Index o = 0; o < response.drift.size(); ++o)
    if (response.drift[o] != 0.0) response.mean[o] = response.rms[o] = not_a_number;
}

bool has_static_load(const system::Excitation& excitation) {
  return excitation.constant.size() > 0 && !excitation.constant.isZero(0.0);
}

// A structure that floats, or a part of it, goes on with whatever speed the march gives it.
void refuse_loads_on(const Matrix& free_motions, const system::Excitation& excitation) {
  for (const system::LoadHarmonic& load : excitation.harmonics)
    for (Index k = 0; k < free_motions.cols(); ++k) {
      if (!drives(free_motions.col(k), load.amplitude)) continue;
      throw InvalidInput(
          "nothing holds the structure against its loads (it floats), and a march keeps whatever speed it has; take "
          "solver = \"periodic\", or a spring to the ground that is soft beside the others");
    }
}

// Sliders, dashpots and laws take over a period what the loads give. Far away and at great speed, where what a period
// adds is nothing, they do not.
bool is_balanced(const SteadyResponse& response) {
  constexpr double missing = 0.1;
  const double taken = response.viscous_work + response.dissipated.sum() + response.law_dissipated.sum();
  return std::abs(response.input_work - taken) <= missing * std::max(std::abs(response.input_work), std::abs(taken));
}

}  // namespace

// Once a structure is far away what a period adds is nothing beside the way that it has gone, and it seems to repeat.
bool TimeMarchingSolver::is_unbounded(const system::Excitation& excitation, SteadyStatus found) {
  const bool is_loaded = has_static_load(excitation);
  for (Index k = 0; is_loaded && k < unseen_.cols(); ++k)
    if (drives(unseen_.col(k), excitation.constant.cast<Complex>())) return true;
  if (system_.stop_count() > 0 || system_.has_laws()) return false;  // they may bound the motion
  // A march that does not repeat may wander for reasons of its own: only a resonance without damping is infinite. One
  // that drifts may have been led to a speed beside which what a period adds is nothing.
  const bool repeats = is_repeating(found) && found != SteadyStatus::drifting;
  if (repeats && !is_loaded) return false;
  if (!resonance_) resonance_.emplace(system_);
  if (is_loaded && system_.slider_count() == 0 && resonance_->is_carried_off(excitation.constant)) return true;
  return repeats ? resonance_->is_driven_beyond_friction(0.0, excitation.constant.cast<Complex>(), excitation.limits)
                 : resonance_->is_driven_beyond_friction(excitation);
}

TimeMarchingSolver::TimeMarchingSolver(const system::LocallyNonlinear& system, TimeMarchingOptions options,
                                       SteadyRequest request)
    : system_(system), options_(std::move(options)), request_(std::move(request)) {
  check_options(options_, system);
  free_ = free_motions(system);
  unseen_ = unseen_motions(system);
  if (options_.periodicity == 0.0) options_.periodicity = 0.01 * options_.tolerance;
  longest_step_ = longest_step(options_.method, system);
  resolved_frequency_ =
      std::holds_alternative<integrate::Exponential>(options_.method.formula) ? 0.0 : highest_frequency(system);
  order_ = amplitude_order(options_.method);
  const auto* explicit_method = std::get_if<integrate::RungeKutta>(&options_.method.formula);
  transitions_rule_ = std::holds_alternative<integrate::Exponential>(options_.method.formula) ||
                      (explicit_method && explicit_method->tableau.order > order_);
  slider_stiffness_.resize(system.slider_count());
  for (Index i = 0; i < slider_stiffness_.size(); ++i)
    slider_stiffness_[i] = system.sliders()[static_cast<std::size_t>(i)].stiffness;
  amplitudes_ = request_;
  amplitudes_.harmonics.clear();
  amplitudes_.rates = false;
  if (auto map = options_.uses_lanes ? make_lane_map(options_.method, system_, request_) : nullptr)
    lanes_ = std::make_unique<Engine>(std::move(map));
  steppers_ = std::make_unique<Engine>(make_stepper_map(options_.method, system_, request_));
}

TimeMarchingSolver::~TimeMarchingSolver() = default;

void TimeMarchingSolver::forget() {
  if (lanes_) lanes_->forget();
  steppers_->forget();
  last_ = nullptr;
}

int TimeMarchingSolver::lanes() const { return lanes_ ? static_cast<int>(lanes_->map->lanes()) : 1; }

int TimeMarchingSolver::least_steps(double angular_frequency) const {
  const double steps = 2.0 * std::numbers::pi / (angular_frequency * longest_step_);
  return steps < 1e9 ? std::max(1, static_cast<int>(std::ceil(steps))) : std::numeric_limits<int>::max() / 4;
}

int TimeMarchingSolver::first_steps(const Engine& engine, std::span<const system::Excitation> excitations) const {
  const double angular_frequency = excitations[0].angular_frequency;
  const int least = least_steps(angular_frequency);
  if (options_.steps_per_period > 0) {
    if (options_.steps_per_period < least)
      throw InvalidInput(
          fmt::format("{} steps a period are too few for {} at {:.6g} rad/s: it is stable from {} steps on; give more, "
                      "or none, and "
                      "they are chosen",
                      options_.steps_per_period, options_.method.name, angular_frequency, least));
    return options_.steps_per_period;
  }
  int order = 1;
  for (const system::Excitation& excitation : excitations)
    for (const system::LoadHarmonic& harmonic : excitation.harmonics) order = std::max(order, harmonic.order);
  for (const int wanted : request_.harmonics) order = std::max(order, wanted);
  // Every transition rings the modes. Where the steps are too few for them answers with different steps agree on what
  // is wrong. The ringing falls as the square of its order at least (the kinks of the slider forces), so that modes
  // beyond some order are none of the tolerance's business.
  const double farthest = order / std::sqrt(options_.tolerance);
  const int for_ringing =
      static_cast<int>(std::ceil(steps_in_ringing * std::min(resolved_frequency_ / angular_frequency, farthest)));
  return std::max({engine.next_steps > 0 ? engine.next_steps : 64, 16 * order, 2 * least, for_ringing});
}

bool TimeMarchingSolver::solve_with(Engine& engine, std::span<const system::Excitation> excitations, SteadyStart start,
                                    std::span<SteadyResponse> responses) {
  const std::size_t count = excitations.size();
  int steps = first_steps(engine, excitations);
  if (!engine.map->prepare(excitations, steps)) return false;
  if (engine.rigid.rows() == 0) engine.rigid = rigid_motions(*engine.map, system_);
  engine.places.resize(count);
  LaneArray states;
  start_states(engine, excitations, start, states);
  double suggestion = steps;
  int retries = 0;
  std::vector<double> step_errors(count);
  for (;;) {
    find(engine, excitations, start, steps, true, states, responses);
    estimate(engine, excitations, start, steps, states, responses, step_errors);
    double worst = 0.0;
    bool is_enough = true;
    const auto misses = [&](const SteadyResponse& r) {
      return is_repeating(r.status) && !(r.error <= options_.tolerance);
    };
    for (const SteadyResponse& response : responses) {
      if (is_repeating(response.status) && response.error > worst) worst = response.error;
      is_enough = is_enough && !misses(response);
    }
    const double share = std::max(worst, 1e-12) / (aim * options_.tolerance);
    suggestion = steps * std::clamp(std::pow(share, 1.0 / order_), 0.5, 4.0);
    if (options_.steps_per_period > 0) break;
    // With few steps a march may wander for ever, where the motion itself cannot.
    const bool wanders = std::any_of(responses.begin(), responses.end(),
                                     [](const SteadyResponse& r) { return !is_repeating(r.status); });
    if (is_enough && !(wanders && retries < most_retries)) break;
    if (wanders) ++retries;
    const int more = 8 * static_cast<int>(std::ceil(std::max(wanders ? 2.0 * steps : suggestion, 1.2 * steps) / 8.0));
    if (more > options_.max_steps || !engine.map->prepare(excitations, more)) {
      for (SteadyResponse& response : responses)
        if (misses(response)) response.status = SteadyStatus::not_converged;
      engine.map->prepare(excitations, steps);
      break;
    }
    steps = more;
  }
  for (std::size_t l = 0; l < count; ++l)
    if (is_unbounded(excitations[l], responses[l].status)) {
      make_unbounded(request_, system_.slider_count(), responses[l]);
      // What was met far away tells nothing of the next point.
      states.col(static_cast<Index>(l)).setConstant(not_a_number);
      engine.extrapolation->distrust(static_cast<Index>(l));
    }
  for (SteadyResponse& response : responses)
    if (response.status == SteadyStatus::drifting && !is_balanced(response))
      response.status = SteadyStatus::not_converged;
  steps_ = engine.steps = steps;
  engine.next_steps = 8 * static_cast<int>(std::ceil(std::min<double>(suggestion, options_.max_steps) / 8.0));
  for (std::size_t l = 0; l < count; ++l) {
    Place& place = engine.places[l];
    place.earlier_frequency =
        place.state.size() > 0 && place.state.allFinite() ? place.excitation.angular_frequency : 0.0;
    place.earlier = place.state;
    place.excitation = excitations[l];
    place.state = states.col(static_cast<Index>(l));
    place.offset = responses[l].offset;
    place.step_error = step_errors[l];
    leave_out_means(responses[l]);
  }
  last_ = &engine;
  return true;
}

void TimeMarchingSolver::solve_lanes(std::span<const system::Excitation> excitations, SteadyStart start,
                                     std::span<SteadyResponse> responses) {
  assert(!excitations.empty() && excitations.size() <= static_cast<std::size_t>(lanes()) &&
         excitations.size() == responses.size());
  for (const system::Excitation& excitation : excitations) refuse_loads_on(free_, excitation);
  if (lanes_ && solve_with(*lanes_, excitations, start, responses)) return;
  // One after the other; the places of a list have no memory of their own here.
  for (std::size_t l = 0; l < excitations.size(); ++l) {
    if (excitations.size() > 1) steppers_->forget();
    solve_with(*steppers_, excitations.subspan(l, 1), start, responses.subspan(l, 1));
  }
}

void TimeMarchingSolver::solve(const system::Excitation& excitation, SteadyStart start, SteadyResponse& response) {
  solve_lanes({&excitation, 1}, start, {&response, 1});
}

Waveform TimeMarchingSolver::waveform(int points) const {
  Waveform result;
  if (!last_ || points < 1) return result;
  const Place& place = last_->places.back();
  const Index n = system_.size(), m = system_.slider_count();
  const int steps = last_->steps;
  const double period = place.excitation.period(), step = period / steps;
  result.time.resize(points);
  for (int k = 0; k < points; ++k) result.time[k] = period * k / points;
  result.position = result.velocity = Matrix::Constant(n, points, not_a_number);
  result.slider_force = result.displacement = Matrix::Constant(m, points, not_a_number);
  if (!place.state.allFinite()) return result;  // unbounded
  SteadyRequest all;
  for (Index i = 0; i < n; ++i) all.observed.push_back({i, ground});
  const auto map = last_ == lanes_.get() ? make_lane_map(options_.method, system_, all)
                                         : make_stepper_map(options_.method, system_, all);
  map->prepare({&place.excitation, 1}, steps);
  std::vector<PeriodRecord> records(1);
  PeriodRecord& record = records[0];
  record.reset(n, system_, steps, true, false);
  LaneArray after;
  map->advance(place.state.array(), after, &records, 0);
  for (int k = 0; k < points; ++k) {
    const Index j = std::min<Index>(steps - 1, static_cast<Index>(result.time[k] / step));
    const double s = result.time[k] / step - static_cast<double>(j);
    // The cubic Hermite polynomial of a step, and the return map of the sliders from its start.
    const double b = s * s * (3.0 - 2.0 * s), a = 1.0 - b, da = step * s * (1.0 - s) * (1.0 - s),
                 db = -step * s * s * (1.0 - s);
    const auto between = [&](const Matrix& value, const Matrix& slope) {
      return Vector(a * value.col(j) + b * value.col(j + 1) + da * slope.col(j) + db * slope.col(j + 1));
    };
    result.position.col(k) = between(record.position, record.velocity);
    result.velocity.col(k) = between(record.velocity, record.acceleration);
    for (Index i = 0; i < m; ++i) {
      const double limit = place.excitation.limits[i];
      const double u = system_.relative_displacement(i, result.position.col(k));
      result.displacement(i, k) = u;
      result.slider_force(i, k) =
          std::clamp(record.slider_force(i, j) + slider_stiffness_[i] * (u - record.displacement(i, j)), -limit, limit);
    }
  }
  return result;
}

}  // namespace rubato::steady
