#pragma once

#include <rubato/model/time_law.hpp>
#include <rubato/system/state.hpp>

#include <span>

namespace rubato::integrate {

/// An end of a step, and the weight of its values in a polynomial at another time.
struct WeighedEnd {
  double t = 0.0;
  model::Side side = model::Side::left;  ///< which limit of the loads its acceleration takes
  double weight = 0.0;                   ///< all of them together are 1
};

/// What follows from the configuration and the velocities of a state by the equations of its system. A workspace: one
/// a march, lent to all that looks at its states.
class Balance {
 public:
  virtual ~Balance() = default;

  /// Writes `acceleration`, and of a constrained system `multiplier`, of equilibrium; leaves the state unchanged where
  /// there are none.
  /// @param side  which limit to take of loads that jump at state.t
  virtual void find_acceleration(system::State& state, model::Side side) = 0;

  /// The same with the values that a row at the end of a step shows: from this instant on, unless a load jumps there
  /// and lets a joint go at once, which has held until then.
  virtual void find_shown_acceleration(system::State& state) { find_acceleration(state, model::Side::right); }

  /// Adds to acceleration and multiplier, which a polynomial gives, what loads and drives do at state.t beyond the
  /// polynomial of what they do at the ends, all of it at the configuration and the velocities of the state: the
  /// polynomial follows the motion, and where little moves loads may swing within a step.
  virtual void add_swing_of_loads(std::span<const WeighedEnd> ends, system::State& state) = 0;

  /// Whether the loads jump at t without a trace in the states of a march, which steps over the jump.
  virtual bool loads_jump(double t) = 0;

  /// Sets the forces of sliders and stops, and the memory of laws, at a state that the motion from `before` reaches
  /// without turning back.
  virtual void find_contact_forces(const system::State& before, system::State& state) = 0;
};

}  // namespace rubato::integrate
