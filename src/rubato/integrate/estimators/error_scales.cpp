#include <rubato/integrate/estimators/error_scales.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rubato::integrate {
namespace {

constexpr long stride = 4;  // steps between looks at what costs products with matrices

}  // namespace

ErrorScales::ErrorScales(ErrorSpace& space, double duration, int derivative)
    : space_(space),
      duration_(duration),
      derivative_(derivative),
      is_damped_(space.is_damped()),
      has_stops_(space.has_stops()) {}

void ErrorScales::start(const system::State& state) {
  y_ = rate_ = 0.0;
  steps_ = 0;
  memory_ = decay_ = {};
  expect(state);
}

void ErrorScales::expect(const system::State& state) {
  const ResponseScales scales = space_.scales(state, state.auxiliary_acceleration, duration_);
  const double omega = scales.frequency_of(derivative_);
  size_ = std::max({size_, space_.promised_size(scales), space_.least_size()});
  third_at_start_ = scales.derivative(3);
  y_ = std::pow(scales.derivative(derivative_), 2);
  rate_ = omega * omega * y_;
  promised_ = scales.frequency_of(1);
}

double ErrorScales::frequency() const {
  const double slowest = 1.0 / duration_;
  return std::max(slowest, y_ > 0.0 ? std::sqrt(rate_ / y_) : 0.0);
}

double ErrorScales::speed_frequency() const {
  const double slowest = 1.0 / duration_;
  return std::max(slowest, speed_ > 0.0 ? std::sqrt(speed_rate_ / speed_) : promised_);
}

double ErrorScales::Memory::most(double duration) const {
  return measured > 0.0 ? std::min(duration, std::sqrt(remembered / measured)) : duration;
}

double ErrorScales::Memory::with_now(double duration) const {
  if (!(remembered_now >= 0.0)) return most(duration);
  const double now = std::sqrt(remembered_now / measured_now);
  return std::min(duration, measured > 0.0 ? std::max(most(duration), now) : now);
}

void ErrorScales::Memory::accept(double share) {
  if (!(remembered_now >= 0.0)) return;
  const double weight = measured > 0.0 ? share : 1.0;
  remembered += weight * (remembered_now - remembered);
  measured += weight * (measured_now - measured);
}

double ErrorScales::memory() const { return memory_.most(duration_); }

bool ErrorScales::is_due(double squared, double h) const {
  return is_damped_ && (steps_ % stride == 0 || h != last_step_) && squared > 0.0;
}

double ErrorScales::memory_of(const Vector& shape, double shape_squared, double h) {
  memory_.remembered_now = is_due(shape_squared, h) ? space_.remembered_squared(shape) : -1.0;
  memory_.measured_now = shape_squared;
  decay_.remembered_now = -1.0;
  return memory_.with_now(duration_);
}

double ErrorScales::decay_of(const Vector& w, double squared, double h) {
  decay_.remembered_now = is_due(squared, h) ? space_.decaying_squared(w) : -1.0;
  decay_.measured_now = squared;
  return decay_.with_now(duration_);
}

double ErrorScales::relative(double dq_squared, double dv_squared, const system::State& to, bool is_contact) const {
  double size = size_, omega = frequency();
  if (!(size > 0.0 && y_ > 0.0)) {  // at rest until now: by what it is about to do
    const ResponseScales scales = space_.scales(to, to.auxiliary_acceleration, duration_);
    size = std::max(size, space_.promised_size(scales));
    omega = scales.frequency_of(derivative_);
    if (!(size > 0.0 && omega > 0.0)) return 0.0;
  }
  if (is_contact) omega = std::min(omega, speed_frequency());
  return std::sqrt(dq_squared + dv_squared / (omega * omega)) / size;
}

void ErrorScales::accept(double y, double rate, const system::State& to, double h) {
  if (!(y > 0.0)) return;
  if (!(y_ > 0.0)) expect(to);  // at rest until now
  const double share = -std::expm1(-frequency() * h / (2.0 * std::numbers::pi));
  if (rate >= 0.0) {
    y_ += share * (y - y_);
    rate_ += share * (rate - rate_);
  }
  const double weight = -std::expm1(-static_cast<double>(stride) * frequency() * h);
  memory_.accept(weight);
  decay_.accept(weight);
  last_step_ = h;
  if (steps_++ % stride != 0) return;
  size_ = std::max(size_, space_.displacement(to));
  if (!has_stops_ || space_.touches(to)) return;
  const Vector& momentum = space_.times_mass(to.v);
  const double speed_squared = momentum.dot(to.v), power = momentum.dot(to.auxiliary_acceleration);
  speed_ += h * speed_squared;
  if (speed_squared > 0.0) speed_rate_ += h * power * power / speed_squared;
}

}  // namespace rubato::integrate
