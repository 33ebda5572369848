#pragma once

namespace rubato::system {

/// A guard function: positive before the transition that it watches, negative after it.
struct GuardValue {
  double value = 0.0;
  double rate = 0.0;  ///< its derivative with respect to time
};

/// How a march goes on from a transition.
enum class Passage {
  continues,  ///< the acceleration does not jump
  restarts,   ///< it does, or velocities do: nothing before says anything about what follows
  fails,      ///< there is no consistent state from which to go on
};

}  // namespace rubato::system
