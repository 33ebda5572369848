#include <rubato/model/time_kinks.hpp>
#include <rubato/system/loads.hpp>

#include <algorithm>
#include <cmath>
#include <variant>

namespace rubato::system {
namespace {

bool joins(const model::HarmonicLaw& a, LoadTerm::Source source, const LoadTerm& b) {
  const auto* other = std::get_if<model::HarmonicLaw>(&b.law);
  return other && b.source == source && other->angular_frequency == a.angular_frequency && other->phase == a.phase;
}

}  // namespace

Loads::Loads(std::vector<LoadTerm> terms) {
  for (LoadTerm& term : terms) {
    auto* harmonic = std::get_if<model::HarmonicLaw>(&term.law);
    if (harmonic) {
      for (double& weight : term.weights) weight *= harmonic->amplitude;
      harmonic->amplitude = 1.0;
      const auto same = std::find_if(terms_.begin(), terms_.end(),
                                     [&](const LoadTerm& known) { return joins(*harmonic, term.source, known); });
      if (same != terms_.end()) {
        same->rows.insert(same->rows.end(), term.rows.begin(), term.rows.end());
        same->weights.insert(same->weights.end(), term.weights.begin(), term.weights.end());
        continue;
      }
    }
    terms_.push_back(std::move(term));
  }
}

bool Loads::are_harmonic() const {
  return std::all_of(terms_.begin(), terms_.end(),
                     [](const LoadTerm& term) { return std::holds_alternative<model::HarmonicLaw>(term.law); });
}

void Loads::evaluate(double t, Vector& f, model::Side side) const {
  evaluate_up_to(LoadTerm::Source::moving_support, t, f, side);
}

void Loads::evaluate_static(double t, Vector& f, model::Side side) const {
  evaluate_up_to(LoadTerm::Source::displaced_support, t, f, side);
}

void Loads::evaluate_forces(double t, Vector& f, model::Side side) const {
  evaluate_up_to(LoadTerm::Source::force, t, f, side);
}

void Loads::evaluate_up_to(LoadTerm::Source last, double t, Vector& f, model::Side side) const {
  f.setZero();
  for (const LoadTerm& term : terms_) {
    if (term.source > last) continue;
    const double now = model::value(term.law, t, side);
    for (std::size_t i = 0; i < term.rows.size(); ++i) f[term.rows[i]] += term.weights[i] * now;
  }
}

std::vector<double> Loads::breakpoints(double from, double to) const {
  std::vector<double> times, switches;
  for (const LoadTerm& term : terms_) {
    const model::Kinks kinks = model::kinks(term.law, from, to);
    times.insert(times.end(), kinks.rows.begin(), kinks.rows.end());
    switches.insert(switches.end(), kinks.switches.begin(), kinks.switches.end());
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::sort(switches.begin(), switches.end());
  numerics::add_switches(switches, from, to, times);
  return times;
}

}  // namespace rubato::system
