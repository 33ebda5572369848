#include <rubato/integrate/pressed_motion.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {

model::LawPoint PressedMotion::at(Index law, const system::State& from, const system::State& to, double share) {
  const Place there = place(system_.first_law() + law, from, to, share);
  const Pressing pressed = pressing(law, from, to, share, side_at(share));
  return point_of(there, pressed, from.t + share * (to.t - from.t), side_at(share));
}

model::LawPoint PressedMotion::going_on(Index law, const system::State& from, const system::State& to, double share,
                                        double moment) {
  const double h = to.t - from.t;
  Place there = place(system_.first_law() + law, from, to, share);
  Pressing pressed = pressing(law, from, to, share, model::Side::right);
  there.rate += moment * there.acceleration;
  const model::NormalForce& normal = system_.laws()[static_cast<std::size_t>(law)].normal;
  constexpr double little = 0.01;  // of the step: a force that begins later in it says nothing here
  const bool is_late = share > 0.5;
  if (normal.depends_on_motion()) {
    const double beside = is_late ? share - little : share + little;
    const double change =
        pressing(law, from, to, beside, is_late ? model::Side::left : model::Side::right).rate - pressed.rate;
    pressed.rate += moment * (is_late ? -change : change) / (little * h);
  } else {
    pressed.rate += moment * pressed.second_rate;
  }
  return point_of(there, pressed, from.t + share * h, model::Side::right);
}

model::LawPoint PressedMotion::point_of(const Place& place, const Pressing& pressing, double t, model::Side side) {
  model::LawPoint point;
  point.u = place.u;
  point.rate = place.rate;
  point.t = t;
  point.side = side;
  point.normal = pressing.value;
  point.normal_rate = pressing.rate;
  return point;
}

PressedMotion::Place PressedMotion::place(Index contact, const system::State& from, const system::State& to,
                                          double share) const {
  const CubicPath path{to.t - from.t, system_.relative_displacement(contact, from.q),
                       system_.relative_displacement(contact, from.v), system_.relative_displacement(contact, to.q),
                       system_.relative_displacement(contact, to.v)};
  return path.at(share);
}

PressedMotion::Pressing PressedMotion::pressing(Index law, const system::State& from, const system::State& to,
                                                double share, model::Side side) {
  const model::LawBetween& pressed = system_.laws()[static_cast<std::size_t>(law)];
  const model::NormalForce& normal = pressed.normal;
  if (!pressed.law->takes_normal()) return {0.0, 0.0, 0.0};
  if (normal.stop >= 0) return of_stop(normal.stop, place(system_.slider_count() + normal.stop, from, to, share));
  if (normal.law >= 0) return of_law(normal.law, from, to, share, side);
  return of_formula(normal, from.t + share * (to.t - from.t), side);
}

PressedMotion::Pressing PressedMotion::of_formula(const model::NormalForce& normal, double t, model::Side side) const {
  if (!normal.formula) return {normal.value, 0.0, 0.0};
  const numerics::TimeDerivatives d =
      side == model::Side::right ? normal.formula->derivatives_from_right(t) : normal.formula->derivatives_from_left(t);
  return {d.value, d.rate, d.second_rate};
}

// As LocallyNonlinear::normal_force: without a force it is how far apart the ends are, as a force of its spring.
PressedMotion::Pressing PressedMotion::of_stop(Index j, const Place& place) const {
  const model::Stop& stop = system_.stops()[static_cast<std::size_t>(j)];
  const double spring = stop.stiffness * (place.u - stop.gap), force = spring + stop.damping * place.rate;
  if (spring > 0.0 && force > 0.0) return {force, stop.stiffness * place.rate + stop.damping * place.acceleration, 0.0};
  return {std::min(0.0, spring), stop.stiffness * place.rate, 0.0};
}

PressedMotion::Pressing PressedMotion::of_law(Index law, const system::State& from, const system::State& to,
                                              double share, model::Side side) {
  const model::Law& pressing = *system_.laws()[static_cast<std::size_t>(law)].law;
  const Index memory = system_.memory_of(law);
  model::LawPoint start = at(law, from, to, 0.0), there = at(law, from, to, share);
  there.side = side;
  const auto answer_at = [&](const model::LawPoint& point) {
    return share == 0.0 ? pressing.at(point, from.memory.data() + memory)
                        : pressing.advance(start, from.memory.data() + memory, point, next_.data() + memory);
  };
  const model::LawAnswer answer = answer_at(there);
  const double acceleration = place(system_.first_law() + law, from, to, share).acceleration;
  double rate = answer.by_u * there.rate + answer.by_rate * acceleration + answer.by_normal * there.normal_rate;
  if (pressing.depends_on_time()) {
    // On the side that counts: beyond it the law may go by another formula.
    const double moment = std::max(1e-3 * (to.t - from.t), 1e-8 * std::abs(there.t));
    model::LawPoint beside = there;
    const double sign = side == model::Side::right ? 1.0 : -1.0;
    beside.t += sign * moment;
    rate += sign * (answer_at(beside).force - answer.force) / moment;
  }
  return {answer.force, rate, 0.0};
}

}  // namespace rubato::integrate
