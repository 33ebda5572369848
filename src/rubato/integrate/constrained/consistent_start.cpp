#include <rubato/integrate/constrained/consistent_start.hpp>
#include <rubato/numerics/newton.hpp>

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

double largest_magnitude(const Vector& x) { return x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0.0; }

/// M and G at the state; its inverse is applied by equations.solve().
/// @param friction  with the slopes of the friction that reactions make: for accelerations, not for projections
bool factorise_mass(system::ConstrainedEquations& equations, const system::State& state, model::Side side,
                    Vector& force, Vector& constraint, bool friction = false) {
  equations.go_to(state, side);
  equations.linearise({1.0, 0.0, 0.0, 0.0, friction}, state.multiplier, force, constraint);
  return equations.factorise();
}

/// Acceleration and multipliers of equilibrium as Newton's method sees them. Friction mu |multiplier| is homogeneous in
/// the multipliers: its slopes at one guess give all of the next, and without it the first correction is the last.
struct Balancing : numerics::NewtonProblem {
  Balancing(system::ConstrainedEquations& equations_, system::State& state_, model::Side side_, bool stands_)
      : equations(equations_),
        of(equations_.system()),
        state(state_),
        side(side_),
        stands(stands_),
        applied(of.size()),
        force(of.size()),
        product(of.size()),
        wanted(of.constraint_count()),
        rate(wanted.size()),
        explicit_rate(wanted.size()) {}

  double evaluate(bool /*with_tangent*/) {
    equations.go_to(state, side);
    equations.linearise({1.0, 0.0, 0.0, 0.0, true}, state.multiplier, applied, wanted);
    return 0.0;
  }

  bool factorise() { return equations.factorise(); }

  double correct() {
    if (stands)
      wanted.setZero();
    else
      equations.second_rate(wanted);
    force = -applied;
    rate = -wanted;
    equations.solve(force, rate);
    return force.norm() + rate.norm();
  }

  void move(double /*part*/) {
    last = state.multiplier;
    state.acceleration = force;
    state.multiplier = rate;
  }

  numerics::NewtonVerdict judge(const numerics::NewtonIteration&) {
    const bool is_linear = !equations.has_sliding_reactions();
    // The share of the multipliers in the constraint rows: one correction removes it.
    of.times_mass(state.acceleration, product);
    force = -(applied + product);
    equations.add_constraint_force(state.multiplier, -1.0, force);
    equations.constraint_rate(state.acceleration, rate);
    equations.constraint_rate(Vector::Zero(force.size()), explicit_rate);
    rate = -(rate - explicit_rate + wanted);
    equations.solve(force, rate);
    if (!force.allFinite() || !rate.allFinite()) return numerics::NewtonVerdict::stop;
    // What is left of the equations tells the end: of a reaction that turned round the correction is by the old slope,
    // and could lead back. One in every row, as of a share, stays where the slopes no longer change.
    const double size = state.multiplier.norm();
    const bool is_solved = is_linear || rate.norm() <= 1e-8 * size || (state.multiplier - last).norm() <= 1e-12 * size;
    if (!is_solved) return numerics::NewtonVerdict::go_on;
    state.acceleration += force;
    state.multiplier += rate;
    return numerics::NewtonVerdict::converged;
  }

  system::ConstrainedEquations& equations;
  const system::ConstrainedSystem& of;
  system::State& state;
  model::Side side;
  bool stands;  // nothing moves, drives included
  Vector applied, force, product, wanted, rate, explicit_rate, last;
};

bool balance(system::ConstrainedEquations& equations, system::State& state, model::Side side, bool stands) {
  numerics::NewtonRules rules;
  rules.most_iterations = 30;
  Balancing balancing(equations, state, side, stands);
  if (!numerics::newton(balancing, rules).has_converged()) return false;
  state.auxiliary_acceleration = state.acceleration;
  state.contraction = 1.0;
  state.reaction_lag.resize(0);
  return true;
}

