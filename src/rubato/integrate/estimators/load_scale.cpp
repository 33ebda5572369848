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

/// A force at times within the march, where it swings, and at its kinks, on both sides of a jump.
/// @param value  of t and the side of a limit
template <class Value>
std::vector<Sample> samples_of(Value&& value, const std::vector<double>& kinks, double duration, int parts,
                               const std::vector<numerics::StepBound>& bounds) {
  std::vector<double> times;
  times.push_back(0.0);
  add_times(0.0, duration, parts, times);
  times.push_back(duration);
  add_swings(bounds, duration / parts, 4.0 * parts, times);
  times.insert(times.end(), kinks.begin(), kinks.end());
  std::sort(times.begin(), times.end());
  std::vector<Sample> samples;
  for (const double t : times)
    for (const model::Side side : {model::Side::left, model::Side::right}) {
      const double force = value(t, side);
      samples.push_back({t, std::isfinite(force) ? force : 0.0});
    }
  return samples;
}

std::vector<Sample> samples_of(const model::TimeLaw& load, double duration, int parts,
                               const std::vector<numerics::StepBound>& bounds) {
  const model::Kinks kinks = model::kinks(load, 0.0, duration);
  std::vector<double> times = kinks.rows;
  times.insert(times.end(), kinks.switches.begin(), kinks.switches.end());
  return samples_of([&](double t, model::Side side) { return model::value(load, t, side); }, times, duration, parts,
                    std::holds_alternative<model::TableLaw>(load) ? std::vector<numerics::StepBound>{} : bounds);
}

/// What a law that depends on time does where nothing moves.
std::vector<Sample> samples_of(const model::Law& law, double duration, int parts,
                               const std::vector<numerics::StepBound>& bounds) {
  const std::vector<double> memory(static_cast<std::size_t>(law.memory_size()), 0.0);
  return samples_of(
      [&](double t, model::Side side) {
        return law.at({0.0, 0.0, t, side}, memory.data()).force;
      },
      law.breakpoints(0.0, duration), duration, parts, bounds);
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
  std::vector<std::size_t> laws;               // of time
  for (std::size_t j = 0; j < system.laws().size(); ++j)
    if (system.laws()[j].law->depends_on_time()) laws.push_back(j);
  if (loads.terms().empty() && laws.empty()) return 0.0;
  numerics::OrderedFactor factor;
  const SparseMatrix stiffness = SparseMatrix(system.stuck_stiffness() + 1.0 / duration * system.damping()) +
                                 2.0 / (duration * duration) * system.mass();
  factor.analyse(stiffness, {});
  if (!factor.factorise(stiffness)) return 0.0;  // a stiffness that is not one: nothing is promised
  MassNorm norm(system);
  double squared = 0.0;
  // Enough for one load, and not too many for thousands.
  const int parts = static_cast<int>(std::max<std::size_t>(64, 4096 / (loads.terms().size() + laws.size())));
  Vector force(system.size()), q(system.size());
  // Of what acts with its largest value as `force` says.
  const auto add = [&](auto&& reached) {
    factor.solve(force, q);
    const double held = norm(q);
    if (!(held > 0.0 && std::isfinite(held))) return;
    const double size = reached(held, force.dot(q) / (held * held));
    squared += size * size;
  };
  const auto under = [](const std::vector<Sample>& samples, double largest) {
    return [&samples, largest](double size, double omega_squared) {
      return size * std::min(1.0, largest_response(samples, std::sqrt(omega_squared)) / largest);
    };
  };
  for (const auto& term : loads.terms()) {
    const auto* harmonic = std::get_if<model::HarmonicLaw>(&term.law);
    std::vector<Sample> samples;
    if (!harmonic) samples = samples_of(term.law, duration, parts, bounds);
    const double largest = harmonic ? std::abs(harmonic->amplitude) : largest_of(samples);
    if (!(largest > 0.0)) continue;
    force.setZero();
    for (std::size_t i = 0; i < term.rows.size(); ++i) force[term.rows[i]] += largest * term.weights[i];
    if (harmonic)
      add([&](double size, double omega_squared) {
        return size / std::max(1.0, std::pow(harmonic->angular_frequency, 2) / omega_squared);
      });
    else
      add(under(samples, largest));
  }
  for (const std::size_t j : laws) {
    const auto samples = samples_of(*system.laws()[j].law, duration, parts, bounds);
    const double largest = largest_of(samples);
    if (!(largest > 0.0)) continue;
    force.setZero();
    for (const auto& [place, weight] : system.column(system.first_law() + static_cast<Index>(j)))
      force[place] -= weight * largest;
    add(under(samples, largest));
  }
  return std::sqrt(squared);
}

}  // namespace rubato::integrate
