#include <rubato/integrate/steady/time_marching.hpp>

#include <rubato/core/error.hpp>
#include <rubato/integrate/steady/lane_map.hpp>
#include <rubato/integrate/steady/linear_limits.hpp>
#include <rubato/integrate/steady/stepper_map.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::integrate {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr int quasi_periodic_window = 64;  // periods whose largest motion is the amplitude
// Transitions fall anywhere between the samples, and two numbers of steps may err alike by chance: the estimate is
// raised, more for methods that are so accurate without transitions that chance is most of their error, and falls
// slowly from point to point. Measured on two maps of 1,800 points of the damper model with exponential: so 3 points of
// 3,600 err by more than is said, by up to a half; with 4/3 and 0.75 for all, 213.
constexpr double caution = 4.0 / 3.0, caution_with_chance = 2.0, slowest_fall = 0.9;
// The extrapolation's guess of the way left is that of other sliders sticking: on 1,200 random structures of 2 to 40
// coordinates (random_model) at most 2.44 times as much was left, in 99 of 100 less than 1.61.
constexpr double caution_of_transient = 2.5;
// What is left of the transient may take this part of the tolerance; below that no march repeats to round-off.
constexpr double share_of_transient = 0.2, finest_periodicity = 1e-11;
// Steps in a period of a mode from which on the error of an implicit method falls as the square of the step.
constexpr double steps_in_ringing = 8.0;
constexpr int most_retries = 2;  // with twice the steps, of a march that does not repeat
// Steps are chosen for this part of the tolerance, so that the next point seldom needs a second round.
constexpr double aim = 0.7;

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

bool is_repeating(SteadyStatus status) {
  return status == SteadyStatus::converged || status == SteadyStatus::subharmonic || status == SteadyStatus::drifting;
}

// The place of a structure that drifts says nothing.
void leave_out_means(SteadyResponse& response) {
  for (Index o = 0; o < response.drift.size(); ++o)
    if (response.drift[o] != 0.0) response.mean[o] = response.rms[o] = not_a_number;
}

}  // namespace

/// What is remembered of the points solved last at one place of the list.
struct TimeMarchingSolver::Place {
  Excitation excitation;
  Vector state, earlier;           // at the last point, and at the one before
  double earlier_frequency = 0.0;  // 0: there is none
  Vector offset;                   // of the sliders that never slipped
  double step_error = -1.0;        // times N^p; < 0: not known
};

struct TimeMarchingSolver::Engine {
  std::unique_ptr<PeriodMap> map;
  std::unique_ptr<OrbitExtrapolation> extrapolation;
  std::vector<Place> places;
  std::vector<PeriodRecord> records;
  int steps = 0;       // a period, of the states
  int next_steps = 0;  // that would have been enough
  Matrix rigid;        // motions along which the states may be moved

  explicit Engine(std::unique_ptr<PeriodMap> given)
      : map(std::move(given)), extrapolation(make_extrapolation(map->size())) {}
  void forget() {
    places.clear();
    extrapolation->forget();
    next_steps = 0;
  }
};

