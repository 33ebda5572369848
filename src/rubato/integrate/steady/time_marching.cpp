#include <rubato/core/error.hpp>
#include <rubato/integrate/stability.hpp>
#include <rubato/integrate/steady/linear_limits.hpp>
#include <rubato/integrate/steady/stepper_map.hpp>
#include <rubato/integrate/steady/time_marching.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rubato::integrate {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double stability_margin = 0.9;
constexpr int quasi_periodic_window = 64;  // periods whose largest motion is the amplitude

void check(const TimeMarchingOptions& options) {
  if (std::holds_alternative<Exact>(options.method.formula))
    throw InvalidInput(
        "solver = \"time_marching\" needs a method with a step; \"exact\" has none: take another one, or solver = "
        "\"periodic\", which uses the exact flow");
  if (!(options.tolerance > 0.0 && options.tolerance < 1.0))
    throw InvalidInput(fmt::format("tolerance must lie between 0 and 1, got {}", options.tolerance));
  if (!(options.periodicity >= 0.0 && options.periodicity < 1.0))
    throw InvalidInput(fmt::format("periodicity must lie in [0, 1), got {}", options.periodicity));
  if (options.steps_per_period < 0)
    throw InvalidInput(fmt::format("steps_per_period must not be negative, got {}", options.steps_per_period));
  if (options.max_periods < 1)
    throw InvalidInput(fmt::format("max_periods must be at least 1, got {}", options.max_periods));
}

// Largest difference of two answers, relative to the largest amplitude.
double difference(const SteadyResponse& a, const SteadyResponse& b) {
  const double size = a.amplitude.size() > 0 ? a.amplitude.maxCoeff() : 0.0;
  if (size == 0.0) return 0.0;
  const double of_amplitude = (a.amplitude - b.amplitude).cwiseAbs().maxCoeff();
  const double of_rms = std::numbers::sqrt2 * (a.rms - b.rms).cwiseAbs().maxCoeff();
  return std::max(of_amplitude, of_rms) / size;
}

}  // namespace

/// The last point, from which the next one starts.
struct TimeMarchingSolver::Memory {
  Excitation excitation;
  LaneArray states;
  Vector offset;       // of the sliders that never slipped
  int steps = 0;       // a period, of the states
  int next_steps = 0;  // that would have been enough
};

TimeMarchingSolver::TimeMarchingSolver(const system::LocallyNonlinear& system, TimeMarchingOptions options,
                                       SteadyRequest request)
    : system_(system), options_(std::move(options)), request_(std::move(request)), records_(1) {
  check(options_);
  if (options_.periodicity == 0.0) options_.periodicity = 0.01 * options_.tolerance;
  const ModelStability stability = stability_of(options_.method, system);
  stable_step_ = stability.step;
  if (!(stable_step_ > 0.0))
    throw InvalidInput(fmt::format(
        "the method {} has no stable step for this model (mode {}, {:.6g} rad/s, damping ratio {:.3g}): take an "
        "implicit one, such as generalized_alpha",
        options_.method.name, stability.mode, stability.angular_frequency, stability.damping_ratio));
  order_ = std::clamp(find_method(options_.method.name).order, 1, 2);
  slider_stiffness_.resize(system.slider_count());
  for (Index i = 0; i < slider_stiffness_.size(); ++i)
    slider_stiffness_[i] = system.sliders()[static_cast<std::size_t>(i)].stiffness;
  map_ = make_stepper_map(options_.method, system_, request_);
}

TimeMarchingSolver::~TimeMarchingSolver() = default;

void TimeMarchingSolver::forget() { memory_.reset(); }

int TimeMarchingSolver::least_steps(double angular_frequency) const {
  const double steps = 2.0 * std::numbers::pi / (angular_frequency * stability_margin * stable_step_);
  return steps < 1e9 ? std::max(1, static_cast<int>(std::ceil(steps))) : std::numeric_limits<int>::max() / 4;
}

