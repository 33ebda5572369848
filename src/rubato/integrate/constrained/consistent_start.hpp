#pragma once

#include <rubato/system/constrained_equations.hpp>

#include <vector>

namespace rubato::integrate {

/// What it took to make a state consistent.
struct ConsistentStart {
  system::State state;
  bool is_assembled = false;    ///< the positions satisfy the constraints
  bool is_consistent = false;   ///< and velocities, accelerations and multipliers were found
  double position_moved = 0.0;  ///< the largest change of a coordinate [m], [rad]
  Index most_moved = -1;        ///< its place; -1: nothing moved
  double velocity_changed = 0.0;
  Index most_changed = -1;
  double gap = 0.0;              ///< largest violation of the constraints that is left [m], [rad]
  Index worst_row = -1;          ///< where
  double energy_lost = 0.0;      ///< kinetic energy that the projection of the velocities took away [J]
  double drive_work = 0.0;       ///< what the drives gave as it set their velocities [J]
  double gap_rate = 0.0;         ///< largest rate of the constraints that no velocities remove [m/s], [rad/s]
  Index worst_rate = -1;         ///< where, if it is not round-off: constraints that contradict each other in motion
  Vector impulse;                ///< of the constraints, in the projection of the velocities [N s], [N m s]
  std::vector<Index> redundant;  ///< rows of constraints that repeat others in this configuration
};

/// Moves a state onto the constraints: positions by Newton's method along M^-1 G^T, velocities by the projection
///
///   M (v - v_given) + G^T impulse = 0,   G v + dg/dt = 0
///
/// Drives give the impulses that their velocities take: the work of one is minus impulse times the mean of its
/// coordinate's velocity before and after. Then accelerations and multipliers of equilibrium:  M a + f + G^T multiplier
/// = 0,   G a + (dG/dt) v + ... = 0. Phases of locks are kept. What cannot be joined is told by `gap` and `worst_row`,
/// what cannot move together (two drives that contradict each other) by `gap_rate` and `worst_rate`.
/// @param side  which limit to take of loads that jump at the state's time
ConsistentStart make_consistent(system::ConstrainedEquations& equations, system::State given,
                                model::Side side = model::Side::right);

/// Moves positions onto the constraints where a step left them apart. Steps leave what the share E of their own length
/// does, 1e-10 of sigma times the multipliers: nothing beside the motion in a step of that length, but a much shorter
/// one that closes such a gap makes accelerations and multipliers of it. What cannot be joined stays as it is.
void close_gaps(system::ConstrainedEquations& equations, system::State& state, model::Side side);

/// Writes acceleration and multiplier of equilibrium of a state that satisfies the constraints; the auxiliary
/// acceleration becomes the same. Returns false where the matrix cannot be factorised, and where no multipliers go
/// with the friction that they make (Painleve's paradox).
bool find_acceleration(system::ConstrainedEquations& equations, system::State& state, model::Side side);

/// The same with all velocities zero and the drives held where they are, whatever their rates: for statics and modes.
bool find_acceleration_at_rest(system::ConstrainedEquations& equations, system::State& state, model::Side side);

/// Adds to acceleration and multiplier of a state what a change of its equations makes of them, where the constraints
/// and the friction that follows reactions are those of the state:  M da + G^T dmultiplier = -force,  G da = -rate.
/// Returns false where the matrix cannot be factorised.
/// @param force  the change of f [n]   @param rate  of second_rate() [c]
bool add_acceleration(system::ConstrainedEquations& equations, system::State& state, const Vector& force,
                      const Vector& rate);

/// The auxiliary acceleration of a method that carries that at t + shift h: A = a + shift h da/dt, with da/dt from the
/// accelerations at both ends of a short motion, of systems that remember always the one that follows. Multipliers
/// are of second order only with this start (Arnold, Bruels and Cardona 2015).
void shift_acceleration(system::ConstrainedEquations& equations, system::State& state, double shifted_by);

}  // namespace rubato::integrate
