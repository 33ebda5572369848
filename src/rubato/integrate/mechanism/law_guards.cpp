#include <rubato/integrate/mechanism/law_guards.hpp>
#include <rubato/model/laws/law_resolution.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

namespace rubato::integrate {
namespace {

model::Side side_at(double share) { return share > 0.0 ? model::Side::left : model::Side::right; }

}  // namespace

LawGuards::LawGuards(const model::Mechanism& mechanism, Index size, double resolution)
    : mechanism_(mechanism),
      resolution_(resolution),
      start_velocity_(static_cast<std::size_t>(size) + 1, 0.0),
      end_velocity_(start_velocity_),
      next_(static_cast<std::size_t>(mechanism.law_memory_size), 0.0) {}

void LawGuards::follow(const system::State& from, const system::State& to) {
  from_ = &from;
  to_ = &to;
  std::copy(from.v.data(), from.v.data() + from.v.size(), start_velocity_.data() + 1);
  std::copy(to.v.data(), to.v.data() + to.v.size(), end_velocity_.data() + 1);
  start_.q = from.q.data();
  start_.v = start_velocity_.data() + 1;
  end_.q = to.q.data();
  end_.v = end_velocity_.data() + 1;
}

template <class Coordinate>
LawGuards::Place LawGuards::place(const Coordinate& u, double share) const {
  const auto number = [&](const model::Motion& motion) {
    return std::visit([&](const auto& of) { return of.value(motion.q); }, u);
  };
  const auto rate = [&](const model::Motion& motion) {
    return std::visit([&](const auto& of) { return of.rate(motion); }, u);
  };
  const CubicPath path{to_->t - from_->t, number(start_), rate(start_), number(end_), rate(end_)};
  return path.at(share);
}

model::LawPoint LawGuards::at(const model::MechanismLaw& law, double share) {
  const Place there = place(law.u, share);
  const Pressing pressed = pressing(law, share, side_at(share));
  return {there.u, there.rate, from_->t + share * (to_->t - from_->t), side_at(share), pressed.value, pressed.rate};
}

/// The same place as it goes on from there, with the rates that are reached a moment later [s]: of what rests they say
/// how it goes on.
model::LawPoint LawGuards::going_on(const model::MechanismLaw& law, double share, double moment) {
  const double h = to_->t - from_->t;
  Place there = place(law.u, share);
  Pressing pressed = pressing(law, share, model::Side::right);
  there.rate += moment * there.acceleration;
  constexpr double little = 0.01;  // of the step: a force that begins later in it says nothing here
  const bool is_late = share > 0.5;
  if (law.normal.depends_on_motion() || law.reaction.presses()) {
    const double beside = is_late ? share - little : share + little;
    const double change = pressing(law, beside, is_late ? model::Side::left : model::Side::right).rate - pressed.rate;
    pressed.rate += moment * (is_late ? -change : change) / (little * h);
  } else {
    pressed.rate += moment * pressed.second_rate;
  }
  return {there.u, there.rate, from_->t + share * h, model::Side::right, pressed.value, pressed.rate};
}

LawGuards::Pressing LawGuards::pressing(const model::MechanismLaw& law, double share, model::Side side) {
  if (!law.law->takes_normal()) return {0.0, 0.0, 0.0};
  if (law.stop) {
    const auto index = static_cast<std::size_t>(law.normal.stop);
    const system::State& state = share > 0.5 ? *to_ : *from_;
    return of_stop(*law.stop, state.phase[index] != model::lock_open, place(law.stop->s.of, share));
  }
  if (law.pressing) return of_law(*law.pressing, share, side);
  if (law.reaction.presses()) return of_reaction(law.reaction, share);
  if (!law.normal.formula) return {law.normal.value, 0.0, 0.0};
  const double t = from_->t + share * (to_->t - from_->t);
  const numerics::TimeDerivatives d = side == model::Side::right ? law.normal.formula->derivatives_from_right(t)
                                                                 : law.normal.formula->derivatives_from_left(t);
  return {d.value, d.rate, d.second_rate};
}

// As model::pressing_force.
LawGuards::Pressing LawGuards::of_stop(const model::Lock& stop, bool is_engaged, const Place& place) const {
  const double spring = stop.stiffness * stop.sign * (place.u - stop.at);
  const double spring_rate = stop.stiffness * stop.sign * place.rate;
  if (!is_engaged) return {std::min(0.0, spring), spring_rate, 0.0};
  return {spring + stop.damping * stop.sign * place.rate, spring_rate + stop.damping * stop.sign * place.acceleration,
          0.0};
}

// Of the multipliers of both ends, as the step has them.
LawGuards::Pressing LawGuards::of_reaction(const model::PressingReaction& reaction, double share) const {
  const double h = to_->t - from_->t;
  double then = 0.0, now = 0.0;
  for (int r = 0; r < reaction.rows; ++r) {
    const Index row = reaction.multiplier + r;
    const double lag = from_->reaction_lag.size() > row ? h * from_->reaction_lag[row] : 0.0;
    then += std::pow(from_->multiplier[row] + lag, 2);
    now += std::pow(to_->multiplier[row] + lag, 2);
  }
  then = std::sqrt(then);
  now = std::sqrt(now);
  return {then + share * (now - then), (now - then) / h, 0.0};
}

LawGuards::Pressing LawGuards::of_law(const model::MechanismLaw& law, double share, model::Side side) {
  const model::LawPoint start = at(law, 0.0);
  model::LawPoint there = at(law, share);
  there.side = side;
  const double* const memory = from_->memory.data() + law.memory;
  const auto answer_at = [&](const model::LawPoint& point) {
    return share == 0.0 ? law.law->at(point, memory)
                        : law.law->advance(start, memory, point, next_.data() + law.memory);
  };
  const model::LawAnswer answer = answer_at(there);
  double rate = answer.by_u * there.rate + answer.by_rate * place(law.u, share).acceleration +
                answer.by_normal * there.normal_rate;
  if (law.law->depends_on_time()) {
    // On the side that counts: beyond it the law may go by another formula.
    const double moment = std::max(1e-3 * (to_->t - from_->t), 1e-8 * std::abs(there.t));
    const double sign = side == model::Side::right ? 1.0 : -1.0;
    model::LawPoint beside = there;
    beside.t += sign * moment;
    rate += sign * (answer_at(beside).force - answer.force) / moment;
  }
  return {answer.force, rate, 0.0};
}

double LawGuards::value(const model::MechanismLaw& law, double share) {
  const double* const memory = from_->memory.data() + law.memory;
  const double near = 2.0 * resolution_;
  if (law.law->takes_normal()) return law.law->guard(going_on(law, 0.0, near), memory, at(law, share), near);
  // A travel of round-off turns at random.
  constexpr double round_off = 64.0 * std::numeric_limits<double>::epsilon();
  const Place begin = place(law.u, 0.0), end = place(law.u, 1.0);
  const double size = law.is_angle() ? 1.0 + std::abs(begin.u) : from_->q.cwiseAbs().maxCoeff();
  if (std::abs(end.u - begin.u) + (to_->t - from_->t) * std::abs(end.rate) <= round_off * size) return 1.0;
  model::LawPoint start = at(law, 0.0);
  if (std::abs(start.rate) <= near * std::abs(begin.acceleration))
    start.rate = std::copysign(std::numeric_limits<double>::min(), begin.acceleration);
  return law.law->guard(start, memory, at(law, share), near);
}

double LawGuards::unresolved(const system::State& from, const system::State& to) {
  double largest = 0.0;
  bool has_followed = false;
  for (const model::MechanismLaw& law : mechanism_.laws) {
    const auto* resolution = dynamic_cast<const model::LawResolution*>(law.law.get());
    if (!resolution) continue;
    if (!has_followed) follow(from, to);
    has_followed = true;
    largest = std::max(largest, resolution->unresolved(at(law, 0.0), at(law, 1.0)));
  }
  return largest;
}

GuardValue LawGuards::guard(Index law, const system::State& from, const system::State& to) {
  follow(from, to);
  const model::MechanismLaw& watched = mechanism_.laws[static_cast<std::size_t>(law)];
  constexpr double least = 1e-4;  // of the step, for the slope of the guard at its end
  const double end = value(watched, 1.0);
  return {end, (end - value(watched, 1.0 - least)) / (least * (to.t - from.t))};
}

Crossing LawGuards::first_crossing(const system::State& from, const system::State& to, double least) {
  follow(from, to);
  Crossing first;
  first.share = HUGE_VAL;
  for (const model::MechanismLaw& law : mechanism_.laws) {
    if (!(value(law, 1.0) < 0.0)) continue;
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (value(law, middle) > 0.0 ? low : high) = middle;
    }
    if (high >= least && high < first.share) first = {law.index, high};
  }
  return first;
}

