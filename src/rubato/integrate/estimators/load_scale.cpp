#include <rubato/integrate/estimators/load_scale.hpp>
#include <rubato/integrate/estimators/mass_norm.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

/// Largest value of a law in [0, duration]: at the rows of a table, else at equal distances.
double largest_of(const model::TimeLaw& law, double duration) {
  if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&law)) return std::abs(harmonic->amplitude);
  double largest = 0.0;
  if (const auto* table = std::get_if<model::TableLaw>(&law)) {
    for (std::size_t i = 0; i < table->times.size(); ++i)
      if (table->times[i] >= 0.0 && table->times[i] <= duration)
        largest = std::max(largest, std::abs(table->values[i]));
  }
  constexpr int samples = 64;
  for (int i = 0; i <= samples; ++i) {
    const double value = std::abs(model::value(law, duration * i / samples));
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  return largest;
}

}  // namespace

double size_under_loads(const system::LocallyNonlinear& system, double duration) {
  const system::Loads loads = system.loads();  // a copy: formulas are workspaces
  if (loads.terms().empty()) return 0.0;
  numerics::OrderedFactor factor;
  const SparseMatrix held = system.stuck_stiffness() + 2.0 / (duration * duration) * system.mass();
  factor.analyse(held, {});
  if (!factor.factorise(held)) return 0.0;  // a stiffness that is not one: nothing is promised
  MassNorm norm(system);
  double squared = 0.0;
  Vector force(system.size()), q(system.size());
  for (const auto& term : loads.terms()) {
    const double largest = largest_of(term.law, duration);
    if (!(largest > 0.0)) continue;
    force.setZero();
    for (std::size_t i = 0; i < term.rows.size(); ++i) force[term.rows[i]] += largest * term.weights[i];
    factor.solve(force, q);
    double size = norm(q);
    if (!(size > 0.0 && std::isfinite(size))) continue;
    if (const auto* harmonic = std::get_if<model::HarmonicLaw>(&term.law)) {
      const double omega_squared = force.dot(q) / (size * size);
      size /= std::max(1.0, std::pow(harmonic->angular_frequency, 2) / omega_squared);
    }
    squared += size * size;
  }
  return std::sqrt(squared);
}

}  // namespace rubato::integrate
