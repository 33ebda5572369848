#include <rubato/integrate/pressed_motion.hpp>

#include <algorithm>

namespace rubato::integrate {

model::LawPoint PressedMotion::at(Index law, const system::State& from, const system::State& to, double share) {
  return going_on(law, from, to, share, 0.0);
}

model::LawPoint PressedMotion::going_on(Index law, const system::State& from, const system::State& to, double share,
                                        double moment) {
  const Place there = place(system_.first_law() + law, from, to, share);
  const Pressing pressed = pressing(law, from, to, share);
  model::LawPoint point;
  point.u = there.u;
  point.rate = there.rate + moment * there.acceleration;
  point.t = from.t + share * (to.t - from.t);
  point.side = share > 0.0 ? model::Side::left : model::Side::right;
  point.normal = pressed.value;
  point.normal_rate = pressed.rate + moment * pressed.second_rate;
  return point;
}

PressedMotion::Place PressedMotion::place(Index contact, const system::State& from, const system::State& to,
                                          double share) const {
  const double h = to.t - from.t, s = share, r = 1.0 - s;
  const double u0 = system_.relative_displacement(contact, from.q), v0 = system_.relative_displacement(contact, from.v);
  const double a0 = system_.relative_displacement(contact, from.auxiliary_acceleration);
  if (s == 0.0) return {u0, v0, a0};
  const double u1 = system_.relative_displacement(contact, to.q), v1 = system_.relative_displacement(contact, to.v);
  // Of displacements a short step would leave nothing but round-off: the velocity is the parabola that begins with a0.
  const double acceleration = r * a0 + s * (2.0 * (v1 - v0) / h - a0);
  return {r * r * (1.0 + 2.0 * s) * u0 + s * s * (3.0 - 2.0 * s) * u1 + h * s * r * (r * v0 - s * v1),
          6.0 * s * r * (u1 - u0) / h + r * (1.0 - 3.0 * s) * v0 + s * (3.0 * s - 2.0) * v1, acceleration};
}

PressedMotion::Pressing PressedMotion::pressing(Index law, const system::State& from, const system::State& to,
                                                double share) {
  const model::LawBetween& pressed = system_.laws()[static_cast<std::size_t>(law)];
  const model::NormalForce& normal = pressed.normal;
  if (!pressed.law->takes_normal()) return {0.0, 0.0, 0.0};
  if (normal.stop >= 0) return of_stop(normal.stop, place(system_.slider_count() + normal.stop, from, to, share));
  if (normal.law >= 0) return of_law(normal.law, from, to, share);
  return of_formula(normal, from.t + share * (to.t - from.t), share == 0.0);
}

PressedMotion::Pressing PressedMotion::of_formula(const model::NormalForce& normal, double t, bool is_start) const {
  if (!normal.formula) return {normal.value, 0.0, 0.0};
  const numerics::TimeDerivatives d =
      is_start ? normal.formula->derivatives_from_right(t) : normal.formula->derivatives_from_left(t);
  return {d.value, d.rate, d.second_rate};
}

// As LocallyNonlinear::normal_force: without a force it is how far apart the ends are, as a force of its spring.
PressedMotion::Pressing PressedMotion::of_stop(Index j, const Place& place) const {
  const model::Stop& stop = system_.stops()[static_cast<std::size_t>(j)];
  const double spring = stop.stiffness * (place.u - stop.gap), force = spring + stop.damping * place.rate;
  if (spring > 0.0 && force > 0.0)
    return {force, stop.stiffness * place.rate + stop.damping * place.acceleration,
            stop.stiffness * place.acceleration};
  return {std::min(0.0, spring), stop.stiffness * place.rate, stop.stiffness * place.acceleration};
}

PressedMotion::Pressing PressedMotion::of_law(Index law, const system::State& from, const system::State& to,
                                              double share) {
  const model::Law& pressing = *system_.laws()[static_cast<std::size_t>(law)].law;
  const Index memory = system_.memory_of(law);
  const model::LawPoint there = at(law, from, to, share);
  const model::LawAnswer answer = share == 0.0 ? pressing.at(there, from.memory.data() + memory)
                                               : pressing.advance(at(law, from, to, 0.0), from.memory.data() + memory,
                                                                  there, next_.data() + memory);
  const double acceleration = place(system_.first_law() + law, from, to, share).acceleration;
  return {answer.force, answer.by_u * there.rate + answer.by_rate * acceleration + answer.by_normal * there.normal_rate,
          answer.by_u * acceleration};
}

}  // namespace rubato::integrate