GuardValue LawGuards::Pressed::at(double share) const {
  const CubicPath::Place now = depth.at(share);
  if (now.rate >= 0.0 || delay == 0.0) return {now.u, now.rate};
  return {now.u + delay * now.rate, now.rate + delay * now.acceleration};
}

LawGuards::Pressed LawGuards::pressed(const model::MechanismContact& contact) const {
  const model::ContactNumber& across = contact.numbers.back();
  const double gap = contact.law->clearance();
  const CubicPath depth{to_->t - from_->t, across.value(start_.q) - gap, across.rate(start_),
                        across.value(end_.q) - gap, across.rate(end_)};
  return {depth, contact.law->closed_damping() / contact.law->limit_stiffness(contact.law->size() - 1, true)};
}

double LawGuards::side(const Pressed& pressed) const {
  const GuardValue begin = pressed.at(0.0);
  const bool is_at_zero = std::abs(begin.value) <= 2.0 * resolution_ * std::abs(begin.rate);
  return (is_at_zero ? begin.rate : begin.value) > 0.0 ? 1.0 : -1.0;
}

GuardValue LawGuards::until_change(const Pressed& pressed, double sign, double share) const {
  const GuardValue now = pressed.at(share);
  if (sign > 0.0) return now;
  return {resolution_ * std::abs(now.rate) - now.value, -now.rate};
}

