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

double ResponseScales::size(double most) const {
  return std::max({displacement.length, raised(velocity, -1), std::min(most, raised(acceleration, -2))});
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
    double work = x.dot(stiffness * x);
    for (Index i = system.slider_count(); i < system.contact_count(); ++i)
      if (state.slider_force[i] > 0.0)
        work += system.stops()[static_cast<std::size_t>(i - system.slider_count())].stiffness *
                std::pow(system.relative_displacement(i, x), 2);
    const double quotient = work / (length * length);
    return {length, std::max(1.0 / duration, std::sqrt(std::max(0.0, quotient)))};
  };
  return {shape_of(state.q), shape_of(state.v), shape_of(acceleration)};
}

}  // namespace rubato::integrate
