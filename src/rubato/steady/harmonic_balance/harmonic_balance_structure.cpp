#include <rubato/core/stopping.hpp>
#include <rubato/steady/harmonic_balance/harmonic_balance_parts.hpp>

#include <algorithm>
#include <cmath>

// The loads on the structure, and what it answers to them and to its sliders.
namespace rubato::steady {
namespace {

using Outcome = CondensedStructure::Outcome;

constexpr Index most_patterns = 32;   // of loads, before those of old points are forgotten
constexpr int most_left_out = 8;      // orders that the error estimate looks at
constexpr Index largest_cheap = 200;  // coordinates of a structure whose orders cost little to condense
constexpr double held_part = 0.5;     // of the sliders' springs, where the structure alone is near a resonance

}  // namespace

void HarmonicBalanceSolver::Implementation::take_loads(const system::Excitation& excitation) {
  const auto same = [&] {
    if (loads.empty() || last_loads.harmonics.size() != excitation.harmonics.size() ||
        last_loads.constant.size() != excitation.constant.size() || last_loads.constant != excitation.constant)
      return false;
    for (std::size_t i = 0; i < excitation.harmonics.size(); ++i)
      if (last_loads.harmonics[i].order != excitation.harmonics[i].order ||
          last_loads.harmonics[i].amplitude != excitation.harmonics[i].amplitude)
        return false;
    return true;
  };
  if (same()) return;
  for (auto& harmonic : harmonics) harmonic.load.resize(0);

  // Adds what the patterns lack of a vector, orthonormal.
  bool has_grown = false;
  const auto cover = [&](Vector rest) {
    const double size = rest.norm();
    if (size == 0.0) return;
    for (int pass = 0; pass < 2; ++pass) rest -= patterns * (patterns.transpose() * rest);
    if (!(rest.norm() > 1e-13 * size)) return;
    patterns.conservativeResize(Eigen::NoChange, patterns.cols() + 1);
    patterns.col(patterns.cols() - 1) = rest.normalized();
    has_grown = true;
  };
  const auto cover_all = [&] {
    if (excitation.constant.size() > 0) cover(excitation.constant);
    for (const system::LoadHarmonic& h : excitation.harmonics) {
      cover(h.amplitude.real());
      cover(h.amplitude.imag());
    }
  };
  cover_all();
  if (patterns.cols() > most_patterns && has_grown) {
    patterns.resize(system.size(), 0);
    cover_all();
  }
  if (has_grown || structure.load_count() != patterns.cols()) {
    structure.set_loads(patterns);
    harmonics.clear();
  }
  loads.clear();
  if (excitation.constant.size() > 0)
    loads.emplace_back(0, (patterns.transpose() * excitation.constant).cast<Complex>());
  else
    loads.emplace_back(0, ComplexVector::Zero(patterns.cols()));
  for (const system::LoadHarmonic& h : excitation.harmonics)
    loads.emplace_back(h.order, patterns.transpose().cast<Complex>() * h.amplitude);
  last_loads = excitation;
}

void HarmonicBalanceSolver::Implementation::load_on(int order, ComplexVector& load) const {
  load.setZero(patterns.cols());
  for (const auto& [k, shares] : loads)
    if (k == order) load = shares;
}

bool HarmonicBalanceSolver::Implementation::condense_one(CondensedHarmonic& harmonic, double angular_frequency,
                                                         int order) {
  stop_if_asked();
  const bool is_condensed = harmonic.angular_frequency == angular_frequency;
  if (!is_condensed) {
    harmonic.held = 0.0;
    harmonic.angular_frequency = -1.0;
    Outcome outcome = structure.condense(angular_frequency, 0.0, harmonic.receptance);
    if (outcome == Outcome::near_resonance || outcome == Outcome::sliders_needed) {
      const ComplexMatrix alone = harmonic.receptance;
      const bool is_usable_alone = outcome == Outcome::near_resonance;
      for (const double held : {held_part, 0.37 * held_part}) {
        outcome = structure.condense(angular_frequency, held, harmonic.receptance);
        harmonic.held = held;
        if (outcome == Outcome::regular) break;
      }
      if (is_usable_alone && outcome != Outcome::regular) {
        harmonic.receptance = alone;
        harmonic.held = 0.0;
      }
      if (is_usable_alone || outcome == Outcome::near_resonance) outcome = Outcome::regular;
    }
    if (outcome != Outcome::regular) return false;
    harmonic.angular_frequency = angular_frequency;
  }
  const bool has_load = harmonic.load.size() == patterns.cols();
  if (!has_load) load_on(order, harmonic.load);
  if (!is_condensed || !has_load)
    harmonic.linear = harmonic.receptance.rightCols(patterns.cols()).lazyProduct(harmonic.load);
  return true;
}

bool HarmonicBalanceSolver::Implementation::is_driven_beyond_friction(const system::Excitation& excitation) {
  if (has_laws()) return false;  // they may bound the motion
  if (!resonance) resonance.emplace(system);
  return resonance->is_driven_beyond_friction(excitation);
}

bool HarmonicBalanceSolver::Implementation::condense(const system::Excitation& excitation, int stride, int places,
                                                     bool with_mean) {
  if (stride != harmonics_stride) harmonics.clear();
  harmonics_stride = stride;
  if (static_cast<int>(harmonics.size()) < places + 1) harmonics.resize(static_cast<std::size_t>(places) + 1);
  const auto need = [&](std::size_t place, int order) {
    const double w = order * excitation.angular_frequency;
    CondensedHarmonic& harmonic = harmonics[place];
    if (!condense_one(harmonic, w, order)) return false;
    return !(harmonic.held > 0.0 && !harmonic.load.isZero(0.0) && is_driven_beyond_friction(excitation));
  };
  if (with_mean && !need(0, 0)) return false;
  for (int i = 0; i < places; ++i)
    if (!need(static_cast<std::size_t>(i) + 1, 1 + stride * i)) return false;
  return true;
}

// How many orders beyond those kept the error estimate must see: about as many again (forces of sliders that slip most
// of the period fall slowly), the third harmonic of every load, and all orders that may resonate.
int HarmonicBalanceSolver::Implementation::orders_to_probe(const system::Excitation& excitation,
                                                           const Orders& orders) const {
  int load = 1;
  for (const system::LoadHarmonic& h : excitation.harmonics) load = std::max(load, h.order);
  // The next odd order at least: a loop about a displaced middle has no even ones. A large structure pays each order
  // with a factorisation.
  const int least = orders.stride == 1 ? 2 : 1;
  int probes = system.size() > largest_cheap && highest_frequency == 0.0 ? least : orders.count + least;
  const auto highest = [&] { return orders.at(orders.count + probes - 1); };
  while (highest() < 3 * load) ++probes;
  while (probes < most_left_out && highest() * excitation.angular_frequency < highest_frequency) ++probes;
  return probes;
}

}  // namespace rubato::steady