Crossing LawGuards::first_touch(const system::State& from, const system::State& to, double least) {
  follow(from, to);
  Crossing first;
  first.share = HUGE_VAL;
  for (const model::MechanismContact& contact : mechanism_.contacts) {
    const Pressed path = pressed(contact);
    const double sign = side(path);
    if (!(until_change(path, sign, 1.0).value < 0.0)) continue;
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (until_change(path, sign, middle).value > 0.0 ? low : high) = middle;
    }
    if (high >= least && high < first.share) first = {contact.index, high};
  }
  return first;
}

GuardValue LawGuards::touch(Index contact, const system::State& from, const system::State& to) {
  follow(from, to);
  const Pressed path = pressed(mechanism_.contacts[static_cast<std::size_t>(contact)]);
  return until_change(path, side(path), 1.0);
}

bool LawGuards::hits_a_dashpot(const system::State& from, const system::State& to) {
  follow(from, to);
  for (const model::MechanismContact& contact : mechanism_.contacts) {
    if (contact.law->closed_damping() == 0.0) continue;
    const Pressed path = pressed(contact);
    const GuardValue end = path.at(1.0);
    if (side(path) < 0.0 && end.value >= 0.0 && end.value <= 4.0 * resolution_ * end.rate) return true;
  }
  return false;
}

bool LawGuards::stood_at_change(Index contact, const system::State& from, const system::State& to) {
  follow(from, to);
  const GuardValue begin = pressed(mechanism_.contacts[static_cast<std::size_t>(contact)]).at(0.0);
  return std::abs(begin.value) <= 2.0 * resolution_ * std::abs(begin.rate);
}

model::Law::Contact LawGuards::contact(Index law, const system::State& before, const system::State& after,
                                       bool at_end) {
  follow(before, after);
  const model::MechanismLaw& watched = mechanism_.laws[static_cast<std::size_t>(law)];
  const system::State& state = at_end ? after : before;
  const double near = 2.0 * resolution_;
  return watched.law->contact(going_on(watched, at_end ? 1.0 : 0.0, near), state.memory.data() + watched.memory, near);
}

}  // namespace rubato::integrate
