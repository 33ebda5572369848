#pragma once

#include <rubato/integrate/equilibrium/free_motions.hpp>
#include <rubato/system/mechanism_equations.hpp>

namespace rubato::integrate {

/// The `count` lowest modes of a mechanism about a configuration at rest, and all up to the last that grows:
///
///   N^T (s^2 M + s C + K) N x = 0,   G N = 0,   shape = N x
///
/// with C = df/dv and K = d(f + G^T multiplier)/dq. In equilibrium K is symmetric but for loads without a potential,
/// which follow their body: with them some motions may flutter (Ziegler 1952). Dense: for up to some thousand
/// coordinates.
FreeMotions modes_about(system::MechanismEquations& equations, const system::State& state, Index count);

}  // namespace rubato::integrate
