#pragma once

#include <rubato/system/mechanism_equations.hpp>

#include <vector>

namespace rubato::integrate {

/// What a unit impulse along the coordinate s of a friction does,  M dv + G^T impulse = (ds/dq)^T,  G dv = 0,  with
/// what sticks and locks among the rows of G.
struct FrictionMobility {
  Vector slope;              ///< ds/dq [n]
  Vector motion;             ///< dv [n]
  std::vector<char> driven;  ///< by each drive of the model: whether it moves s
  /// The change of the rate of another, or of its own: the mobility w = (ds/dq) dv.
  double of(const FrictionMobility& other) const { return other.slope.dot(motion); }
};

/// Of the frictions asked for, with the phases of a state; false where the matrix cannot be factorised.
bool find_friction_mobilities(system::MechanismEquations& equations, const system::State& state,
                              const std::vector<std::size_t>& frictions, std::vector<FrictionMobility>& found);

/// Which of the frictions that slide cannot move, since other joints that stick, or rigid locks, hold their
/// coordinates: their mobility is round-off of the mobility without those joints and locks. A coordinate that a drive
/// moves is not held, nor is one that has none without them either: in a dead centre it turns round.
/// @return one for each friction of the model, or nothing where a matrix cannot be factorised
std::vector<char> held_frictions(system::MechanismEquations& equations, const system::State& state);

/// Which of the frictions are held at rest by drives that stand still, now and for some time. Nothing determines what
/// such frictions carry.
/// @param ahead  that time [s]
/// @return one for each friction of the model; none where a matrix cannot be factorised
std::vector<char> frictions_held_by_drives(system::MechanismEquations& equations, const system::State& state,
                                           double ahead);

}  // namespace rubato::integrate
