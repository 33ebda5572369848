#include <rubato/integrate/estimators/mass_norm.hpp>
#include <rubato/integrate/estimators/response_scales.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

double raised(double length, double rate, int order) { return length > 0.0 ? length * std::pow(rate, order) : 0.0; }

}  // namespace

double ResponseScales::size(double most) const {
  return std::max({displacement.length, reached, raised(velocity.length, velocity.rate, -1),
                   std::min(most, raised(acceleration.length, acceleration.rate, -2))});
}

double ResponseScales::derivative(int k) const {
  return std::max(raised(velocity.length, velocity.frequency, k - 1),
                  raised(acceleration.length, acceleration.rate, k - 2));
}

double ResponseScales::frequency_of(int k) const {
  return raised(velocity.length, velocity.frequency, k - 1) > raised(acceleration.length, acceleration.rate, k - 2)
             ? velocity.frequency
             : acceleration.rate;
}

double reached_by(const system::LocallyNonlinear& system, const Vector& velocity, double duration) {
  MassNorm norm(system);
  const Vector momentum = norm.times(velocity);
  if (!(momentum.dot(velocity) > 0.0)) return 0.0;
  const SparseMatrix stiffness = system.stuck_stiffness();
  numerics::OrderedFactor factor;
  Vector q(system.size());
  double reached = 0.0;
  for (const double t : {duration, 0.1 * duration, 0.01 * duration}) {
    const SparseMatrix held = SparseMatrix(t * stiffness + system.damping()) + (1.0 / t) * system.mass();
    if (reached == 0.0) factor.analyse(held, {});
    if (!factor.factorise(held)) return reached;  // a stiffness that is not one: nothing is promised
    factor.solve(momentum, q);
    reached = std::max(reached, norm(q));
  }
  return reached;
}

ResponseScales response_scales(const system::LocallyNonlinear& system, const system::State& state,
                               const Vector& acceleration, double duration) {
  MassNorm norm(system);
  const SparseMatrix stiffness = system.stuck_stiffness();
  const auto shape_of = [&](const Vector& x) -> ResponseScales::Shape {
    const double length = norm(x);
    if (!(length > 0.0)) return {};
    double work = x.dot(stiffness * x);
    for (Index i = system.slider_count(); i < system.first_law(); ++i)
      if (state.slider_force[i] > 0.0)
        work += system.stops()[static_cast<std::size_t>(i - system.slider_count())].stiffness *
                std::pow(system.relative_displacement(i, x), 2);
    const double quotient = work / (length * length);
    const double frequency = std::max(1.0 / duration, std::sqrt(std::max(0.0, quotient)));
    const double damping = x.dot(system.damping() * x) / (length * length);
    return {length, frequency, std::max(frequency, damping)};
  };
  return {shape_of(state.q), shape_of(state.v), shape_of(acceleration), 0.0};
}

}  // namespace rubato::integrate
