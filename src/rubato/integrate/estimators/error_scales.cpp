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
  remembered_ = measured_ = 0.0;
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

double ErrorScales::memory() const {
  return measured_ > 0.0 ? std::min(duration_, std::sqrt(remembered_ / measured_)) : duration_;
}

double ErrorScales::memory_of(const Vector& shape, double shape_squared, double h) {
  const bool is_due = is_damped_ && (steps_ % stride == 0 || h != last_step_) && shape_squared > 0.0;
  remembered_now_ = is_due ? space_.remembered_squared(shape) : -1.0;
  measured_now_ = shape_squared;
  if (!is_due) return memory();
  const double now = std::sqrt(remembered_now_ / measured_now_);
  return std::min(duration_, measured_ > 0.0 ? std::max(memory(), now) : now);
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
  if (remembered_now_ >= 0.0) {
    const double weight = measured_ > 0.0 ? -std::expm1(-static_cast<double>(stride) * frequency() * h) : 1.0;
    remembered_ += weight * (remembered_now_ - remembered_);
    measured_ += weight * (measured_now_ - measured_);
  }
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
