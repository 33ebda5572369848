#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/integrate/constrained/first_zero.hpp>
#include <rubato/integrate/constrained/guard_timeline.hpp>

#include <rubato/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {

GuardTimeline::GuardTimeline(const system::OwnSystem& system, double resolution)
    : system_(system), equations_(system.equations()), resolution_(resolution), momentum_(system.size()) {}

std::vector<double> GuardTimeline::breakpoints(double from, double to) const {
  breakpoints_ = system_.breakpoints(from, to);
  return breakpoints_;
}

bool GuardTimeline::jumps_at(double t) {
  return std::any_of(breakpoints_.begin(), breakpoints_.end(),
                     [&](double breakpoint) { return std::abs(breakpoint - t) <= resolution_; });
}

bool GuardTimeline::restart(system::State& state) {
  close_gaps(*equations_, state, model::Side::right);
  return find_acceleration(*equations_, state, model::Side::right);
}

double GuardTimeline::kinetic_energy(const system::State& state) {
  system_.times_mass(state.v, momentum_);
  return 0.5 * state.v.dot(momentum_);
}

bool GuardTimeline::is_watched(const GuardValue& from) const {
  return from.value >= -resolution_ * std::abs(from.rate) || from.rate < 0.0;
}

GuardValue GuardTimeline::guard_at(Index guard, const system::State& state) const {
  const GuardValue value = system_.guard(guard, state);
  if (std::isfinite(value.value) && std::isfinite(value.rate)) return value;
  throw InvalidInput(fmt::format("guard {} of a system of one's own is {} with the rate {} at t = {} s", guard,
                                 value.value, value.rate, state.t));
}

Passage GuardTimeline::pass(const system::State& before, system::State& state, double shift) {
  bool has_jump = false;
  for (Index i = 0; i < system_.guard_count(); ++i) {
    const GuardValue from = guard_at(i, before), now = guard_at(i, state);
    if (!is_watched(from) || !(now.value <= resolution_ * std::abs(now.rate) && now.value <= from.value)) continue;
    if (from.value < -resolution_ * std::abs(from.rate)) return Passage::fails;  // it was missed
    const double energy = kinetic_energy(state);
    const Passage passage = system_.pass(i, state);
    if (passage == Passage::fails) return passage;
    events_.push_back({state.t, i, 0.0});
    if (passage == Passage::continues) continue;
    has_jump = true;
    const ConsistentStart consistent = make_consistent(*equations_, state, model::Side::right);
    if (!consistent.is_consistent) return Passage::fails;
    state = consistent.state;
    events_.back().energy_lost = energy - kinetic_energy(state);
  }
  close_gaps(*equations_, state, model::Side::right);
  if (!find_acceleration(*equations_, state, model::Side::right)) return Passage::fails;
  shift_acceleration(*equations_, state, shift);
  return has_jump ? Passage::restarts : Passage::continues;
}

Crossing GuardTimeline::first_crossing(const system::State& from, const system::State& to, double least, Look look) {
  Crossing first;
  const double h = to.t - from.t;
  for (Index i = 0; i < system_.guard_count(); ++i) {
    const GuardValue a = guard_at(i, from);
    if (!is_watched(a)) continue;
    const GuardValue b = guard_at(i, to);
    const double chord = b.value - a.value;
    const FirstZero zero = look == Look::at_ends ? first_zero(least, a.value, chord, b.value, chord)
                                                 : first_zero(least, a.value, h * a.rate, b.value, h * b.rate);
    if (zero.at <= 1.0 && (first.guard < 0 || zero.at < first.share)) first = {i, zero.at, zero.seen};
  }
  return first;
}

GuardValue GuardTimeline::guard(Index guard, const system::State&, const system::State& to) {
  return guard_at(guard, to);
}

}  // namespace rubato::integrate
