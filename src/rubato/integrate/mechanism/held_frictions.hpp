#pragma once

#include <rubato/system/mechanism_equations.hpp>

#include <vector>

namespace rubato::integrate {

/// Which of the frictions that slide cannot move: other joints that stick, or rigid locks, hold their coordinates.
///
/// A unit impulse along the coordinate s of a friction changes its rate by the mobility
///
///   w = (ds/dq) dv,   M dv + G^T impulse = (ds/dq)^T,   G dv = 0
///
/// with what sticks and locks now among the rows of G. It is held where that is no part of the mobility without them.
/// What a drive moves is not held: its rate is the drive's.
/// @return one for each friction of the model, or nothing where a matrix cannot be factorised
std::vector<char> held_frictions(system::MechanismEquations& equations, const system::State& state);

}  // namespace rubato::integrate
