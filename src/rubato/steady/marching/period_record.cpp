#include <rubato/steady/marching/period_record.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rubato::steady {
namespace {

// A slip shorter than this part of the travel in a period is round-off of a sticking slider.
constexpr double least_slip = 1e-10;

// Widens [low, high] by the extrema inside (0, 1) of the cubic Hermite polynomial with values a, b and slopes (times
// the step) da, db at its ends.
void widen_by_cubic(double a, double b, double da, double db, double& low, double& high) {
  if (!(da * db < 0.0)) return;  // an interior extremum of a smooth arc lies where the slope changes its sign
  // p' = da + 2 c s + 3 d s^2
  const double c = 3.0 * (b - a) - 2.0 * da - db, d = 2.0 * (a - b) + da + db;
  const double root = std::sqrt(std::max(0.0, c * c - 3.0 * d * da));
  const double denominator = -(c + std::copysign(root, c));
  for (const double s : {da / denominator, denominator / (3.0 * d)}) {
    if (!(s > 0.0 && s < 1.0)) continue;
    const double value = a + s * (da + s * (c + s * d));
    low = std::min(low, value);
    high = std::max(high, value);
  }
}

void read_sliders(const PeriodRecord& record, const system::Excitation& excitation, const Vector& stiffness,
                  int periods, SteadyResponse& response) {
  const Index m = record.slider_force.rows(), steps = record.steps;
  response.dissipated.setZero(m);
  response.slip_share.setZero(m);
  response.offset.setZero(m);
  response.transitions = 0;
  long transitions = 0;
  for (Index i = 0; i < m; ++i) {
    if (excitation.limits[i] == 0.0) {  // no slider at all
      response.slip_share[i] = 1.0;
      continue;
    }
    const auto u = record.displacement.row(i);
    const auto force = record.slider_force.row(i);
    const double kt = stiffness[i];
    const double travel = u.maxCoeff() - u.minCoeff() + excitation.limits[i] / kt;
    double work = 0.0, share = 0.0;
    int first_state = 2, state = 2;  // 2: none yet; else the direction of the slip in a step, or 0
    for (Index j = 0; j < steps; ++j) {
      const double du = u[j + 1] - u[j], slip = du - (force[j + 1] - force[j]) / kt;
      const int now = std::abs(slip) <= least_slip * travel ? 0 : slip > 0.0 ? 1 : -1;
      work += 0.5 * (force[j] + force[j + 1]) * slip;
      if (now != 0) share += std::min(1.0, std::abs(slip) / std::max(std::abs(du), std::abs(slip)));
      if (state == 2)
        first_state = now;
      else if (now != state)
        transitions += now * state == 0 ? 1 : 2;  // from slip to slip back there is a stick between the samples
      state = now;
    }
    if (state != first_state) transitions += state * first_state == 0 ? 1 : 2;
    response.dissipated[i] = work / periods;
    response.slip_share[i] = share / static_cast<double>(steps);
    if (share == 0.0) response.offset[i] = force[0] - kt * u[0];
  }
  response.transitions = std::lround(static_cast<double>(transitions) / periods);
}

}  // namespace

void PeriodRecord::reset(Index observed, const system::LocallyNonlinear& system, Index wanted, bool accelerations,
                         bool works) {
  const Index sliders = system.slider_count();
  has_works = works;
  steps = wanted;
  position.resize(observed, wanted + 1);
  velocity.resize(observed, wanted + 1);
  acceleration.resize(accelerations ? observed : 0, wanted + 1);
  slider_force.resize(sliders, wanted + 1);
  displacement.resize(sliders, wanted + 1);
  law_work.setZero(system.law_count() + system.block_count());
  viscous_work = input_work = 0.0;
}

Vector half_peak_to_peak(const Matrix& value, const Matrix& slope, double step) {
  Vector result(value.rows());
  for (Index i = 0; i < value.rows(); ++i) {
    double low = value(i, 0), high = low;
    for (Index j = 0; j + 1 < value.cols(); ++j) {
      low = std::min(low, value(i, j + 1));
      high = std::max(high, value(i, j + 1));
      widen_by_cubic(value(i, j), value(i, j + 1), step * slope(i, j), step * slope(i, j + 1), low, high);
    }
    result[i] = 0.5 * (high - low);
  }
  return result;
}

Vector half_peak_to_peak_of_samples(const Matrix& value) {
  const Index count = value.cols() - 1;  // the last repeats the first
  Vector result(value.rows());
  for (Index i = 0; i < value.rows(); ++i) {
    double ends[2];
    for (const int sign : {1, -1}) {
      Index j = 0;
      (sign * value.row(i).head(count)).maxCoeff(&j);
      const double before = value(i, (j + count - 1) % count), at = value(i, j), after = value(i, (j + 1) % count);
      const double bend = before - 2.0 * at + after, rise = after - before;
      ends[sign > 0 ? 0 : 1] = bend != 0.0 ? at - rise * rise / (8.0 * bend) : at;
    }
    result[i] = 0.5 * (ends[0] - ends[1]);
  }
  return result;
}