int TimeMarchingSolver::first_steps(const Excitation& excitation) const {
  const int least = least_steps(excitation.angular_frequency);
  if (options_.steps_per_period > 0) {
    if (options_.steps_per_period < least)
      throw InvalidInput(
          fmt::format("{} steps a period are too few for {} at {:.6g} rad/s: it is stable from {} steps on; give more, "
                      "or none, and "
                      "they are chosen",
                      options_.steps_per_period, options_.method.name, excitation.angular_frequency, least));
    return options_.steps_per_period;
  }
  int order = 1;
  for (const LoadHarmonic& harmonic : excitation.harmonics) order = std::max(order, harmonic.order);
  for (const int wanted : request_.harmonics) order = std::max(order, wanted);
  const int guess = memory_ && memory_->next_steps > 0 ? memory_->next_steps : 64;
  return std::max({guess, 16 * order, 2 * least});
}

void TimeMarchingSolver::start_states(const Excitation& excitation, SteadyStart start, LaneArray& states) {
  states.resize(map_->size(), 1);
  if (start == SteadyStart::rest || !memory_ || !memory_->states.allFinite()) {
    map_->encode(start == SteadyStart::rest ? system_.start() : nearer_linear_limit(system_, excitation), states, 0);
    return;
  }
  states = memory_->states;
  if (start != SteadyStart::unloaded) return;
  for (Index i = 0; i < memory_->offset.size(); ++i)
    if (memory_->offset[i] != 0.0) states(map_->slip_start() + i, 0) = 0.0;
}

// Puts the offsets of sliders that never slip to zero, or as near as they do not slip. Returns whether any was not.
bool TimeMarchingSolver::release_offsets(const Excitation& excitation, const SteadyResponse& response,
                                         LaneArray& states) const {
  bool has_changed = false;
  for (Index i = 0; i < slider_stiffness_.size(); ++i) {
    if (response.slip_share[i] > 0.0 || excitation.limits[i] == 0.0) continue;
    const double stiffness = slider_stiffness_[i], limit = excitation.limits[i];
    const auto u = records_[0].displacement.row(i);
    const double least = -limit - stiffness * u.minCoeff(), most = limit - stiffness * u.maxCoeff();
    const double offset = least <= most ? std::clamp(0.0, least, most) : 0.5 * (least + most);
    if (!(std::abs(offset - response.offset[i]) > options_.periodicity * limit)) continue;
    states(map_->slip_start() + i, 0) = -offset / stiffness;
    has_changed = true;
  }
  return has_changed;
}

// The response with a given number of steps, from `states`, which become the start of its period.
void TimeMarchingSolver::find(const Excitation& excitation, SteadyStart start, int steps, LaneArray& states,
                              SteadyResponse& response) {
  OrbitSearchOptions search;
  search.tolerance = options_.periodicity;
  search.max_periods = options_.max_periods;
  response.iterations = 0;
  constexpr int most_releases = 8;
  for (int round = 0; round < most_releases; ++round) {
    const bool extrapolates = options_.extrapolates && start != SteadyStart::rest;
    const OrbitReport orbit = search_orbits(*map_, search, extrapolates, states)[0];
    response.status = orbit.status;
    response.residual = orbit.residual;
    response.error = orbit.distance;
    response.iterations += orbit.marched;
    const int periods = orbit.status == SteadyStatus::quasi_periodic ? quasi_periodic_window : orbit.multiple;
    records_[0].reset(static_cast<Index>(request_.observed.size()), system_.slider_count(),
                      static_cast<Index>(periods) * steps, request_.rates);
    LaneArray now = states, next;
    for (int period = 0; period < periods; ++period) {
      if (!map_->advance(now, next, &records_, static_cast<Index>(period) * steps)) {
        response.status = SteadyStatus::not_converged;
        response.error = response.residual = std::numeric_limits<double>::infinity();
      }
      std::swap(now, next);
    }
    read_record(records_[0], excitation, slider_stiffness_, periods, request_, response);
    if (start != SteadyStart::unloaded || orbit.status != SteadyStatus::converged ||
        !release_offsets(excitation, response, states))
      return;
  }
}

