#include <rubato/integrate/constrained/first_zero.hpp>
#include <rubato/integrate/mechanism/mechanism_timeline.hpp>

#include <algorithm>
#include <cmath>

// Where the guards of a mechanism first pass zero within a step.
namespace rubato::integrate {
void MechanismTimeline::interpolate(const system::State& from, const system::State& to, double share,
                                    system::State& out) {
  const double h = to.t - from.t, rest = 1.0 - share;
  const double passed = share * share * (1.0 + 2.0 * rest), first = h * share * rest * rest,
               last = -h * share * share * rest;
  out = to;
  out.t = from.t + share * h;
  mechanism_.difference(from.q, to.q, out.v);
  mechanism_.retract(from.q, passed * out.v + first * from.v + last * to.v, out.q);
  out.v = rest * from.v + share * to.v;
  equations_.move_laws(from, out);
}

Crossing MechanismTimeline::first_passage(std::size_t i, const system::State& from, const system::State& to,
                                          double least, Look look) {
  const auto index = static_cast<Index>(i);
  const double a = guard_at(i, from, to.stuck_at).value, b = guard_at(i, to, to.stuck_at).value;
  if (look == Look::at_ends) return {index, first_zero(least, a, b - a, b, b - a).at};
  if (!has_halfway_) interpolate(from, to, 0.5, halfway_);
  has_halfway_ = true;
  const double middle = guard_at(i, halfway_, to.stuck_at).value;
  const double slope = 4.0 * middle - 3.0 * a - b, curvature = 4.0 * (a + b - 2.0 * middle);
  const double found = first_zero(least, a, slope, b, slope + curvature).at;
  const double turn = -slope / curvature, at_turn = a + 0.5 * slope * turn;
  const double seen = b < 0.0 ? 1.0 : middle < 0.0 ? 0.5 : std::clamp(turn, least, 1.0);
  constexpr double close = 0.1;
  const bool may_touch = curvature > 0.0 && turn > least && turn < std::min(found, 1.0) && a > 0.0;
  if (!may_touch || at_turn > close * std::max(a, b)) return {index, found, seen};
  interpolate(from, to, turn, turning_);
  const double there = guard_at(i, turning_, to.stuck_at).value;
  if (!(there < 0.0)) return {index, found, seen};
  return {index, std::max(least, turn * (1.0 - std::sqrt(-there / (a - there)))), turn};
}

Crossing MechanismTimeline::first_crossing(const system::State& from, const system::State& to, double least,
                                           Look look) {
  Crossing first;
  const double h = to.t - from.t;
  has_halfway_ = false;
  forget_balances();
  if (stands_.size() != mechanism_.model().drives.size()) note_standing_drives(from.t);
  for (std::size_t i = 0; i < row_.size() + from.rubbing.size(); ++i) {
    if (!is_watched(i, from)) continue;
    Crossing crossing;
    if (has_rate(i, from)) {
      const GuardValue a = guard_at(i, from, to.stuck_at);  // both ends by the floors of the step
      const GuardValue b = guard_at(i, to, to.stuck_at);
      if (i < row_.size() && from.phase[i] == model::lock_open) {
        // What rests at a lock that it has left, held by others, comes no nearer.
        const double nothing = no_way(mechanism_.model().locks[i].s, to);
        if (std::max({std::abs(a.value), std::abs(b.value), std::abs(h * a.rate), std::abs(h * b.rate)}) <= nothing)
          continue;
      }
      const double chord = b.value - a.value;
      const FirstZero zero = look == Look::at_ends ? first_zero(least, a.value, chord, b.value, chord)
                                                   : first_zero(least, a.value, h * a.rate, b.value, h * b.rate);
      crossing = {static_cast<Index>(i), zero.at, zero.seen};
    } else {
      crossing = first_passage(i, from, to, least, look);
    }
    if (crossing.share <= 1.0 && (first.guard < 0 || crossing.share < first.share)) first = crossing;
  }
  const auto take = [&](const Crossing& other, std::size_t before) {
    if (other.guard < 0 || (first.guard >= 0 && first.share <= other.share)) return;
    first = {static_cast<Index>(before) + other.guard, other.share};
  };
  if (watches_laws_) take(law_guards_.first_crossing(from, to, least), transitions_.size());
  if (watches_contacts_)
    take(law_guards_.first_touch(from, to, least), transitions_.size() + mechanism_.model().laws.size());
  return first;
}

}  // namespace rubato::integrate
