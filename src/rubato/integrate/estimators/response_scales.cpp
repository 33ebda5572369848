#include <rubato/integrate/estimators/mass_norm.hpp>
#include <rubato/integrate/estimators/response_scales.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

double raised(const ResponseScales::Shape& shape, int order) {
  return shape.length > 0.0 ? shape.length * std::pow(shape.frequency, order) : 0.0;
}

}  // namespace

double ResponseScales::size() const {
  return std::max({displacement.length, raised(velocity, -1), raised(acceleration, -2)});
}

double ResponseScales::derivative(int k) const {
  return std::max(raised(velocity, k - 1), raised(acceleration, k - 2));
}

double ResponseScales::frequency_of(int k) const {
  return raised(velocity, k - 1) > raised(acceleration, k - 2) ? velocity.frequency : acceleration.frequency;
}

ResponseScales response_scales(const system::LocallyNonlinear& system, const system::State& state,
                               const Vector& acceleration, double duration) {
  MassNorm norm(system);
  const SparseMatrix stiffness = system.stuck_stiffness();
  const auto shape_of = [&](const Vector& x) -> ResponseScales::Shape {
    const double length = norm(x);
    if (!(length > 0.0)) return {};
    const double quotient = x.dot(stiffness * x) / (length * length);
    return {length, std::max(1.0 / duration, std::sqrt(std::max(0.0, quotient)))};
  };
  return {shape_of(state.q), shape_of(state.v), shape_of(acceleration)};
}

}  // namespace rubato::integrate
