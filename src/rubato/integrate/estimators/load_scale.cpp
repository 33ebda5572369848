#include <rubato/integrate/estimators/load_scale.hpp>
#include <rubato/integrate/estimators/mass_norm.hpp>
#include <rubato/model/time_kinks.hpp>
#include <rubato/numerics/ordered_factor.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace rubato::integrate {
namespace {

struct Sample {
  double t, value;
};

/// Within equal parts at the multiples of the golden ratio: distances that no period meets.
void add_times(double from, double to, int parts, std::vector<double>& times) {
  for (int i = 0; i < parts; ++i) {
    const double place = std::fmod((i + 1) * std::numbers::phi, 1.0);
    times.push_back(from + (to - from) * (i + place) / parts);
  }
}

/// Where loads swing faster than samples of the whole march see: four times in each step that they allow, but no more
/// than `most` in all, the fastest swings first.
void add_swings(const std::vector<numerics::StepBound>& bounds, double distance, double most,
                std::vector<double>& times) {
  constexpr double a_step = 4.0;
  std::vector<numerics::StepBound> fast;
  for (const auto& bound : bounds)
    if (bound.step < a_step * distance) fast.push_back(bound);
  std::sort(fast.begin(), fast.end(), [](const auto& a, const auto& b) { return a.step < b.step; });
  for (const auto& bound : fast) {
    const double parts = std::ceil(a_step * (bound.to - bound.from) / bound.step);
    if (parts > most) return;
    most -= parts;
    add_times(bound.from, bound.to, static_cast<int>(parts), times);
  }
}

/// A law at times within the march, where it swings, and at its kinks, on both sides of a jump.
std::vector<Sample> samples_of(const model::TimeLaw& law, double duration, int parts,
                               const std::vector<numerics::StepBound>& bounds) {
  std::vector<double> times;
  times.push_back(0.0);
  add_times(0.0, duration, parts, times);
  times.push_back(duration);
  if (!std::holds_alternative<model::TableLaw>(law)) add_swings(bounds, duration / parts, 4.0 * parts, times);
  const model::Kinks kinks = model::kinks(law, 0.0, duration);
  times.insert(times.end(), kinks.rows.begin(), kinks.rows.end());
  times.insert(times.end(), kinks.switches.begin(), kinks.switches.end());
  std::sort(times.begin(), times.end());
  std::vector<Sample> samples;
  for (const double t : times)
    for (const model::Side side : {model::Side::left, model::Side::right}) {
      const double value = model::value(law, t, side);
      samples.push_back({t, std::isfinite(value) ? value : 0.0});
    }
  return samples;
}

double largest_of(const std::vector<Sample>& samples) {
  double largest = 0.0;
  for (const Sample& sample : samples) largest = std::max(largest, std::abs(sample.value));
  return largest;
}

/// The largest |x| of x'' + omega^2 x = omega^2 p from rest, p linear between its samples (Nigam and Jennings 1969):
/// how far an oscillator of static displacement one comes, which a short load does not bring to it.
double largest_response(const std::vector<Sample>& p, double omega) {
  double x = 0.0, v = 0.0, largest = 0.0;
  for (std::size_t i = 1; i < p.size(); ++i) {
    const double h = p[i].t - p[i - 1].t;
    if (!(h > 0.0)) continue;
    const double slope = (p[i].value - p[i - 1].value) / h, even = x - p[i - 1].value, odd = (v - slope) / omega;
    const double c = std::cos(omega * h), s = std::sin(omega * h);
    x = p[i].value + even * c + odd * s;
    v = slope + omega * (odd * c - even * s);
    const bool may_turn = omega * h > 0.5;
    largest = std::max(largest, may_turn ? std::hypot(even, odd) + std::abs(p[i].value) : std::abs(x));
  }
  return largest;
}

}  // namespace

double size_under_loads(const system::LocallyNonlinear& system, double duration,
                        const std::vector<numerics::StepBound>& bounds) {
  const system::Loads loads = system.loads();  // a copy: formulas are workspaces
  if (loads.terms().empty()) return 0.0;
  numerics::OrderedFactor factor;
  const SparseMatrix held = SparseMatrix(system.stuck_stiffness() + 1.0 / duration * system.damping()) +
                            2.0 / (duration * duration) * system.mass();
  factor.analyse(held, {});
  if (!factor.factorise(held)) return 0.0;  // a stiffness that is not one: nothing is promised
  MassNorm norm(system);
  double squared = 0.0;
  // Enough for one load, and not too many for thousands.
  const int parts = static_cast<int>(std::max<std::size_t>(64, 4096 / loads.terms().size()));
  Vector force(system.size()), q(system.size());
  for (const auto& term : loads.terms()) {
    const auto* harmonic = std::get_if<model::HarmonicLaw>(&term.law);
    std::vector<Sample> samples;
    if (!harmonic) samples = samples_of(term.law, duration, parts, bounds);
    const double largest = harmonic ? std::abs(harmonic->amplitude) : largest_of(samples);
    if (!(largest > 0.0)) continue;
    force.setZero();
    for (std::size_t i = 0; i < term.rows.size(); ++i) force[term.rows[i]] += largest * term.weights[i];
    factor.solve(force, q);
    double size = norm(q);
    if (!(size > 0.0 && std::isfinite(size))) continue;
    const double omega_squared = force.dot(q) / (size * size);
    if (harmonic)
      size /= std::max(1.0, std::pow(harmonic->angular_frequency, 2) / omega_squared);
    else
      size *= std::min(1.0, largest_response(samples, std::sqrt(omega_squared)) / largest);
    squared += size * size;
  }
  return std::sqrt(squared);
}

}  // namespace rubato::integrate
