#include <rubato/integrate/estimators/mass_norm.hpp>
#include <rubato/integrate/estimators/response_scales.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {

ResponseScales response_scales(const system::LocallyNonlinear& system, const system::State& state,
                               const Vector& acceleration, double duration) {
  MassNorm norm(system);
  const SparseMatrix stiffness = system.stuck_stiffness();
  const double slowest = 1.0 / duration;
  const auto frequency_of = [&](const Vector& shape, double length) {
    const double quotient = shape.dot(stiffness * shape) / (length * length);
    return std::max(slowest, std::sqrt(std::max(0.0, quotient)));
  };
  ResponseScales scales;
  scales.acceleration = norm(acceleration);
  const double velocity = norm(state.v), displacement = norm(state.q);
  scales.size = displacement;
  if (displacement > 0.0) scales.frequency = frequency_of(state.q, displacement);
  if (velocity > 0.0) {
    const double omega = frequency_of(state.v, velocity);
    scales.size = std::max(scales.size, velocity / omega);
    scales.frequency = std::max(scales.frequency, omega);
  }
  if (scales.acceleration > 0.0) {
    const double omega = frequency_of(acceleration, scales.acceleration);
    scales.size = std::max(scales.size, scales.acceleration / (omega * omega));
    scales.frequency = std::max(scales.frequency, omega);
  }
  return scales;
}

}  // namespace rubato::integrate