Vector root_mean_square(const Matrix& value) {
  const Index count = value.cols() - 1;
  Vector result(value.rows());
  for (Index i = 0; i < value.rows(); ++i) {
    const double ends = 0.5 * (value(i, 0) * value(i, 0) + value(i, count) * value(i, count));
    result[i] = std::sqrt((ends + value.row(i).segment(1, count - 1).squaredNorm()) / static_cast<double>(count));
  }
  return result;
}

Vector unresolved_ringing(const PeriodRecord& record) {
  constexpr double least_part = 0.1;
  const auto steps = static_cast<double>(record.steps);
  const double cube = 2.0 * std::numbers::pi * std::numbers::pi / (3.0 * steps * steps);  // w_j = cube j^3
  const auto last = std::min<Index>(record.steps / 2 - 1, static_cast<Index>(std::cbrt(1.0 / cube)));
  Vector result = Vector::Zero(record.position.rows());
  std::vector<std::complex<double>> turns(static_cast<std::size_t>(record.steps));
  for (Index i = 0; i < record.steps; ++i)
    turns[static_cast<std::size_t>(i)] = std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(i) / steps);
  for (Index row = 0; row < result.size(); ++row) {
    // Less what it drifts, whose saw teeth ring at no order.
    const double drift = record.position(row, record.steps) - record.position(row, 0);
    const Vector samples = record.position.row(row).head(record.steps).transpose() -
                           Vector::LinSpaced(record.steps, 0.0, drift * (1.0 - 1.0 / steps));
    const double mean = samples.mean();
    double rest = (samples.array() - mean).square().mean(), uncertain = 0.0;
    const double round_off = 1e-14 * rest;
    for (Index j = 1; j <= last; ++j) {
      std::complex<double> sum = 0.0;
      for (Index i = 0; i < record.steps; ++i)
        sum += (samples[i] - mean) * turns[static_cast<std::size_t>((i * j) % record.steps)];
      const double size = 2.0 * std::abs(sum) / steps, part = cube * std::pow(static_cast<double>(j), 3);
      rest -= 0.5 * size * size;
      if (part > least_part) uncertain += part * size;
    }
    result[row] = uncertain + (rest > round_off ? std::sqrt(2.0 * rest) : 0.0);
  }
  return result;
}

void read_record(const PeriodRecord& record, const system::Excitation& excitation, const Vector& slider_stiffness,
                 int periods, const SteadyRequest& request, SteadyResponse& response) {
  const Index observed = record.position.rows(), steps = record.steps;
  const double step = periods * excitation.period() / static_cast<double>(steps);
  response.periods = periods;
  response.amplitude = half_peak_to_peak(record.position, record.velocity, step);
  response.velocity_amplitude.resize(0);
  response.acceleration_amplitude.resize(0);
  if (request.rates) {
    response.velocity_amplitude = half_peak_to_peak(record.velocity, record.acceleration, step);
    response.acceleration_amplitude = half_peak_to_peak_of_samples(record.acceleration);
  }
  // The two ends count half each: they are one where the response repeats.
  response.rms = root_mean_square(record.position);
  response.mean.resize(observed);
  for (Index i = 0; i < observed; ++i)
    response.mean[i] =
        (record.position.row(i).head(steps).sum() + 0.5 * (record.position(i, steps) - record.position(i, 0))) /
        static_cast<double>(steps);
  response.harmonics.setZero(observed, static_cast<Index>(request.harmonics.size()));
  for (std::size_t k = 0; k < request.harmonics.size(); ++k) {
    const double angle = excitation.angular_frequency * request.harmonics[k] * step;
    const std::complex<double> turn = std::polar(1.0, -angle);
    std::complex<double> phase = 1.0;
    for (Index j = 0; j <= steps; ++j) {
      const double weight = j == 0 || j == steps ? 0.5 : 1.0;
      response.harmonics.col(static_cast<Index>(k)) += (weight * phase) * record.position.col(j);
      phase = j % 64 == 63 ? std::polar(1.0, -angle * static_cast<double>(j + 1)) : phase * turn;
    }
    response.harmonics.col(static_cast<Index>(k)) *= 2.0 / static_cast<double>(steps);
  }
  read_sliders(record, excitation, slider_stiffness, periods, response);
  response.law_dissipated = record.law_work / periods;
  response.viscous_work = record.viscous_work / periods;
  response.input_work = record.input_work / periods;
}

}  // namespace rubato::steady