/// Positions that satisfy the constraints, along M^-1 G^T, as Newton's method sees them. What it tells of gaps and of
/// rows that repeat others is of the last configuration whose matrix had factors.
struct Joining : numerics::NewtonProblem {
  Joining(system::ConstrainedEquations& equations_, ConsistentStart& result_, model::Side side_)
      : equations(equations_),
        result(result_),
        state(result_.state),
        side(side_),
        force(equations_.system().size()),
        constraint(equations_.system().constraint_count()),
        other(state.q),
        extent(1.0 + state.q.cwiseAbs().maxCoeff()) {}

  double evaluate(bool /*with_tangent*/) {
    equations.go_to(state, side);
    equations.linearise({1.0, 0.0, 0.0, 0.0, false}, state.multiplier, force, constraint);
    gap = 0.0;
    row = largest_of(constraint, gap);
    return gap;
  }

  // Newton's method converges quadratically: a round beyond a small correction leaves round-off.
  bool is_solved(double) {
    const bool is_solved = gap <= 1e-15 * extent || (gap <= 1e-12 * extent && gap >= 0.5 * last_gap);
    last_gap = gap;
    return is_solved;
  }

  bool factorise() {
    if (!equations.factorise()) return false;
    result.redundant = equations.redundant_rows();
    result.gap = gap;
    result.worst_row = row;
    return true;
  }

  double correct() {
    force.setZero();
    constraint = -constraint;
    equations.solve(force, constraint);
    return force.norm();
  }

  void move(double part) {
    equations.system().retract(state.q, part * force, other);
    std::swap(state.q, other);
  }

  system::ConstrainedEquations& equations;
  ConsistentStart& result;
  system::State& state;
  model::Side side;
  Vector force, constraint, other;
  double extent, gap = 0.0, last_gap = HUGE_VAL;
  Index row = -1;  // of the largest gap
};

}  // namespace

bool find_acceleration(system::ConstrainedEquations& equations, system::State& state, model::Side side) {
  return balance(equations, state, side, false);
}

bool find_acceleration_at_rest(system::ConstrainedEquations& equations, system::State& state, model::Side side) {
  state.v.setZero();
  return balance(equations, state, side, true);
}

bool add_acceleration(system::ConstrainedEquations& equations, system::State& state, const Vector& force,
                      const Vector& rate) {
  const auto& of = equations.system();
  Vector left(force.size()), left_rate(rate.size()), rate_of_time(rate.size());
  if (!factorise_mass(equations, state, model::Side::left, left, left_rate, true)) return false;
  Vector acceleration = -force, multiplier = -rate;
  equations.solve(acceleration, multiplier);
  // As in balance(), the share of the multipliers in the constraint rows, and what friction does that is not linear.
  of.times_mass(acceleration, left);
  left = -(force + left);
  equations.add_constraint_force(state.multiplier + multiplier, -1.0, left);
  equations.add_constraint_force(state.multiplier, 1.0, left);
  equations.constraint_rate(acceleration, left_rate);
  equations.constraint_rate(Vector::Zero(force.size()), rate_of_time);
  left_rate = -(left_rate - rate_of_time + rate);
  equations.solve(left, left_rate);
  if (!left.allFinite() || !left_rate.allFinite()) return false;
  state.acceleration += acceleration + left;
  state.multiplier += multiplier + left_rate;
  return true;
}

void close_gaps(system::ConstrainedEquations& equations, system::State& state, model::Side side) {
  if (equations.system().constraint_count() == 0) return;
  ConsistentStart joined;
  joined.state = state;
  Joining joining(equations, joined, side);
  numerics::NewtonRules rules;
  rules.most_iterations = 5;
  (void)numerics::newton(joining, rules);
  joining.evaluate(false);
  if (joining.gap <= 1e-12 * joining.extent) state.q = joined.state.q;
}

