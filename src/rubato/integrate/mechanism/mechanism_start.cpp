#include <rubato/integrate/mechanism/mechanism_start.hpp>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

Index largest_of(const Vector& x, double& value) {
  if (x.size() == 0) return -1;
  Index place = 0;
  value = x.cwiseAbs().maxCoeff(&place);
  return place;
}

/// M and G at the state; its inverse is applied by equations.solve().
bool factorise_mass(system::MechanismEquations& equations, const system::State& state, model::Side side, Vector& force,
                    Vector& constraint) {
  equations.go_to(state, side);
  equations.linearise({1.0, 0.0, 0.0}, state.multiplier, force, constraint);
  return equations.factorise();
}

}  // namespace

bool find_acceleration(system::MechanismEquations& equations, system::State& state, model::Side side) {
  const auto& mechanism = equations.mechanism();
  Vector force(mechanism.size()), constraint(mechanism.constraint_count());
  if (!factorise_mass(equations, state, side, force, constraint)) return false;
  Vector rate(constraint.size()), product(force.size());
  equations.second_rate(rate);
  const Vector applied = force, wanted = rate;
  force = -force;
  rate = -rate;
  equations.solve(force, rate);
  state.acceleration = force;
  state.multiplier = rate;
  // The share of the multipliers in the constraint rows: one correction removes it.
  equations.constraints(constraint);
  mechanism.times_mass(state.acceleration, product);
  force = -(applied + product);
  equations.add_constraint_force(state.multiplier, -1.0, force);
  equations.constraint_rate(state.acceleration, rate);
  Vector explicit_rate(rate.size());
  equations.constraint_rate(Vector::Zero(force.size()), explicit_rate);
  rate = -(rate - explicit_rate + wanted);
  equations.solve(force, rate);
  state.acceleration += force;
  state.multiplier += rate;
  state.auxiliary_acceleration = state.acceleration;
  return state.acceleration.allFinite() && state.multiplier.allFinite();
}

ConsistentStart make_consistent(system::MechanismEquations& equations, system::State given, model::Side side) {
  const auto& mechanism = equations.mechanism();
  const Index n = mechanism.size(), c = mechanism.constraint_count();
  ConsistentStart result;
  result.state = std::move(given);
  system::State& state = result.state;
  state.multiplier.resize(c);
  state.multiplier.setZero();
  const Vector first = state.q, first_velocity = state.v;
  Vector force(n), constraint(c), moved(n), product(n), other = state.q;

  // Newton's method converges quadratically: a round beyond a small correction leaves round-off.
  constexpr int most_iterations = 50;
  const double extent = 1.0 + state.q.cwiseAbs().maxCoeff();
  double last_gap = HUGE_VAL;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!factorise_mass(equations, state, side, force, constraint)) return result;
    result.redundant = equations.redundant_rows();
    double gap = 0.0;
    result.worst_row = largest_of(constraint, gap);
    result.gap = gap;
    if (!std::isfinite(gap)) return result;
    if (gap <= 1e-15 * extent || (gap <= 1e-12 * extent && gap >= 0.5 * last_gap)) break;
    last_gap = gap;
    force.setZero();
    constraint = -constraint;
    equations.solve(force, constraint);
    mechanism.retract(state.q, force, other);
    std::swap(state.q, other);
  }
  if (!(result.gap <= 1e-10 * extent)) return result;
  result.is_assembled = true;
  mechanism.difference(first, state.q, moved);
  result.most_moved = largest_of(moved, result.position_moved);
  if (result.position_moved <= 1e-12 * extent) result.most_moved = -1;

  if (!factorise_mass(equations, state, side, force, constraint)) return result;
  mechanism.times_mass(state.v, product);
  const double before = 0.5 * state.v.dot(product);
  for (int round = 0; round < 2; ++round) {
    force.setZero();
    equations.constraint_rate(state.v, constraint);
    constraint = -constraint;
    equations.solve(force, constraint);
    state.v += force;
  }
  mechanism.times_mass(state.v, product);
  result.energy_lost = before - 0.5 * state.v.dot(product);
  result.most_changed = largest_of(state.v - first_velocity, result.velocity_changed);
  if (result.velocity_changed <= 1e-12 * (1.0 + first_velocity.cwiseAbs().maxCoeff())) result.most_changed = -1;
  result.is_consistent = find_acceleration(equations, state, side);
  return result;
}

void shift_acceleration(system::MechanismEquations& equations, system::State& state, double shifted_by) {
  if (shifted_by == 0.0) return;
  system::State ahead = state;
  ahead.t += shifted_by;
  equations.mechanism().retract(state.q, shifted_by * state.v + (0.5 * shifted_by * shifted_by) * state.acceleration,
                                ahead.q);
  ahead.v += shifted_by * state.acceleration;
  if (find_acceleration(equations, ahead, shifted_by > 0.0 ? model::Side::left : model::Side::right))
    state.auxiliary_acceleration = ahead.acceleration;
}

}  // namespace rubato::integrate