TimeMarchingSolver::TimeMarchingSolver(const system::LocallyNonlinear& system, TimeMarchingOptions options,
                                       SteadyRequest request)
    : system_(system), options_(std::move(options)), request_(std::move(request)) {
  check_options(options_, system);
  if (options_.periodicity == 0.0) options_.periodicity = 0.01 * options_.tolerance;
  longest_step_ = longest_step(options_.method, system);
  resolved_frequency_ = std::holds_alternative<Exponential>(options_.method.formula) ? 0.0 : highest_frequency(system);
  order_ = amplitude_order(options_.method);
  const auto* explicit_method = std::get_if<RungeKutta>(&options_.method.formula);
  transitions_rule_ = std::holds_alternative<Exponential>(options_.method.formula) ||
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

int TimeMarchingSolver::first_steps(const Engine& engine, std::span<const Excitation> excitations) const {
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
  for (const Excitation& excitation : excitations)
    for (const LoadHarmonic& harmonic : excitation.harmonics) order = std::max(order, harmonic.order);
  for (const int wanted : request_.harmonics) order = std::max(order, wanted);
  // Every transition rings the modes. Where the steps are too few for them answers with different steps agree on what
  // is wrong. The ringing falls as the square of its order at least (the kinks of the slider forces), so that modes
  // beyond some order are none of the tolerance's business.
  const double farthest = order / std::sqrt(options_.tolerance);
  const int for_ringing =
      static_cast<int>(std::ceil(steps_in_ringing * std::min(resolved_frequency_ / angular_frequency, farthest)));
  return std::max({engine.next_steps > 0 ? engine.next_steps : 64, 16 * order, 2 * least, for_ringing});
}

void TimeMarchingSolver::start_states(Engine& engine, std::span<const Excitation> excitations, SteadyStart start,
                                      LaneArray& states) const {
  const Index slips = engine.map->slip_start();
  states.resize(engine.map->size(), static_cast<Index>(excitations.size()));
  for (Index l = 0; l < states.cols(); ++l) {
    const Excitation& excitation = excitations[static_cast<std::size_t>(l)];
    const Place& place = engine.places[static_cast<std::size_t>(l)];
    if (start == SteadyStart::rest || place.state.size() == 0 || !place.state.allFinite()) {
      const bool rests = start == SteadyStart::rest;
      engine.map->encode(rests ? system_.start() : nearer_linear_limit(system_, excitation), states, l);
      continue;
    }
    states.col(l) = place.state;
    // Along a sweep of the frequency the states are continued in a straight line, but for the slips of those who stick.
    const double before = place.excitation.angular_frequency - place.earlier_frequency;
    const double ratio = (excitation.angular_frequency - place.excitation.angular_frequency) / before;
    if (place.earlier_frequency > 0.0 && ratio > 0.0 && ratio < 2.0)
      states.col(l) += ratio * (place.state - place.earlier).array();
    for (Index i = 0; i < place.offset.size(); ++i) {
      if (place.offset[i] != 0.0) states(slips + i, l) = place.state[slips + i];
      if (place.offset[i] != 0.0 && start == SteadyStart::unloaded) states(slips + i, l) = 0.0;
    }
  }
}

// Puts the offsets of sliders that never slip to zero, or as near as they do not slip. Returns whether any was not.
bool TimeMarchingSolver::release_offsets(const Engine& engine, Index lane, const Excitation& excitation,
                                         const SteadyResponse& response, LaneArray& states) const {
  bool has_changed = false;
  for (Index i = 0; i < slider_stiffness_.size(); ++i) {
    if (response.slip_share[i] > 0.0 || excitation.limits[i] == 0.0) continue;
    const double stiffness = slider_stiffness_[i], limit = excitation.limits[i];
    const auto u = engine.records[static_cast<std::size_t>(lane)].displacement.row(i);
    const double least = -limit - stiffness * u.minCoeff(), most = limit - stiffness * u.maxCoeff();
    const double offset = least <= most ? std::clamp(0.0, least, most) : 0.5 * (least + most);
    constexpr double round_off = 1e-9;
    if (!(std::abs(offset - response.offset[i]) > round_off * limit)) continue;
    states(engine.map->slip_start() + i, lane) = -offset / stiffness;
    has_changed = true;
  }
  return has_changed;
}

void TimeMarchingSolver::find(Engine& engine, std::span<const Excitation> excitations, SteadyStart start, int steps,
                              bool is_full, LaneArray& states, std::span<SteadyResponse> responses) const {
  OrbitSearchOptions search;
  search.tolerance = options_.periodicity;
  search.max_periods = options_.max_periods;
  search.rigid = engine.rigid;
  const bool extrapolates = options_.extrapolates && start != SteadyStart::rest;
  const SteadyRequest& request = is_full ? request_ : amplitudes_;
  engine.records.resize(excitations.size());
  for (SteadyResponse& response : responses) response.iterations = 0;
  constexpr int most_rounds = 8;
  for (int round = 0; round < most_rounds; ++round) {
    const auto orbits = search_orbits(*engine.map, search, extrapolates ? engine.extrapolation.get() : nullptr, states);
    int longest = 1;
    for (std::size_t l = 0; l < orbits.size(); ++l) {
      const OrbitReport& orbit = orbits[l];
      SteadyResponse& response = responses[l];
      response.status = orbit.status;
      response.residual = orbit.residual;
      response.error = orbit.observed_distance;
      response.iterations += orbit.marched;
      response.periods = orbit.status == SteadyStatus::quasi_periodic ? quasi_periodic_window : orbit.multiple;
      longest = std::max(longest, response.periods);
      engine.records[l].reset(static_cast<Index>(request.observed.size()), system_.slider_count(),
                              static_cast<Index>(response.periods) * steps, request.rates, is_full);
    }
    LaneArray now = states, next;
    for (int period = 0; period < longest; ++period) {
      if (!engine.map->advance(now, next, &engine.records, static_cast<Index>(period) * steps))
        for (SteadyResponse& response : responses) {
          response.status = SteadyStatus::not_converged;
          response.error = response.residual = infinity;
        }
      std::swap(now, next);
    }
    bool has_changed = false, is_rough = false;
    for (std::size_t l = 0; l < orbits.size(); ++l) {
      read_record(engine.records[l], excitations[l], slider_stiffness_, responses[l].periods, request, responses[l]);
      responses[l].drift.resize(0);
      if (responses[l].status == SteadyStatus::drifting)
        responses[l].drift = engine.records[l].position.col(steps) - engine.records[l].position.col(0);
      // What is observed may move far less than the rest of the structure.
      const double size = responses[l].amplitude.size() > 0 ? responses[l].amplitude.maxCoeff() : 0.0;
      responses[l].error = size > 0.0 ? caution_of_transient * responses[l].error / size : 0.0;
      is_rough = is_rough ||
                 (is_repeating(responses[l].status) && responses[l].error > share_of_transient * options_.tolerance);
      if (start == SteadyStart::unloaded && responses[l].status == SteadyStatus::converged)
        has_changed =
            release_offsets(engine, static_cast<Index>(l), excitations[l], responses[l], states) || has_changed;
    }
    if (!has_changed && (!is_rough || search.tolerance <= finest_periodicity)) return;
    if (is_rough) search.tolerance *= 0.1;
  }
}

bool TimeMarchingSolver::compare(Engine& engine, std::span<const Excitation> excitations, SteadyStart start, int steps,
                                 int other_steps, const LaneArray& states, std::span<const SteadyResponse> responses,
                                 std::span<double> errors) const {
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
void TimeMarchingSolver::estimate(Engine& engine, std::span<const Excitation> excitations, SteadyStart start, int steps,
                                  const LaneArray& states, std::span<SteadyResponse> responses,
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

bool TimeMarchingSolver::solve_with(Engine& engine, std::span<const Excitation> excitations, SteadyStart start,
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
  steps_ = engine.steps = steps;
  engine.next_steps = 8 * static_cast<int>(std::ceil(std::min<double>(suggestion, options_.max_steps) / 8.0));
  for (std::size_t l = 0; l < count; ++l) {
    Place& place = engine.places[l];
    place.earlier_frequency = place.state.size() > 0 ? place.excitation.angular_frequency : 0.0;
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

void TimeMarchingSolver::solve_lanes(std::span<const Excitation> excitations, SteadyStart start,
                                     std::span<SteadyResponse> responses) {
  assert(!excitations.empty() && excitations.size() <= static_cast<std::size_t>(lanes()) &&
         excitations.size() == responses.size());
  if (lanes_ && solve_with(*lanes_, excitations, start, responses)) return;
  // One after the other; the places of a list have no memory of their own here.
  for (std::size_t l = 0; l < excitations.size(); ++l) {
    if (excitations.size() > 1) steppers_->forget();
    solve_with(*steppers_, excitations.subspan(l, 1), start, responses.subspan(l, 1));
  }
}

void TimeMarchingSolver::solve(const Excitation& excitation, SteadyStart start, SteadyResponse& response) {
  solve_lanes({&excitation, 1}, start, {&response, 1});
}

Waveform TimeMarchingSolver::waveform(int points) const {
  Waveform result;
  if (!last_ || points < 1) return result;
  const Place& place = last_->places.back();
  const Index n = system_.size(), m = system_.slider_count();
  const int steps = last_->steps;
  SteadyRequest all;
  for (Index i = 0; i < n; ++i) all.observed.push_back({i, ground});
  const auto map = last_ == lanes_.get() ? make_lane_map(options_.method, system_, all)
                                         : make_stepper_map(options_.method, system_, all);
  map->prepare({&place.excitation, 1}, steps);
  std::vector<PeriodRecord> records(1);
  PeriodRecord& record = records[0];
  record.reset(n, m, steps, true, false);
  LaneArray after;
  map->advance(place.state.array(), after, &records, 0);
  const double period = place.excitation.period(), step = period / steps;
  result.time.resize(points);
  result.position.resize(n, points);
  result.velocity.resize(n, points);
  result.slider_force.resize(m, points);
  result.displacement.resize(m, points);
  for (int k = 0; k < points; ++k) {
    result.time[k] = period * k / points;
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

}  // namespace rubato::integrate