ConsistentStart make_consistent(system::ConstrainedEquations& equations, system::State given, model::Side side) {
  const auto& of = equations.system();
  const Index n = of.size(), c = of.constraint_count();
  ConsistentStart result;
  result.state = std::move(given);
  system::State& state = result.state;
  if (state.multiplier.size() != c)
    state.multiplier = Vector::Zero(c);  // else: where friction that follows them begins
  const Vector first = state.q, first_velocity = state.v;

  numerics::NewtonRules rules;
  rules.most_iterations = 50;
  Joining joining(equations, result, side);
  const double extent = joining.extent;
  const numerics::NewtonOutcome outcome = numerics::newton(joining, rules).outcome;
  if (outcome == numerics::NewtonOutcome::limit)
    joining.evaluate(true);
  else if (outcome != numerics::NewtonOutcome::converged)
    return result;
  if (!joining.factorise()) return result;
  if (!(result.gap <= 1e-10 * extent)) return result;
  result.is_assembled = true;
  Vector force(n), constraint(c), moved(n), product(n);
  of.difference(first, state.q, moved);
  result.most_moved = largest_of(moved, result.position_moved);
  if (result.position_moved <= 1e-12 * extent) result.most_moved = -1;

  of.times_mass(state.v, product);
  const double before = 0.5 * state.v.dot(product);
  Vector impulse = Vector::Zero(c), rate(c), mean_rate(c), rate_of_time(c);
  equations.constraint_rate(Vector::Zero(n), rate_of_time);
  equations.constraint_rate(state.v, mean_rate);
  for (int round = 0; round < 2; ++round) {
    force.setZero();
    equations.constraint_rate(state.v, constraint);
    constraint = -constraint;
    equations.solve(force, constraint);
    state.v += force;
    impulse += constraint;
  }
  equations.constraint_rate(state.v, rate);
  mean_rate = 0.5 * (mean_rate + rate) - rate_of_time;
  for (const Index row : of.driven_rows()) result.drive_work -= impulse[row] * mean_rate[row];
  result.impulse = std::move(impulse);
  of.times_mass(state.v, product);
  result.energy_lost = before - 0.5 * state.v.dot(product) + result.drive_work;
  result.worst_rate = largest_of(rate, result.gap_rate);
  constexpr double round_off = 1e-12;  // of velocities, where nothing moves
  const double speed =
      largest_magnitude(first_velocity) + largest_magnitude(state.v) + largest_magnitude(rate_of_time) + round_off;
  if (!(result.gap_rate <= 1e-8 * (1.0 + extent) * speed) && c > 0) return result;
  result.worst_rate = -1;
  result.most_changed = largest_of(state.v - first_velocity, result.velocity_changed);
  if (result.velocity_changed <= 1e-12 * (1.0 + first_velocity.cwiseAbs().maxCoeff())) result.most_changed = -1;
  result.is_consistent = find_acceleration(equations, state, side);
  return result;
}

void shift_acceleration(system::ConstrainedEquations& equations, system::State& state, double shifted_by) {
  if (shifted_by == 0.0) return;
  // A law with a memory knows the way that it goes on, and not the one back.
  const bool goes_on = equations.system().has_memory();
  const double way = goes_on ? std::abs(shifted_by) : shifted_by;
  system::State ahead = state;
  ahead.t += way;
  equations.system().retract(state.q, way * state.v + (0.5 * way * way) * state.acceleration, ahead.q);
  ahead.v += way * state.acceleration;
  if (goes_on) equations.move_laws(state, ahead);
  if (!find_acceleration(equations, ahead, way > 0.0 ? model::Side::left : model::Side::right)) return;
  if (way == shifted_by)
    state.auxiliary_acceleration = ahead.acceleration;
  else
    state.auxiliary_acceleration = 2.0 * state.acceleration - ahead.acceleration;
}

}  // namespace rubato::integrate