void TimeMarchingSolver::solve(const Excitation& excitation, SteadyStart start, SteadyResponse& response) {
  int steps = first_steps(excitation);
  const int least = least_steps(excitation.angular_frequency);
  const bool is_given = options_.steps_per_period > 0;
  LaneArray states;
  map_->prepare({&excitation, 1}, steps);
  start_states(excitation, start, states);
  double suggestion = steps;
  SteadyResponse other;
  for (;;) {
    find(excitation, start, steps, states, response);
    const double transient = response.error;
    if (response.status != SteadyStatus::converged && response.status != SteadyStatus::subharmonic) {
      response.error = not_a_number;
      break;
    }
    // The companion with another step starts where this one ended.
    const int other_steps = steps / 2 >= least ? (steps + 1) / 2 : 2 * steps;
    const double ratio = std::pow(static_cast<double>(steps) / other_steps, order_);
    LaneArray other_states = states;
    map_->prepare({&excitation, 1}, other_steps);
    find(excitation, start == SteadyStart::rest ? start : SteadyStart::previous, other_steps, other_states, other);
    map_->prepare({&excitation, 1}, steps);
    const double change = difference(response, other);
    const double of_step = other.status == response.status ? change / std::abs(ratio - 1.0) : not_a_number;
    response.error = of_step + transient;
    const double share = std::max(of_step, 1e-12) / (0.5 * options_.tolerance);  // half of it for what is unseen
    suggestion = steps * std::clamp(std::pow(share, 1.0 / order_), 0.5, 4.0);
    if (is_given || response.error <= options_.tolerance) break;
    if (2 * steps > options_.max_steps || !(of_step <= std::numeric_limits<double>::max())) {
      response.status = SteadyStatus::not_converged;
      break;
    }
    const double more = std::max(suggestion, 1.2 * steps);
    steps = std::min(options_.max_steps, 8 * static_cast<int>(std::ceil(more / 8.0)));
    map_->prepare({&excitation, 1}, steps);
  }
  steps_ = steps;
  if (!memory_) memory_ = std::make_unique<Memory>();
  memory_->excitation = excitation;
  memory_->states = states;
  memory_->offset = response.offset;
  memory_->steps = steps;
  memory_->next_steps = 8 * static_cast<int>(std::ceil(std::min<double>(suggestion, options_.max_steps) / 8.0));
}

Waveform TimeMarchingSolver::waveform(int points) const {
  Waveform result;
  if (!memory_ || points < 1) return result;
  const Index n = system_.size(), m = system_.slider_count();
  SteadyRequest all;
  for (Index i = 0; i < n; ++i) all.observed.push_back({i, ground});
  const auto map = make_stepper_map(options_.method, system_, all);
  map->prepare({&memory_->excitation, 1}, memory_->steps);
  std::vector<PeriodRecord> records(1);
  PeriodRecord& record = records[0];
  record.reset(n, m, memory_->steps, true);
  LaneArray after;
  map->advance(memory_->states, after, &records, 0);
  const double period = memory_->excitation.period(), step = period / memory_->steps;
  result.time.resize(points);
  result.position.resize(n, points);
  result.velocity.resize(n, points);
  result.slider_force.resize(m, points);
  result.displacement.resize(m, points);
  for (int k = 0; k < points; ++k) {
    result.time[k] = period * k / points;
    const Index j = std::min<Index>(memory_->steps - 1, static_cast<Index>(result.time[k] / step));
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
      const double limit = memory_->excitation.limits[i];
      const double u = system_.relative_displacement(i, result.position.col(k));
      result.displacement(i, k) = u;
      result.slider_force(i, k) =
          std::clamp(record.slider_force(i, j) + slider_stiffness_[i] * (u - record.displacement(i, j)), -limit, limit);
    }
  }
  return result;
}

}  // namespace rubato::integrate
